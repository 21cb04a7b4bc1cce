//! What a text says, before anything is known of its names.

use std::fmt;
use std::ops::Range;

use crate::exponents::Exponents;

/// One part of a name.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Segment {
    /// `knee`, or `*`.
    Word(String),
    /// `#2`.
    Index(usize),
}

/// A name with dots, `joint.knee.pos`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Path {
    pub(crate) segments: Vec<Segment>,
    /// Where each part stands in the text.
    pub(crate) spans: Vec<Range<usize>>,
    /// One for each part that was written in quotes, which is a name and no word of the language.
    pub(crate) quoted: Vec<bool>,
}

impl Path {
    /// How many parts it has, at least one.
    pub fn len(&self) -> usize {
        self.segments.len()
    }

    /// Never.
    pub fn is_empty(&self) -> bool {
        self.segments.is_empty()
    }

    /// The first part; empty where it is an index.
    pub fn first(&self) -> &str {
        self.word(0).unwrap_or_default()
    }

    /// Part `i`, where there is one and it is a word. `*` stands for all.
    pub fn word(&self, i: usize) -> Option<&str> {
        match self.segments.get(i)? {
            Segment::Word(word) => Some(word),
            Segment::Index(_) => None,
        }
    }

    /// Part `i`, where it is an index, `#2`.
    pub fn index(&self, i: usize) -> Option<usize> {
        match self.segments.get(i)? {
            Segment::Word(_) => None,
            Segment::Index(index) => Some(*index),
        }
    }
}

impl fmt::Display for Path {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, segment) in self.segments.iter().enumerate() {
            let dot = if i > 0 { "." } else { "" };
            match segment {
                Segment::Word(word) => write!(f, "{dot}{}", short(word))?,
                Segment::Index(index) => write!(f, "{dot}#{index}")?,
            }
        }
        Ok(())
    }
}

/// A piece of text for messages: printable, and not long.
pub(crate) fn short(text: &str) -> String {
    let clean: String = text.chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
    match clean.char_indices().nth(60) {
        Some((at, _)) => format!("{}…", &clean[..at]),
        None => clean,
    }
}

/// Two operands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Operator {
    Add,
    Sub,
    Mul,
    Div,
    Power,
    Less,
    LessEqual,
    Greater,
    GreaterEqual,
    Equal,
    NotEqual,
    And,
    Or,
}

impl Operator {
    pub(crate) fn sign(self) -> &'static str {
        match self {
            Self::Add => "+",
            Self::Sub => "-",
            Self::Mul => "*",
            Self::Div => "/",
            Self::Power => "^",
            Self::Less => "<",
            Self::LessEqual => "<=",
            Self::Greater => ">",
            Self::GreaterEqual => ">=",
            Self::Equal => "==",
            Self::NotEqual => "!=",
            Self::And => "and",
            Self::Or => "or",
        }
    }

    pub(crate) fn compares(self) -> bool {
        use Operator::{Equal, Greater, GreaterEqual, Less, LessEqual, NotEqual};
        matches!(self, Less | LessEqual | Greater | GreaterEqual | Equal | NotEqual)
    }
}

/// A formula.
#[derive(Clone, Debug)]
pub(crate) struct Tree {
    pub(crate) node: Node,
    pub(crate) span: Range<usize>,
}

#[derive(Clone, Debug)]
pub(crate) enum Node {
    Number(f64, Option<Exponents>),
    Name(Path),
    Call(String, Vec<Tree>),
    Minus(Box<Tree>),
    Not(Box<Tree>),
    Binary(Operator, Box<Tree>, Box<Tree>),
    /// `x[2]` or `x[1:3]`; an end that is not written is none.
    Slice(Box<Tree>, Index),
    /// `[a, b]`.
    List(Vec<Tree>),
}

impl Node {
    /// What it is made of, in the order of the text.
    pub(crate) fn within(&self) -> Vec<&Tree> {
        match self {
            Self::Number(..) | Self::Name(_) => Vec::new(),
            Self::Call(_, trees) | Self::List(trees) => trees.iter().collect(),
            Self::Minus(inner) | Self::Not(inner) | Self::Slice(inner, _) => vec![inner],
            Self::Binary(_, left, right) => vec![left, right],
        }
    }
}

/// What stands in brackets behind a vector. Negative numbers count from the end.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Index {
    One(i64),
    Range(Option<i64>, Option<i64>),
}
