//! The primitive operations: each value and derivative formula stands here, once, for every way of running a program.

// Every loop must end up inside the function that pulp compiles for the widest vector instructions.
#![allow(clippy::inline_always)]

use crate::Float;

/// A function of one number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Unary {
    /// -a.
    Neg,
    /// e to the power of a.
    Exp,
    /// The natural logarithm.
    Ln,
    /// The square root.
    Sqrt,
    /// The sine of an angle in radians.
    Sin,
    /// The cosine of an angle in radians.
    Cos,
    /// The hyperbolic tangent.
    Tanh,
    /// The absolute value.
    Abs,
    /// The logistic function 1 / (1 + e^-a).
    Sigmoid,
    /// The angle in radians whose tangent is a, within ±π/2.
    Atan,
}

/// A function of two numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Binary {
    /// a + b.
    Add,
    /// a - b.
    Sub,
    /// a·b.
    Mul,
    /// a / b.
    Div,
    /// The smaller of two.
    Min,
    /// The larger of two.
    Max,
    /// 1 where a < b, else 0. It is flat: both derivatives are zero.
    Less,
    /// b where a is not 0, else 0, whatever b is there. Its derivative by the condition a is zero.
    Gate,
}

impl Unary {
    /// The value at `a`, in the arithmetic that [`Scalar`](crate::Scalar) for `f64` uses.
    #[inline(always)]
    pub(crate) fn value<F: Float>(self, a: F) -> F {
        match self {
            Self::Neg => -a,
            Self::Exp => a.exp(),
            Self::Ln => a.ln(),
            Self::Sqrt => a.sqrt(),
            Self::Sin => a.sin(),
            Self::Cos => a.cos(),
            Self::Tanh => a.tanh(),
            Self::Abs => a.abs(),
            Self::Sigmoid => {
                // The exponent is never positive, so nothing overflows.
                let e = (-a.abs()).exp();
                let d = F::ONE + e;
                if a >= F::ZERO { F::ONE / d } else { e / d }
            }
            Self::Atan => a.atan(),
        }
    }

    /// `g` times the derivative at `a`, where the value is `v`. Being a plain product it serves both directions: a
    /// cotangent is pulled back with it and a tangent pushed forward. Where one factor is zero so is the product, whatever the
    /// other one is: what nobody reads may be no number, and what changes nothing may change at any rate.
    #[inline(always)]
    pub(crate) fn pull<F: Float>(self, g: F, a: F, v: F) -> F {
        match self {
            Self::Neg => -g,
            Self::Exp => product(g, v, g * v),
            Self::Ln => unread(g, g / a),
            Self::Sqrt => unread(g, g * F::from_f64(0.5) / v),
            Self::Sin => unread(g, g * a.cos()),
            Self::Cos => {
                let sin = a.sin();
                product(g, sin, -g * sin)
            }
            Self::Tanh => {
                let slope = F::ONE - v * v;
                product(g, slope, g * slope)
            }
            Self::Abs => {
                let signed = if a < F::ZERO { -g } else { g };
                if a == F::ZERO { F::ZERO } else { signed }
            }
            Self::Sigmoid => {
                let slope = v * (F::ONE - v);
                product(g, slope, g * slope)
            }
            Self::Atan => unread(g, g / (F::ONE + a * a)),
        }
    }
}

impl Binary {
    /// The value at `(a, b)`.
    #[inline(always)]
    pub(crate) fn value<F: Float>(self, a: F, b: F) -> F {
        match self {
            Self::Add => a + b,
            Self::Sub => a - b,
            Self::Mul => a * b,
            Self::Div => a / b,
            Self::Min if b < a => b,
            Self::Max if b > a => b,
            Self::Min | Self::Max => a,
            Self::Less => select(a < b, F::ONE, F::ZERO),
            Self::Gate => select(a == F::ZERO, F::ZERO, b),
        }
    }

    /// `g` times the derivative by the first operand, where the value is `v`.
    #[inline(always)]
    pub(crate) fn pull_a<F: Float>(self, g: F, a: F, b: F, _v: F) -> F {
        match self {
            Self::Add | Self::Sub => g,
            Self::Mul => product(g, b, g * b),
            Self::Div => unread(g, g / b),
            Self::Min => select(b < a, F::ZERO, g),
            Self::Max => select(b > a, F::ZERO, g),
            Self::Less | Self::Gate => F::ZERO,
        }
    }

    /// `g` times the derivative by the second operand, where the value is `v`.
    #[inline(always)]
    pub(crate) fn pull_b<F: Float>(self, g: F, a: F, b: F, v: F) -> F {
        match self {
            Self::Add => g,
            Self::Sub => -g,
            Self::Mul => product(g, a, g * a),
            Self::Div => product(g, v, -(g * v / b)),
            Self::Min => select(b < a, g, F::ZERO),
            Self::Max => select(b > a, g, F::ZERO),
            Self::Less => F::ZERO,
            Self::Gate => select(a == F::ZERO, F::ZERO, g),
        }
    }
}

/// A product of `g` and a `slope`: zero where the slope is zero and `g` is infinite or no number, and as [`unread`] has it.
#[inline(always)]
fn product<F: Float>(g: F, slope: F, product: F) -> F {
    // What is finite keeps its bits, the sign of a zero among them.
    let flat = select(product == F::ZERO, product, F::ZERO);
    unread(g, select(slope == F::ZERO, flat, product))
}

/// A product with `g`, whose other factor may be no number where `g` is zero.
#[inline(always)]
fn unread<F: Float>(g: F, product: F) -> F {
    select(g == F::ZERO, g, product)
}

#[inline(always)]
fn select<F: Float>(choice: bool, yes: F, no: F) -> F {
    if choice { yes } else { no }
}

/// Runs `$body` with `$OP` a constant, so that the match on the operation happens outside of the loop over rows.
macro_rules! with_unary {
    ($op:expr, $OP:ident => $body:expr) => {
        with_unary!(@ $op, $OP => $body; Neg Exp Ln Sqrt Sin Cos Tanh Abs Sigmoid Atan)
    };
    (@ $op:expr, $OP:ident => $body:expr; $($name:ident)*) => {
        match $op {
            $(Unary::$name => { const $OP: Unary = Unary::$name; $body })*
        }
    };
}

/// As [`with_unary`], for two operands.
macro_rules! with_binary {
    ($op:expr, $OP:ident => $body:expr) => {
        with_binary!(@ $op, $OP => $body; Add Sub Mul Div Min Max Less Gate)
    };
    (@ $op:expr, $OP:ident => $body:expr; $($name:ident)*) => {
        match $op {
            $(Binary::$name => { const $OP: Binary = Binary::$name; $body })*
        }
    };
}

pub(crate) use {with_binary, with_unary};
