//! The `MuJoCo` engine behind a safe interface, and grasping with the underactuated hand. This is the only crate of the
//! workspace with `unsafe`; each block says why it is sound.

pub mod engine;
pub mod grasp;
