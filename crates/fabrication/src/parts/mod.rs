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
use crate::solid::{Axis, Layer, Mesh, Outline, Wall, core, stack, thinnest_across, thinnest_along};
use crate::workshop::{SeatedSpring, Workshop};
use layout::Layout;

pub(crate) use mount::TURN_PIN;
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

/// Mass and centre of mass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Weight {
    /// Mass, kg.
    pub mass: f64,
    /// Centre of mass in the frame of the body, m.
    pub centre: [f64; 3],
}

impl Weight {
    /// Both together.
    #[must_use]
    pub fn with(self, other: Self) -> Self {
        let mass = self.mass + other.mass;
        let whole = mass.max(f64::MIN_POSITIVE);
        let centre = [0, 1, 2].map(|i| (self.mass * self.centre[i] + other.mass * other.centre[i]) / whole);
        Self { mass, centre }
    }
}

/// What a part weighs: as it is printed full, and what of that is in its core and can be filled in part.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Filling {
    /// The whole part, printed full.
    pub full: Weight,
    /// Its core.
    pub core: Weight,
}

impl Filling {
    /// With a core that is filled by a share from 0 to 1.
    pub fn filled(&self, share: f64) -> Weight {
        let left_out = self.core.mass * (1.0 - share);
        self.full.with(Weight { mass: -left_out, centre: self.core.centre })
    }
}

impl Part {
    /// The thinnest wall, in its mesh: across its layers or along them.
    pub fn thinnest_wall(&self) -> Wall {
        let across = thinnest_across(&self.mesh, self.axis);
        let along = thinnest_along(&self.layers);
        if along.thickness < across.thickness {
            Wall { at: self.axis.point(along.at.0, along.at.1), thickness: along.thickness }
        } else {
            across
        }
    }

    /// What it weighs of a material of this density, kg/m³, under a shell of this thickness, m: the volume of the mesh, less that of the
    /// core.
    pub fn filling(&self, density: f64, shell: f64) -> Filling {
        let core = core(&self.layers, shell);
        Filling {
            full: Weight { mass: density * self.mesh.volume(), centre: self.mesh.centre() },
            core: Weight { mass: density * core.volume, centre: self.axis.point(core.middle.0, core.middle.1) },
        }
    }
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

/// Figures of the layout that bought parts follow.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Dimensions<'a> {
    layout: Layout<'a>,
    /// Half of a joint's width, from cheek to cheek, m.
    pub(crate) half_width: f64,
    /// Half of the way of a line in a link, m.
    pub(crate) line_way: f64,
    /// Pins between a distal pulley and its link, m.
    pub(crate) pin_length: f64,
}

impl Dimensions<'_> {
    /// From a joint to where the whole width of a link of this radius begins, m.
    pub(crate) fn setback(&self, radius: f64) -> f64 {
        self.layout.setback(radius)
    }
}

/// Those of this workshop with these springs.
pub(crate) fn dimensions<'a>(springs: &'a [SeatedSpring; 4], workshop: &'a Workshop) -> Dimensions<'a> {
    let layout = Layout { workshop, springs };
    // From the groove through flange and gap into the thinnest floor of a prong.
    let pin_length = layout.flange() + workshop.print_clearance + layout.plate();
    Dimensions { layout, half_width: layout.half_width(), line_way: layout.channel(), pin_length }
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
