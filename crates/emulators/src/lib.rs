//! The bench as a process of its own: it speaks as arm and motor do, fails when it is told to, and has physics behind it.
#![forbid(unsafe_code)]

pub mod bench;
pub mod dynamixel;
pub mod hand;
pub mod ur;
mod world;

pub use dynamixel::DynamixelEmulator;
pub use hand::HandWorld;
pub use world::{FreeSpool, STEP, SpoolDrive, SpoolState, World};
