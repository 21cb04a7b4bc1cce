//! Drawings as SVG: each part with its dimensions, and pictures of the steps of the assembly.

mod dimensions;
mod picture;
mod sheet;

pub(crate) use picture::{Placed, picture};
pub(crate) use sheet::part_drawing;
