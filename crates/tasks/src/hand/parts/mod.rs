//! The hand's links, pulleys and palm as solids to print, about what is bought: line, shafts and springs.
//!
//! ```text
//!   a joint from the closing side, the shaft along x
//!
//!     cheek │ prong │pulley│ prong │ cheek
//!    ┌────┐ ┌─────┐ ┌──┬──┐ ┌─────┐ ┌────┐
//!    │    │ │     │ │  │  │ │ ┌───┤ │    │
//!  ══╪════╪═╪═════╪═╪══╪══╪═╪═╪═══╪═╪════╪══▶ x
//!    │    │ │     │ │  │  │ │ └───┤ │    │
//!    └────┘ └─────┘ └──┴──┘ └─────┘ └────┘
//!                    groove   spring
//! ```
//!
//! A link turns about its shaft by two prongs, between which the pulley sits; outside of them are the parent's cheeks. The
//! spring sits in a pocket of the prong on the side of positive x, one leg in that prong and one in the cheek. The hole in
//! the cheek is turned by the preload against the one in the prong, so that a spring whose legs are parallel when it is free
//! has the preload of the design with the hand open.
//!
//! With the hand open the link leans on both cheeks.
//!
//! The proximal pulley turns freely and carries a full turn of line, so that the line stays on it at every angle. The distal
//! one is pinned to its link, and the line ends in it.
//!
//! Every part is in the frame of its body in [`mjcf`](super::mjcf) and [`urdf`](super::urdf).

mod link;
mod palm;
mod pulley;
mod scad;
mod stock;

use super::description::HandDescription;
use super::error::HandError;
use super::names::KINDS;
use super::solid::{Layer, Mesh, stack};
use super::space::DESIGN_LEN;

pub use scad::scad;
pub use stock::Stock;

/// The part that every digit is joined to.
pub(super) const PALM_PART: &str = "palm";

/// The link after the joints of each of [`KINDS`]; the fingers share theirs.
pub(super) const LINK_PARTS: [&str; 4] =
    ["thumb_proximal_link", "thumb_distal_link", "finger_proximal_link", "finger_distal_link"];

/// The pulley on the joints of each of [`KINDS`].
pub(super) const PULLEY_PARTS: [&str; 4] =
    ["thumb_proximal_pulley", "thumb_distal_pulley", "finger_proximal_pulley", "finger_distal_pulley"];

/// A part to print.
#[derive(Clone, Debug, PartialEq)]
pub struct Part {
    /// What it is: `palm`, or kind of joint and `link` or `pulley`.
    pub name: &'static str,
    /// How many a hand has.
    pub count: usize,
    /// Its surface in the frame of its body, m.
    pub mesh: Mesh,
}

/// Palm, four links and four pulleys of a hand with this design (SI), or why they cannot be made of this stock. Every mesh is
/// closed.
pub fn parts(hand: &HandDescription, design: &[f64; DESIGN_LEN], stock: &Stock) -> Result<Vec<Part>, HandError> {
    stock.check(hand, design)?;
    let mut parts = vec![part(PALM_PART, 1, &palm::layers(hand, design, stock))?];
    for kind in 0..KINDS.len() {
        let count = if kind < 2 { 1 } else { hand.fingers.len() };
        parts.push(part(LINK_PARTS[kind], count, &link::layers(hand, design, stock, kind))?);
        parts.push(part(PULLEY_PARTS[kind], count, &pulley::layers(design[kind], is_distal(kind), stock))?);
    }
    Ok(parts)
}

fn part(name: &'static str, count: usize, layers: &[Layer]) -> Result<Part, HandError> {
    let failed = |message: String| HandError::Part { part: name, message };
    let mesh = stack(layers).map_err(|error| failed(error.to_string()))?;
    mesh.check().map_err(|error| failed(error.to_string()))?;
    Ok(Part { name, count, mesh })
}

/// Whether a kind of joint is the second of its digit.
fn is_distal(kind: usize) -> bool {
    kind % 2 == 1
}

/// Layers between neighbouring ones of these heights, in any order; `outlines` says what a height adds and what it cuts.
fn between(
    mut heights: Vec<f64>,
    outlines: impl Fn(f64) -> (Vec<super::solid::Outline>, Vec<super::solid::Outline>),
) -> Vec<Layer> {
    heights.sort_by(f64::total_cmp);
    heights.dedup();
    let layer = |pair: &[f64]| {
        let (add, cut) = outlines(0.5 * (pair[0] + pair[1]));
        Layer { heights: [pair[0], pair[1]], add, cut }
    };
    heights.windows(2).map(layer).collect()
}

#[cfg(test)]
mod tests;
