//! The workshop, where a design becomes parts: what statics say about it, which parts come nearest, and which of them have to
//! be precise.

#![forbid(unsafe_code)]

pub mod design;
mod error;
mod folder;
pub mod parts;
pub mod tolerances;

pub use error::WorkshopError;
pub use folder::writable;
