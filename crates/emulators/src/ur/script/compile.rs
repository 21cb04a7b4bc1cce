//! Programs as lists of small steps for a machine with a stack.

use std::collections::HashMap;

use super::lexer::{Token, words};
use super::value::Value;

/// One step.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Step {
    Push(Value),
    /// Takes the value away that a statement left.
    Drop,
    Load(String),
    /// To the function's own name, or to the global one where there is such.
    Store(String),
    StoreLocal(String),
    StoreGlobal(String),
    /// Takes value and index.
    StoreAt(String),
    At,
    List(usize),
    Pose,
    Negate,
    Not,
    Binary(&'static str),
    Jump(usize),
    JumpUnless(usize),
    /// Takes as many values; names for those that were given with one.
    Call(String, Vec<Option<String>>),
    Return,
    Spawn(String, usize),
    Kill,
    Join,
    Halt,
}

/// A function or a thread.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Function {
    pub(super) parameters: Vec<String>,
    pub(super) entry: usize,
}

/// A program, ready to run.
#[derive(Clone, Debug, Default)]
pub(crate) struct Program {
    /// Its own name.
    pub(crate) name: String,
    pub(super) steps: Vec<Step>,
    pub(super) lines: Vec<usize>,
    pub(super) functions: HashMap<String, Function>,
    /// Where it begins.
    pub(super) entry: usize,
}

/// Makes steps of a text: `def name(): … end`, or single lines.
pub(crate) fn compile(text: &str) -> Result<Program, String> {
    let mut compiler =
        Compiler { words: words(text)?, at: 0, program: Program::default(), loops: Vec::new(), depth: 0 };
    compiler.whole().map_err(|cause| format!("line {}: {cause}", compiler.line()))?;
    Ok(compiler.program)
}

struct Compiler {
    words: Vec<(Token, usize)>,
    at: usize,
    program: Program,
    /// Of each loop around: where it begins, and the jumps that leave it.
    loops: Vec<(usize, Vec<usize>)>,
    /// How deep it is in blocks and brackets.
    depth: usize,
}

/// Deeper than any program that a person writes.
const DEEPEST: usize = 100;

/// Operators by how tightly they bind, loosest first.
const LEVELS: [&[&str]; 5] =
    [&["or", "xor"], &["and"], &["==", "!=", "<", ">", "<=", ">="], &["+", "-"], &["*", "/", "%", "^"]];

impl Compiler {
    fn line(&self) -> usize {
        self.words.get(self.at).or(self.words.last()).map_or(0, |(_, line)| *line)
    }

    fn peek(&self) -> &Token {
        self.words.get(self.at).map_or(&Token::End, |(token, _)| token)
    }

    fn next(&mut self) -> Token {
        let token = self.peek().clone();
        self.at += 1;
        token
    }

    fn step(&mut self, step: Step) -> usize {
        let line = self.line();
        self.program.lines.push(line);
        self.program.steps.push(step);
        self.program.steps.len() - 1
    }

    fn here(&self) -> usize {
        self.program.steps.len()
    }

    fn land(&mut self, jump: usize) {
        let here = self.here();
        match &mut self.program.steps[jump] {
            Step::Jump(to) | Step::JumpUnless(to) => *to = here,
            _ => {}
        }
    }

    fn is(&self, word: &str) -> bool {
        match self.peek() {
            Token::Name(name) => name == word,
            Token::Sign(sign) => *sign == word,
            _ => false,
        }
    }

    fn has(&mut self, word: &str) -> bool {
        let is = self.is(word);
        self.at += usize::from(is);
        is
    }

    fn must(&mut self, word: &str) -> Result<(), String> {
        if self.has(word) { Ok(()) } else { Err(format!("{word:?} is missing before {:?}", self.peek())) }
    }

    fn name(&mut self) -> Result<String, String> {
        match self.next() {
            Token::Name(name) => Ok(name),
            other => Err(format!("a name is missing before {other:?}")),
        }
    }

    fn whole(&mut self) -> Result<(), String> {
        self.blank();
        let defined = (self.is("def") || self.is("sec")).then(|| {
            self.at += 1;
            self.name()
        });
        if let Some(name) = defined {
            self.program.name = name?;
            self.at -= 2;
            self.function()?;
            self.program.entry = self.here();
            let name = self.program.name.clone();
            self.step(Step::Call(name, Vec::new()));
        } else {
            while self.at < self.words.len() {
                self.statement()?;
                self.blank();
            }
        }
        self.step(Step::Halt);
        Ok(())
    }

    fn blank(&mut self) {
        while self.at < self.words.len() && (*self.peek() == Token::End || self.is(";")) {
            self.at += 1;
        }
    }

    /// Statements until one of these words, which stays.
    fn block(&mut self, ends: &[&str]) -> Result<(), String> {
        loop {
            self.blank();
            if ends.iter().any(|end| self.is(end)) {
                return Ok(());
            }
            if self.at >= self.words.len() {
                return Err(format!("{:?} is missing at the end", ends[0]));
            }
            self.statement()?;
        }
    }

    fn function(&mut self) -> Result<(), String> {
        self.at += 1;
        let name = self.name()?;
        self.must("(")?;
        let mut parameters = Vec::new();
        while !self.has(")") {
            parameters.push(self.name()?);
            self.has(",");
        }
        self.must(":")?;
        let over = self.step(Step::Jump(0));
        let entry = self.here();
        self.program.functions.insert(name, Function { parameters, entry });
        let outer = std::mem::take(&mut self.loops);
        self.block(&["end"])?;
        self.loops = outer;
        self.must("end")?;
        self.step(Step::Push(Value::Nothing));
        self.step(Step::Return);
        self.land(over);
        Ok(())
    }

    fn statement(&mut self) -> Result<(), String> {
        self.deeper(Self::one)
    }

    /// Goes into something that may hold itself.
    fn deeper(&mut self, part: fn(&mut Self) -> Result<(), String>) -> Result<(), String> {
        if self.depth >= DEEPEST {
            return Err(format!("blocks and brackets are nested deeper than {DEEPEST}"));
        }
        self.depth += 1;
        let end = part(self);
        self.depth -= 1;
        end
    }

    fn one(&mut self) -> Result<(), String> {
        let Token::Name(word) = self.peek().clone() else {
            return Err(format!("a statement does not begin with {:?}", self.peek()));
        };
        match word.as_str() {
            "def" | "thread" | "sec" => return self.function(),
            "if" => return self.condition(),
            "while" => return self.repeat(),
            _ => {}
        }
        self.at += 1;
        match word.as_str() {
            "break" | "continue" => {
                let jump = self.step(Step::Jump(0));
                let (start, leave) = self.loops.last_mut().ok_or("there is no loop around it")?;
                if word == "break" {
                    leave.push(jump);
                } else {
                    self.program.steps[jump] = Step::Jump(*start);
                }
            }
            "return" => {
                if *self.peek() == Token::End {
                    self.step(Step::Push(Value::Nothing));
                } else {
                    self.expression(0)?;
                }
                self.step(Step::Return);
            }
            "global" | "local" => {
                let name = self.name()?;
                self.must("=")?;
                self.value()?;
                self.step(if word == "global" { Step::StoreGlobal(name) } else { Step::StoreLocal(name) });
            }
            "kill" | "join" => {
                self.expression(0)?;
                self.step(if word == "kill" { Step::Kill } else { Step::Join });
            }
            "halt" => drop(self.step(Step::Halt)),
            // One thread runs at a time, and none is interrupted: what is critical is safe.
            "enter_critical" | "exit_critical" | "pass" => {}
            _ => self.simple(word)?,
        }
        match self.peek() {
            // The next one may follow on the same line.
            Token::End | Token::Sign(";") | Token::Name(_) => Ok(()),
            other => Err(format!("the statement should end before {other:?}")),
        }
    }

    /// `name = …`, `name[…] = …`, or an expression.
    fn simple(&mut self, name: String) -> Result<(), String> {
        if self.has("=") {
            self.value()?;
            self.step(Step::Store(name));
            return Ok(());
        }
        let before = (self.at, self.here());
        if self.has("[") {
            self.expression(0)?;
            if self.has("]") && self.has("=") {
                self.value()?;
                self.step(Step::StoreAt(name));
                return Ok(());
            }
            self.program.steps.truncate(before.1);
            self.program.lines.truncate(before.1);
        }
        self.at = before.0 - 1;
        self.expression(0)?;
        self.step(Step::Drop);
        Ok(())
    }

    /// What is assigned; it may begin on a later line.
    fn value(&mut self) -> Result<(), String> {
        self.blank();
        self.expression(0)
    }

    fn condition(&mut self) -> Result<(), String> {
        let mut leave = Vec::new();
        self.at += 1;
        loop {
            self.expression(0)?;
            self.must(":")?;
            let unless = self.step(Step::JumpUnless(0));
            self.block(&["elif", "else", "end"])?;
            leave.push(self.step(Step::Jump(0)));
            self.land(unless);
            if self.has("elif") {
                continue;
            }
            if self.has("else") {
                self.must(":")?;
                self.block(&["end"])?;
            }
            self.must("end")?;
            break;
        }
        for jump in leave {
            self.land(jump);
        }
        Ok(())
    }

    fn repeat(&mut self) -> Result<(), String> {
        self.at += 1;
        let start = self.here();
        self.expression(0)?;
        self.must(":")?;
        let unless = self.step(Step::JumpUnless(0));
        self.loops.push((start, vec![unless]));
        self.block(&["end"])?;
        self.must("end")?;
        self.step(Step::Jump(start));
        let (_, leave) = self.loops.pop().unwrap_or_default();
        for jump in leave {
            self.land(jump);
        }
        Ok(())
    }

    fn expression(&mut self, level: usize) -> Result<(), String> {
        let Some(signs) = LEVELS.get(level) else {
            return self.factor();
        };
        self.expression(level + 1)?;
        while let Some(sign) = signs.iter().find(|sign| self.is(sign)) {
            self.at += 1;
            self.expression(level + 1)?;
            self.step(Step::Binary(sign));
        }
        Ok(())
    }

    fn factor(&mut self) -> Result<(), String> {
        self.deeper(Self::item)
    }

    fn item(&mut self) -> Result<(), String> {
        match self.next() {
            Token::Number(number) => drop(self.step(Step::Push(Value::Number(number)))),
            Token::Text(text) => drop(self.step(Step::Push(Value::Text(text)))),
            Token::Sign("-") => {
                self.factor()?;
                self.step(Step::Negate);
            }
            Token::Sign("(") => {
                self.expression(0)?;
                self.must(")")?;
            }
            Token::Sign("[") => {
                let count = self.elements("]")?;
                self.step(Step::List(count));
            }
            Token::Name(name) => return self.named(name),
            other => return Err(format!("a value does not begin with {other:?}")),
        }
        self.indices()
    }

    fn named(&mut self, name: String) -> Result<(), String> {
        match name.as_str() {
            "True" | "False" => drop(self.step(Step::Push(Value::Truth(name == "True")))),
            "not" => {
                // Looser than comparisons, tighter than `and`.
                self.expression(2)?;
                self.step(Step::Not);
                return Ok(());
            }
            "run" => {
                let name = self.name()?;
                self.must("(")?;
                let count = self.elements(")")?;
                self.step(Step::Spawn(name, count));
            }
            "p" if self.is("[") => {
                self.at += 1;
                match self.elements("]")? {
                    6 => drop(self.step(Step::Pose)),
                    // One element: a variable of this name.
                    1 => {
                        self.step(Step::Load(name));
                        self.step(Step::Binary("of"));
                    }
                    count => return Err(format!("a pose has 6 elements, not {count}")),
                }
            }
            _ if self.has("(") => {
                let mut names = Vec::new();
                while !self.has(")") {
                    let named = match (self.peek().clone(), self.words.get(self.at + 1)) {
                        (Token::Name(name), Some((Token::Sign("="), _))) => {
                            self.at += 2;
                            Some(name)
                        }
                        _ => None,
                    };
                    self.expression(0)?;
                    names.push(named);
                    if !self.is(")") {
                        self.must(",")?;
                    }
                }
                self.step(Step::Call(name, names));
            }
            _ => drop(self.step(Step::Load(name))),
        }
        self.indices()
    }

    fn elements(&mut self, end: &str) -> Result<usize, String> {
        let mut count = 0;
        while !self.has(end) {
            self.expression(0)?;
            count += 1;
            if !self.is(end) {
                self.must(",")?;
            }
        }
        Ok(count)
    }

    fn indices(&mut self) -> Result<(), String> {
        while self.has("[") {
            self.expression(0)?;
            self.must("]")?;
            self.step(Step::At);
        }
        Ok(())
    }
}
