//! The number type that a law is written over.

use std::iter::Sum;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// A real number, or a traced stand-in for one.
///
/// A hardware law is written once over `T: Scalar`. With `T = f64` it runs inside the simulator; with
/// [`Var`](crate::Var) it is recorded as a [`Program`](crate::Program) that can be run over columns, differentiated and
/// drawn. Constants mix in from the right as plain `f64`: `(y2 - y1) * 0.5`.
///
/// A law must not branch on values: what is traced is one straight line. Use [`min`](Scalar::min),
/// [`max`](Scalar::max), [`abs`](Scalar::abs) and [`clamp`](Scalar::clamp) instead, and where there has to be a choice
/// [`less`](Scalar::less) with [`gate`](Scalar::gate).
pub trait Scalar:
    Copy
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + Add<f64, Output = Self>
    + Sub<f64, Output = Self>
    + Mul<f64, Output = Self>
    + Div<f64, Output = Self>
    + Sum<Self>
{
    /// A constant.
    fn constant(value: f64) -> Self;
    /// e to the power of `self`.
    fn exp(self) -> Self;
    /// The natural logarithm.
    fn ln(self) -> Self;
    /// The square root.
    fn sqrt(self) -> Self;
    /// The sine of an angle in radians.
    fn sin(self) -> Self;
    /// The cosine of an angle in radians.
    fn cos(self) -> Self;
    /// The hyperbolic tangent.
    fn tanh(self) -> Self;
    /// The absolute value; its derivative at zero is taken as zero.
    fn abs(self) -> Self;
    /// The smaller of two; the derivative follows `self` where they are equal.
    fn min(self, other: Self) -> Self;
    /// The larger of two; the derivative follows `self` where they are equal.
    fn max(self, other: Self) -> Self;
    /// The logistic function 1 / (1 + e^-x).
    fn sigmoid(self) -> Self;
    /// The angle in radians whose tangent is `self`, within ±π/2.
    fn atan(self) -> Self;
    /// 1 where `self` is less than `other`, else 0; flat, so that no derivative passes.
    fn less(self, other: Self) -> Self;
    /// `value` where `self` is not 0, else 0, whatever `value` is there: `c.gate(a) + (not c).gate(b)` is a choice in which the
    /// side that is not chosen may even be NaN. The derivative passes to the chosen side alone.
    fn gate(self, value: Self) -> Self;
    /// `self` limited to `[lo, hi]`; no derivative outside.
    #[must_use]
    fn clamp(self, lo: f64, hi: f64) -> Self {
        self.max(Self::constant(lo)).min(Self::constant(hi))
    }
}

/// The logistic function of a plain number, in the form that never overflows.
fn logistic(x: f64) -> f64 {
    let e = (-x.abs()).exp();
    if x >= 0.0 { 1.0 / (1.0 + e) } else { e / (1.0 + e) }
}

impl Scalar for f64 {
    #[inline]
    fn constant(value: f64) -> Self {
        value
    }
    #[inline]
    fn exp(self) -> Self {
        f64::exp(self)
    }
    #[inline]
    fn ln(self) -> Self {
        f64::ln(self)
    }
    #[inline]
    fn sqrt(self) -> Self {
        f64::sqrt(self)
    }
    #[inline]
    fn sin(self) -> Self {
        f64::sin(self)
    }
    #[inline]
    fn cos(self) -> Self {
        f64::cos(self)
    }
    #[inline]
    fn tanh(self) -> Self {
        f64::tanh(self)
    }
    #[inline]
    fn abs(self) -> Self {
        f64::abs(self)
    }
    #[inline]
    fn min(self, other: Self) -> Self {
        if other < self { other } else { self }
    }
    #[inline]
    fn max(self, other: Self) -> Self {
        if other > self { other } else { self }
    }
    #[inline]
    fn sigmoid(self) -> Self {
        logistic(self)
    }
    #[inline]
    fn atan(self) -> Self {
        f64::atan(self)
    }
    #[inline]
    fn less(self, other: Self) -> Self {
        if self < other { 1.0 } else { 0.0 }
    }
    #[inline]
    fn gate(self, value: Self) -> Self {
        if self == 0.0 { 0.0 } else { value }
    }
}
