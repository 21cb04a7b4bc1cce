//! Makes steps of the text of a program: its statements. What has a value is in `expressions`.

use super::lexer::{Token, words};
use super::steps::{Function, Program, Step};
use super::value::Value;

/// Makes steps of a text: `def name(): … end`, or single lines.
pub(crate) fn compile(text: &str) -> Result<Program, String> {
    let mut compiler =
        Compiler { words: words(text)?, at: 0, program: Program::default(), loops: Vec::new(), depth: 0 };
    compiler.whole().map_err(|cause| format!("line {}: {cause}", compiler.line()))?;
    Ok(compiler.program)
}

pub(super) struct Compiler {
    pub(super) words: Vec<(Token, usize)>,
    pub(super) at: usize,
    program: Program,
    /// Of each loop around: where it begins, and the jumps that leave it.
    loops: Vec<(usize, Vec<usize>)>,
    /// How deep it is in blocks and brackets.
    depth: usize,
}

/// Deeper than any program that a person writes.
const DEEPEST: usize = 100;

impl Compiler {
    fn line(&self) -> usize {
        self.words.get(self.at).or(self.words.last()).map_or(0, |(_, line)| *line)
    }

    pub(super) fn peek(&self) -> &Token {
        self.words.get(self.at).map_or(&Token::End, |(token, _)| token)
    }

    pub(super) fn next(&mut self) -> Token {
        let token = self.peek().clone();
        self.at += 1;
        token
    }

    pub(super) fn step(&mut self, step: Step) -> usize {
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

    pub(super) fn is(&self, word: &str) -> bool {
        match self.peek() {
            Token::Name(name) => name == word,
            Token::Sign(sign) => *sign == word,
            _ => false,
        }
    }

    pub(super) fn has(&mut self, word: &str) -> bool {
        let is = self.is(word);
        self.at += usize::from(is);
        is
    }

    pub(super) fn must(&mut self, word: &str) -> Result<(), String> {
        if self.has(word) { Ok(()) } else { Err(format!("{word:?} is missing before {:?}", self.peek())) }
    }

    pub(super) fn name(&mut self) -> Result<String, String> {
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
    pub(super) fn deeper(&mut self, part: fn(&mut Self) -> Result<(), String>) -> Result<(), String> {
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
}
