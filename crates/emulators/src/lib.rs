//! The bench as a process of its own: it speaks as arm and motor do, fails when it is told to, and has physics behind it.
#![forbid(unsafe_code)]

pub mod ur;
mod world;

pub use world::{SpoolDrive, SpoolState, World};
