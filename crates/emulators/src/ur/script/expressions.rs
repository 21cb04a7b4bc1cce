//! Expressions of programs, as steps that leave one value on the stack.

use super::compile::Compiler;
use super::lexer::Token;
use super::steps::Step;
use super::value::Value;

/// Operators by how tightly they bind, loosest first.
const LEVELS: [&[&str]; 5] =
    [&["or", "xor"], &["and"], &["==", "!=", "<", ">", "<=", ">="], &["+", "-"], &["*", "/", "%", "^"]];

impl Compiler {
    pub(super) fn expression(&mut self, level: usize) -> Result<(), String> {
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
