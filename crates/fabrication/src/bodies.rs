//! The links as they are built: what they weigh with all that moves with them, and how full they are printed for that.

use hwasp_tasks::hand::names::{KINDS, LINK_PARTS, PULLEY_PARTS};
use hwasp_tasks::hand::{HandDescription, LinkDescription};

use crate::bought::{Pad, axle, bar, clip_mass, pad_mass, spring_mass};
use crate::parts::{Part, Weight, dimensions};
use crate::workshop::{SeatedSpring, Workshop};

/// How full a part can be printed: with less the shell has nothing to lie on.
const LEAST_INFILL: f64 = 0.05;
/// Infill is set in steps.
const STEP: f64 = 0.01;

/// A link with what moves with it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinkBody {
    /// Index into [`KINDS`] of the joint that it turns about.
    pub kind: usize,
    /// How full its core is printed, from 0 to 1.
    pub infill: f64,
    /// The printed link alone.
    pub printed: Weight,
    /// All of it.
    pub weight: Weight,
    /// What the simulation has.
    pub simulated: f64,
}

impl LinkBody {
    /// By which share it is off what is simulated.
    pub fn off(&self) -> f64 {
        self.weight.mass / self.simulated - 1.0
    }
}

/// The link behind a kind of joint.
pub(crate) fn link_of(hand: &HandDescription, kind: usize) -> &LinkDescription {
    let digit = if kind < 2 { &hand.thumb } else { &hand.fingers[0] };
    if kind % 2 == 1 { &digit.distal } else { &digit.proximal }
}

/// The four kinds of links of these [`parts`](crate::parts), filled so that they come as near to the simulation's masses as they can.
pub fn link_bodies(
    hand: &HandDescription,
    parts: &[Part],
    springs: &[SeatedSpring; 4],
    workshop: &Workshop,
) -> Vec<LinkBody> {
    let find = |name: &str| parts.iter().find(|part| part.name == name);
    let body = |kind: usize| {
        let filling = find(LINK_PARTS[kind])?.filling(workshop.density, workshop.shell);
        let pulley = find(PULLEY_PARTS[kind])?;
        let simulated = link_of(hand, kind).mass;
        let with = bought(hand, pulley, springs, workshop, kind);
        let missing = simulated - with.mass - (filling.full.mass - filling.core.mass);
        let share = (missing / filling.core.mass.max(f64::MIN_POSITIVE)).clamp(LEAST_INFILL, 1.0);
        let infill = (share / STEP).round() * STEP;
        let printed = filling.filled(infill);
        Some(LinkBody { kind, infill, printed, weight: printed.with(with), simulated })
    };
    (0..KINDS.len()).filter_map(body).collect()
}

/// What moves with a link beside its print. A proximal pulley sits on its axle and the axle in the palm, so these do not.
fn bought(
    hand: &HandDescription,
    pulley: &Part,
    springs: &[SeatedSpring; 4],
    workshop: &Workshop,
    kind: usize,
) -> Weight {
    let dims = dimensions(springs, workshop);
    let link = link_of(hand, kind);
    let at_joint = |mass| Weight { mass, centre: [0.0; 3] };
    let coils = f64::from(workshop.springs) * spring_mass(&springs[kind]);
    let pads = pads(hand, springs, workshop, kind);
    let of_pads = Weight {
        mass: pads.count as f64 * pad_mass(&pads, workshop.pad),
        centre: [0.0, -link.radius + 0.5 * workshop.pad, dims.setback(link.radius) + 0.5 * pads.length],
    };
    let weight = at_joint(coils).with(of_pads);
    if kind % 2 == 1 {
        let pins = 2.0 * bar(workshop.pin, dims.pin_length);
        weight.with(at_joint(pulley.mesh.volume() * workshop.density + pins))
    } else {
        let axle = axle(workshop, dims.half_width);
        let mass = bar(workshop.axle, axle.length) + 2.0 * axle.clip.map_or(0.0, |clip| clip_mass(&clip));
        weight.with(Weight { mass, centre: [0.0, 0.0, link.length] })
    }
}

/// The pads of a kind of link: two strips beside the line's way, or one around a tip.
pub fn pads(hand: &HandDescription, springs: &[SeatedSpring; 4], workshop: &Workshop, kind: usize) -> Pad {
    let dims = dimensions(springs, workshop);
    let link = link_of(hand, kind);
    let setback = dims.setback(link.radius);
    if kind % 2 == 1 {
        let around = std::f64::consts::FRAC_PI_2 * (link.radius - 0.5 * workshop.pad);
        Pad { width: 2.0 * dims.half_width, length: link.length - setback + around, count: 1 }
    } else {
        let width = dims.half_width - dims.line_way - 0.5 * workshop.print_clearance;
        Pad { width, length: link.length - 2.0 * setback, count: 2 }
    }
}
