//! The differentiation engine: a law written once over [`Scalar`] becomes a straight-line [`Program`] that runs over
//! columns of a batch; dense layers run beside it. Both offer forward, vjp (reverse) and jvp (tangent), in `f32` and `f64`.
//! This crate knows nothing of robots.

#![forbid(unsafe_code)]

mod dense;
mod draw;
pub mod fast;
mod float;
mod gradcheck;
mod ops;
mod program;
mod scalar;
mod trace;

pub use dense::{Activation, Mlp, MlpTape};
pub use draw::GraphStyle;
pub use float::Float;
pub use gradcheck::{GradCheck, GradCheckError, GradCheckSettings, gradcheck};
pub use ops::{Binary, Unary};
pub use program::{Interpreter, Program, ProgramTape};
pub use scalar::Scalar;
pub use trace::Var;
