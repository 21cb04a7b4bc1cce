//! Recording a law: [`Var`] is the number type that leaves a trace.

use std::cell::RefCell;
use std::collections::HashMap;
use std::fmt;
use std::iter::Sum;
use std::ops::{Add, Div, Mul, Neg, Sub};

use crate::Scalar;
use crate::ops::{Binary, Unary};

/// What an instruction reads: a constant (by its bits, so that it can be compared) or an earlier node of the tape.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Arg {
    /// The bits of an `f64`.
    Constant(u64),
    /// The index of an earlier node.
    Node(usize),
}

/// One entry of a tape; operands always come before it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Node {
    /// The i-th uniform input.
    Uniform(usize),
    /// The i-th column input.
    Column(usize),
    /// A function of one operand.
    Unary(Unary, Arg),
    /// A function of two operands.
    Binary(Binary, Arg, Arg),
}

/// The straight line of nodes that a trace writes. Equal nodes are recorded once.
#[derive(Debug, Default)]
pub(crate) struct Tape {
    written: RefCell<Written>,
}

#[derive(Debug, Default)]
struct Written {
    nodes: Vec<Node>,
    /// Where each node stands, so that a repeated expression is the same node.
    seen: HashMap<Node, usize>,
}

impl Tape {
    /// Records a node, or finds the one that is equal to it.
    pub(crate) fn push(&self, node: Node) -> Var<'_> {
        let written = &mut *self.written.borrow_mut();
        let index = *written.seen.entry(node).or_insert_with(|| {
            written.nodes.push(node);
            written.nodes.len() - 1
        });
        Var(Value::Traced(self, index))
    }

    fn node(&self, index: usize) -> Node {
        self.written.borrow().nodes[index]
    }

    /// The nodes in the order of writing.
    pub(crate) fn into_nodes(self) -> Vec<Node> {
        self.written.into_inner().nodes
    }
}

/// A traced number: arithmetic on it is recorded instead of done.
///
/// `Var`s reach a law through [`Program::trace`](crate::Program::trace). Constants belong to no tape, and an operation on
/// constants alone is done on the spot in `f64`. Only rewrites that keep every bit are made (`x * 1`, `x / 1`, `x - 0`,
/// `x + -0`, `--x`), so that the `f64` program gives the same bits as the law run on plain `f64`.
#[derive(Clone, Copy)]
pub struct Var<'t>(Value<'t>);

#[derive(Clone, Copy)]
enum Value<'t> {
    Constant(f64),
    Traced(&'t Tape, usize),
}

impl<'t> Var<'t> {
    /// What an instruction that reads this number stores.
    pub(crate) fn arg(self) -> Arg {
        match self.0 {
            Value::Constant(value) => Arg::Constant(value.to_bits()),
            Value::Traced(_, index) => Arg::Node(index),
        }
    }

    fn is_constant(self, value: f64) -> bool {
        // By bits: adding +0 to -0 changes it, adding -0 to anything does not.
        matches!(self.0, Value::Constant(c) if c.to_bits() == value.to_bits())
    }

    pub(crate) fn unary(self, op: Unary) -> Self {
        match self.0 {
            Value::Constant(value) => Self::constant(op.value(value)),
            Value::Traced(tape, index) => match (op, tape.node(index)) {
                (Unary::Neg, Node::Unary(Unary::Neg, Arg::Node(inner))) => Self(Value::Traced(tape, inner)),
                _ => tape.push(Node::Unary(op, self.arg())),
            },
        }
    }

    pub(crate) fn binary(self, op: Binary, other: Self) -> Self {
        let tape: &'t Tape = match (self.0, other.0) {
            (Value::Constant(a), Value::Constant(b)) => return Self::constant(op.value(a, b)),
            (Value::Traced(a, _), Value::Traced(b, _)) => {
                assert!(std::ptr::eq(a, b), "numbers of two traces must not be mixed");
                a
            }
            (Value::Traced(tape, _), Value::Constant(_)) | (Value::Constant(_), Value::Traced(tape, _)) => tape,
        };
        match op {
            Binary::Add if other.is_constant(-0.0) => self,
            Binary::Add if self.is_constant(-0.0) => other,
            Binary::Sub if other.is_constant(0.0) => self,
            Binary::Mul | Binary::Div if other.is_constant(1.0) => self,
            Binary::Mul if self.is_constant(1.0) => other,
            _ => tape.push(Node::Binary(op, self.arg(), other.arg())),
        }
    }
}

impl fmt::Debug for Var<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.0 {
            Value::Constant(value) => write!(f, "{value:?}"),
            Value::Traced(_, index) => write!(f, "%{index}"),
        }
    }
}

macro_rules! operator {
    ($trait:ident, $method:ident, $op:expr) => {
        impl $trait for Var<'_> {
            type Output = Self;
            fn $method(self, other: Self) -> Self {
                self.binary($op, other)
            }
        }
        impl $trait<f64> for Var<'_> {
            type Output = Self;
            fn $method(self, other: f64) -> Self {
                self.binary($op, Self::constant(other))
            }
        }
    };
}
operator!(Add, add, Binary::Add);
operator!(Sub, sub, Binary::Sub);
operator!(Mul, mul, Binary::Mul);
operator!(Div, div, Binary::Div);

impl Neg for Var<'_> {
    type Output = Self;
    fn neg(self) -> Self {
        self.unary(Unary::Neg)
    }
}

impl Sum for Var<'_> {
    /// From the left, beginning with negative zero, as the standard library adds plain numbers: the exact neutral element.
    fn sum<I: Iterator<Item = Self>>(terms: I) -> Self {
        terms.fold(Self::constant(-0.0), Add::add)
    }
}

impl Scalar for Var<'_> {
    fn constant(value: f64) -> Self {
        Self(Value::Constant(value))
    }
    fn exp(self) -> Self {
        self.unary(Unary::Exp)
    }
    fn ln(self) -> Self {
        self.unary(Unary::Ln)
    }
    fn sqrt(self) -> Self {
        self.unary(Unary::Sqrt)
    }
    fn sin(self) -> Self {
        self.unary(Unary::Sin)
    }
    fn cos(self) -> Self {
        self.unary(Unary::Cos)
    }
    fn tanh(self) -> Self {
        self.unary(Unary::Tanh)
    }
    fn abs(self) -> Self {
        self.unary(Unary::Abs)
    }
    fn min(self, other: Self) -> Self {
        self.binary(Binary::Min, other)
    }
    fn max(self, other: Self) -> Self {
        self.binary(Binary::Max, other)
    }
    fn sigmoid(self) -> Self {
        self.unary(Unary::Sigmoid)
    }
    fn atan(self) -> Self {
        self.unary(Unary::Atan)
    }
    fn less(self, other: Self) -> Self {
        self.binary(Binary::Less, other)
    }
    fn gate(self, value: Self) -> Self {
        self.binary(Binary::Gate, value)
    }
}
