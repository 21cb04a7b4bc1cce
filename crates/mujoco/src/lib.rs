//! The `MuJoCo` engine behind a safe door, the underactuated hand, and grasping with it. This is the only crate of the
//! workspace with `unsafe`; each block says why.

pub mod engine;
pub mod grasp;
pub mod hand;
