//! Solids that are stacks of flat layers, as closed meshes: all that printed links, pulleys and a palm are made of.

mod layers;
mod mesh;
mod outline;

pub use layers::Axis;
pub(crate) use layers::{Layer, stack};
pub use mesh::{Mesh, MeshError};
pub(crate) use outline::{
    HOLE_SEGMENTS, Outline, SEGMENTS, around, band, contains, disc, edges, hole, polygon, rectangle, shaved, slot,
};
