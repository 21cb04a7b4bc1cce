//! Solids that are stacks of flat layers, as closed meshes: all that printed parts are made of.

mod faces;
mod grid;
mod layers;
mod mesh;
mod outline;
mod wall;

pub(crate) use faces::{Face, faces};
pub(crate) use grid::{core, thinnest_along};
pub use layers::Axis;
pub(crate) use layers::{Layer, stack};
pub use mesh::{Mesh, MeshError};
pub(crate) use outline::{
    HOLE_SEGMENTS, Outline, SEGMENTS, around, band, disc, hole, polygon, rectangle, shaved, slot,
};
pub use wall::Wall;
pub(crate) use wall::thinnest_across;
