//! Dense layers: kernels, and the perceptron built of them.

pub(crate) mod aligned;
pub(crate) mod kernels;
mod mlp;
mod passes;

pub use mlp::{Activation, Mlp, MlpTape};
