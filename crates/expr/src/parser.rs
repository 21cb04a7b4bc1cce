//! From tokens to a tree: operator precedence (Pratt 1973).
//!
//! From loose to tight: `or`, `and`, `not`, comparisons (not chained), `+ -`, `* /`, unary `-`, `^` (from the right), then
//! components and slices.

use std::ops::Range;

use crate::error::ExprError;
use crate::lexer::{Spanned, Token, tokens};
use crate::syntax::{Index, Node, Operator, Path, Segment, Tree, short};

/// The longest formula, bytes.
pub const LONGEST_TEXT: usize = 20_000;
/// How deep brackets and operators may be nested.
const DEEPEST: usize = 100;
/// Binding powers: of comparisons, of unary minus and of powers.
const COMPARISON: u8 = 4;
const NOT: u8 = 3;
const MINUS: u8 = 7;
const POWER: u8 = 8;

/// Reads a formula.
pub(crate) fn parse(text: &str) -> Result<Tree, ExprError> {
    if text.len() > LONGEST_TEXT {
        let message = format!("the formula has {} bytes, more than {LONGEST_TEXT}", text.len());
        return Err(ExprError::new(0..text.len(), message));
    }
    let tokens = tokens(text)?;
    let mut parser = Parser { tokens: &tokens, at: 0, end: text.len(), depth: 0 };
    if tokens.is_empty() {
        return Err(ExprError::new(0..text.len(), "the formula is empty"));
    }
    let tree = parser.expression(0)?;
    match parser.peek() {
        None => Ok(tree),
        Some(_) => Err(parser.unexpected("the formula could end here")),
    }
}

struct Parser<'t> {
    tokens: &'t [Spanned],
    at: usize,
    end: usize,
    depth: usize,
}

impl Parser<'_> {
    fn peek(&self) -> Option<&Token> {
        self.tokens.get(self.at).map(|spanned| &spanned.token)
    }

    fn is(&self, sign: &str) -> bool {
        matches!(self.peek(), Some(Token::Sign(found)) if *found == sign)
    }

    fn take(&mut self, sign: &str) -> bool {
        let found = self.is(sign);
        self.at += usize::from(found);
        found
    }

    fn span(&self) -> Range<usize> {
        self.tokens.get(self.at).map_or(self.end..self.end, |spanned| spanned.span.clone())
    }

    fn shown(&self) -> String {
        match self.peek() {
            None => "the end".to_owned(),
            Some(Token::Number(..)) => "a number".to_owned(),
            Some(Token::Word(word)) => format!("`{}`", short(word)),
            Some(Token::Index(index)) => format!("`#{index}`"),
            Some(Token::Sign(sign)) => format!("`{sign}`"),
        }
    }

    fn unexpected(&self, wanted: &str) -> ExprError {
        ExprError::new(self.span(), format!("{} stands where {wanted}", self.shown()))
    }

    fn expect(&mut self, sign: &'static str, opened: &Range<usize>) -> Result<(), ExprError> {
        if self.take(sign) {
            return Ok(());
        }
        if self.at == self.tokens.len() {
            return Err(ExprError::new(opened.clone(), format!("the bracket is not closed by `{sign}`")));
        }
        Err(self.unexpected(&format!("`{sign}` or an operator should be")))
    }

    /// The operator at hand and its binding power.
    fn operator(&self) -> Option<(Operator, u8)> {
        Some(match self.peek()? {
            Token::Word(word) => match word.as_str() {
                "or" => (Operator::Or, 1),
                "and" => (Operator::And, 2),
                _ => return None,
            },
            Token::Sign(sign) => match *sign {
                "<" => (Operator::Less, COMPARISON),
                "<=" => (Operator::LessEqual, COMPARISON),
                ">" => (Operator::Greater, COMPARISON),
                ">=" => (Operator::GreaterEqual, COMPARISON),
                "==" => (Operator::Equal, COMPARISON),
                "!=" => (Operator::NotEqual, COMPARISON),
                "+" => (Operator::Add, 5),
                "-" => (Operator::Sub, 5),
                "*" => (Operator::Mul, 6),
                "/" => (Operator::Div, 6),
                "^" => (Operator::Power, POWER),
                _ => return None,
            },
            Token::Number(..) | Token::Index(_) => return None,
        })
    }

    /// What binds tighter than `least`.
    fn expression(&mut self, least: u8) -> Result<Tree, ExprError> {
        self.depth += 1;
        if self.depth > DEEPEST {
            return Err(ExprError::new(self.span(), format!("the formula is nested deeper than {DEEPEST}"))
                .hint("give parts of it names of their own"));
        }
        let mut left = self.prefix()?;
        while let Some((operator, power)) = self.operator() {
            if power <= least {
                break;
            }
            self.at += 1;
            // A power binds to the right, 2^3^2 = 2^9, and takes a sign, x^-1.
            let right = match operator {
                Operator::Power if self.is("-") => self.prefix()?,
                Operator::Power => self.expression(power - 1)?,
                _ => self.expression(power)?,
            };
            if operator.compares()
                && let Some((next, COMPARISON)) = self.operator()
            {
                let message = format!("{} and {} are chained", operator.sign(), next.sign());
                return Err(ExprError::new(self.span(), message).hint("write a < b and b < c"));
            }
            let span = left.span.start..right.span.end;
            left = Tree { node: Node::Binary(operator, Box::new(left), Box::new(right)), span };
        }
        self.depth -= 1;
        Ok(left)
    }

    fn prefix(&mut self) -> Result<Tree, ExprError> {
        let start = self.span();
        if self.take("-") {
            let inner = self.expression(MINUS)?;
            let span = start.start..inner.span.end;
            return Ok(Tree { node: Node::Minus(Box::new(inner)), span });
        }
        if self.take("+") {
            return self.expression(MINUS);
        }
        if matches!(self.peek(), Some(Token::Word(word)) if word == "not") {
            self.at += 1;
            let inner = self.expression(NOT)?;
            let span = start.start..inner.span.end;
            return Ok(Tree { node: Node::Not(Box::new(inner)), span });
        }
        let mut tree = self.primary()?;
        loop {
            let opened = self.span();
            if self.take("[") {
                let index = self.index(&opened)?;
                let span = tree.span.start..self.tokens[self.at - 1].span.end;
                tree = Tree { node: Node::Slice(Box::new(tree), index), span };
            } else if self.is(".") {
                // A component of what is no name: (a + b).x
                self.at += 1;
                let span = self.span();
                let component = match self.peek() {
                    Some(Token::Word(word)) => component(word),
                    _ => None,
                };
                let Some(component) = component else {
                    return Err(self.unexpected("a component x, y, z or w should be"));
                };
                self.at += 1;
                let whole = tree.span.start..span.end;
                tree = Tree { node: Node::Slice(Box::new(tree), Index::One(component)), span: whole };
            } else {
                return Ok(tree);
            }
        }
    }

    fn primary(&mut self) -> Result<Tree, ExprError> {
        let span = self.span();
        let Some(token) = self.peek() else {
            return Err(ExprError::new(span, "the formula ends where a value should be"));
        };
        match token {
            Token::Number(value, unit) => {
                let node = Node::Number(*value, *unit);
                self.at += 1;
                Ok(Tree { node, span })
            }
            Token::Sign("(") => {
                self.at += 1;
                let inner = self.expression(0)?;
                self.expect(")", &span)?;
                Ok(Tree { node: inner.node, span: span.start..self.tokens[self.at - 1].span.end })
            }
            Token::Sign("[") => {
                self.at += 1;
                let items = self.items("]", &span)?;
                Ok(Tree { node: Node::List(items), span: span.start..self.tokens[self.at - 1].span.end })
            }
            Token::Word(word) if matches!(word.as_str(), "and" | "or" | "not") => {
                Err(self.unexpected("a value should be"))
            }
            Token::Word(_) => self.name(),
            Token::Sign(".") if self.at > 1 && matches!(self.tokens[self.at - 1].token, Token::Sign("*")) => {
                Err(part_of_names(self.tokens[self.at - 2].span.start..span.start))
            }
            Token::Sign(_) | Token::Index(_) => Err(self.unexpected("a value should be")),
        }
    }

    /// Values up to a closing bracket.
    fn items(&mut self, close: &'static str, opened: &Range<usize>) -> Result<Vec<Tree>, ExprError> {
        let mut items = Vec::new();
        while !self.is(close) {
            items.push(self.expression(0)?);
            if !self.take(",") {
                break;
            }
        }
        self.expect(close, opened)?;
        Ok(items)
    }

    /// A name with dots, or a function with its arguments.
    fn name(&mut self) -> Result<Tree, ExprError> {
        let start = self.span();
        let mut path = Path { segments: Vec::new(), spans: Vec::new(), quoted: Vec::new() };
        loop {
            let span = self.span();
            let segment = match self.peek() {
                Some(Token::Word(word)) => Segment::Word(word.clone()),
                Some(Token::Index(index)) => Segment::Index(*index),
                Some(Token::Sign("*")) if !path.is_empty() => Segment::Word("*".to_owned()),
                _ => return Err(self.unexpected("the rest of a name should be")),
            };
            self.at += 1;
            // A word of five letters in quotes takes seven bytes.
            let quoted = matches!(&segment, Segment::Word(word) if word.len() + 2 == span.len());
            path.segments.push(segment);
            path.spans.push(span);
            path.quoted.push(quoted);
            if !self.take(".") {
                break;
            }
        }
        let opened = self.span();
        let end = self.tokens[self.at - 1].span.end;
        if path.word(path.len() - 1) == Some("*") && matches!(self.peek(), Some(Token::Word(_))) && opened.start == end
        {
            return Err(part_of_names(path.spans[path.len() - 1].start..opened.end));
        }
        if path.len() == 1 && !path.quoted[0] && self.take("(") {
            let arguments = self.items(")", &opened)?;
            let span = start.start..self.tokens[self.at - 1].span.end;
            return Ok(Tree { node: Node::Call(path.first().to_owned(), arguments), span });
        }
        Ok(Tree { node: Node::Name(path), span: start.start..end })
    }

    fn index(&mut self, opened: &Range<usize>) -> Result<Index, ExprError> {
        let from = self.whole()?;
        let index = if self.take(":") {
            Index::Range(from, self.whole()?)
        } else {
            Index::One(from.ok_or_else(|| self.unexpected("an index should be"))?)
        };
        self.expect("]", opened)?;
        Ok(index)
    }

    /// A whole number, where there is one.
    fn whole(&mut self) -> Result<Option<i64>, ExprError> {
        let negative = self.take("-");
        let span = self.span();
        match self.peek() {
            Some(Token::Number(value, None)) if value.fract() == 0.0 && *value < 1e6 => {
                let value = *value as i64;
                self.at += 1;
                Ok(Some(if negative { -value } else { value }))
            }
            Some(Token::Number(..)) => Err(ExprError::new(span, "an index is a whole number below a million")),
            _ if negative => Err(self.unexpected("an index should be")),
            _ => Ok(None),
        }
    }
}

/// Of a `*` that stands for a part of names, as in other languages.
fn part_of_names(span: Range<usize>) -> ExprError {
    ExprError::new(span, "`*` stands for all elements of a kind, and for no part of their names")
        .hint("name those that are meant, [joint.left.pos, joint.lift.pos], or take all, joint.*.pos")
}

/// The index of a component by its letter.
pub(crate) fn component(letter: &str) -> Option<i64> {
    ["x", "y", "z", "w"].iter().position(|known| *known == letter).map(|at| at as i64)
}
