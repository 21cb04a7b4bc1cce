//! The hand's links, pulleys and palm as solids to print, about what is bought: line, axles and springs.
//!
//! ```text
//!   a joint from the closing side, the axle along x
//!
//!     cheek │ prong │pulley│ prong │ cheek
//!    ┌────┐ ┌─────┐ ┌──┬──┐ ┌─────┐ ┌────┐
//!    │    │ ├───┐ │ │  │  │ │ ┌───┤ │    │
//!  ══╪════╪═╪═══╪═╪═╪══╪══╪═╪═╪═══╪═╪════╪══▶ x
//!    │    │ ├───┘ │ │  │  │ │ └───┤ │    │
//!    └────┘ └─────┘ └──┴──┘ └─────┘ └────┘
//!            spring  groove   spring
//! ```
//!
//! A link turns about its axle by two prongs, between which the pulley sits; outside of them are the parent's cheeks. Springs sit
//! in pockets of the prongs, the first on the side of positive x, the second on the other side, and so on in turn. A pocket is as
//! wide and as long as the springs that were chosen for the joint need. One leg of each is in the prong, the other in one of the
//! holes of the cheek, which are as far apart as the [`Workshop`] says; which of them, the parts list says.
//!
//! With the hand open the link leans on both cheeks.
//!
//! The proximal pulley turns freely and carries a full turn of line, so that the line stays on it at every angle. The distal
//! one is pinned to its link, and the line ends in it after three quarters of a turn with the hand open.
//!
//! Every part is in the frame of its body in [`mjcf`](hwasp_tasks::hand::mjcf) and [`urdf`](hwasp_tasks::hand::urdf).

mod cage;
mod coupon;
mod guide;
mod layout;
mod link;
mod mount;
mod palm;
mod pulley;
mod scad;
mod spool;

use hwasp_tasks::hand::names::{KINDS, LINK_PARTS, MOUNT_PARTS, PALM_PART, PULLEY_PARTS};
use hwasp_tasks::hand::{DESIGN_LEN, HandDescription};

use crate::error::PartError;
use crate::solid::{Axis, Layer, Mesh, Outline, stack};
use crate::workshop::{SeatedSpring, Workshop};
use layout::Layout;

pub use scad::scad;

/// A part to print.
#[derive(Clone, Debug, PartialEq)]
pub struct Part {
    /// What it is: `palm`, kind of joint and `link` or `pulley`, or one of [`MOUNT_PARTS`].
    pub name: &'static str,
    /// How many a hand has.
    pub count: usize,
    /// Its surface in the frame of its body, m; what is on the palm is in the frame of the palm.
    pub mesh: Mesh,
    /// The axis along which it is a stack of layers, and which is upright in the printer.
    pub axis: Axis,
    /// The layers, from low to high.
    pub(crate) layers: Vec<Layer>,
}

/// Palm, four links, four pulleys and what is on the palm, of a hand with this design (SI) and these springs at each of [`KINDS`], or
/// why they cannot be made in this workshop. Every mesh is closed.
pub fn parts(
    hand: &HandDescription,
    design: &[f64; DESIGN_LEN],
    springs: &[SeatedSpring; 4],
    workshop: &Workshop,
) -> Result<Vec<Part>, PartError> {
    let layout = &Layout { workshop, springs };
    layout.check(hand, design)?;
    let mut parts = vec![part(PALM_PART, 1, Axis::X, palm::layers(hand, design, layout))?];
    for kind in 0..KINDS.len() {
        let count = if kind < 2 { 1 } else { hand.fingers.len() };
        parts.push(part(LINK_PARTS[kind], count, Axis::X, link::layers(hand, design, layout, kind))?);
        parts.push(part(PULLEY_PARTS[kind], count, Axis::X, pulley::layers(kind, design[kind], layout))?);
    }
    let mount = [
        guide::layers(hand, design, layout),
        spool::drum(hand, layout),
        spool::hub(hand, layout),
        cage::cage(hand, layout),
        cage::plate(hand, layout),
        cage::ring(hand, layout),
    ];
    for (name, layers) in MOUNT_PARTS.into_iter().zip(mount) {
        parts.push(part(name, 1, Axis::Z, layers)?);
    }
    Ok(parts)
}

/// The test coupon: holes and walls as the hand has them, to be printed first and tried with what was bought.
pub fn coupon(springs: &[SeatedSpring; 4], workshop: &Workshop) -> Result<Part, PartError> {
    part("test_coupon", 1, Axis::Z, coupon::layers(&Layout { workshop, springs }))
}

/// Turns of round outlines that are tried one after the other, rad: at most 4 µm at the rim of the largest pulley.
const TURNS: [f64; 4] = [0.0, 1e-4, -1.7e-4, 3.1e-4];

fn part(name: &'static str, count: usize, axis: Axis, layers: Vec<Layer>) -> Result<Part, PartError> {
    let made = |turn| {
        let mesh = stack(&layers.iter().map(|layer| layer.turned(turn)).collect::<Vec<_>>(), axis);
        let mesh = mesh.map_err(|error| error.to_string())?;
        mesh.check().map_err(|error| error.to_string())?;
        Ok(mesh)
    };
    // Of some designs a corner of an outline falls on an edge of another by chance. Turned a little, it falls beside it.
    let plain: Result<Mesh, String> = made(TURNS[0]);
    let mesh = plain.or_else(|message| TURNS[1..].iter().find_map(|&turn| made(turn).ok()).ok_or(message));
    let mesh = mesh.map_err(|message| PartError::Part { part: name, message })?;
    Ok(Part { name, count, mesh, axis, layers })
}

/// Whether a kind of joint is the second of its digit.
fn is_distal(kind: usize) -> bool {
    kind % 2 == 1
}

/// Layers between neighbouring ones of these heights, in any order; `outlines` says what a height adds and what it cuts.
fn between(mut heights: Vec<f64>, outlines: impl Fn(f64) -> (Vec<Outline>, Vec<Outline>)) -> Vec<Layer> {
    heights.sort_by(f64::total_cmp);
    // Heights that nearly agree are one: a layer between them would be too low for a file.
    heights.dedup_by(|later, earlier| *later - *earlier < 1e-6);
    let layer = |pair: &[f64]| {
        let (add, cut) = outlines(0.5 * (pair[0] + pair[1]));
        Layer { heights: [pair[0], pair[1]], add, cut }
    };
    heights.windows(2).map(layer).collect()
}
