//! The differentiation engine. A law that is written once over [`Scalar`] becomes a straight-line [`Program`], which runs
//! over the columns of a batch. Dense layers run beside it. Both have forward, vjp (reverse) and jvp (tangent), in `f32` and
//! `f64`. This crate knows nothing about robots.

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
mod vectors;

pub use dense::{Activation, Mlp, MlpTape};
pub use draw::GraphStyle;
pub use float::Float;
pub use gradcheck::{GradCheck, GradCheckError, GradCheckSettings, gradcheck};
pub use ops::{Binary, Unary};
pub use program::{Interpreter, Program, ProgramTape};
pub use scalar::Scalar;
pub use trace::Var;
