//! The `MuJoCo` engine behind a safe door, and grasping with the underactuated hand. This is the only crate of the
//! workspace with `unsafe`; each block says why.

pub mod engine;
pub mod grasp;
