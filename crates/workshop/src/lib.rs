//! The workshop: what statics say of a design, the parts of a hand, and which of them has to be precise.

#![forbid(unsafe_code)]

pub mod design;
mod error;
pub mod parts;
pub mod tolerances;

pub use error::WorkshopError;
