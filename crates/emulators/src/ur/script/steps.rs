//! Programs as lists of small steps for a machine with a stack.

use std::collections::HashMap;

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
