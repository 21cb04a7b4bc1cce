//! The hand on the bench: what of it is printed in a workshop, and what that takes.
//!
//! A [`Workshop`] says what is bought and what the printer can do. [`parts`] makes the solids of a design for it and the springs
//! that were chosen; [`scad`] says the same shapes by parameters.

#![forbid(unsafe_code)]

mod error;
mod parts;
mod solid;
mod workshop;

pub use error::PartError;
pub use parts::{Part, coupon, parts, scad};
pub use solid::{Axis, Mesh, MeshError};
pub use workshop::{SeatedSpring, Workshop};
