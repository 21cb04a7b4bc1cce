//! The MuJoCo engine behind a safe door. This is the only crate of the workspace with `unsafe`; each block says why.

pub mod engine;
