//! Solids that are stacks of flat layers, as closed meshes: all that printed links, pulleys and a palm are made of.

mod layers;
mod mesh;
mod outline;

pub(super) use layers::{Layer, stack};
pub use mesh::{Mesh, MeshError};
pub(super) use outline::{HOLE_SEGMENTS, Outline, SEGMENTS, around, disc, hole, polygon, rectangle, slot};
