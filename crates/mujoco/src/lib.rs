//! The `MuJoCo` engine behind a safe interface. This is the only crate of the workspace with `unsafe`; each block says why it is
//! sound.

pub mod engine;
