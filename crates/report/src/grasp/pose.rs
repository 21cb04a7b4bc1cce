//! Where everything was, from the simulator's positions.

use hwasp_mujoco::grasp::{ShapeKind, Stage};
use hwasp_tasks::hand::{HandDescription, names};
use hwasp_training::Assembly;

use super::view::{World, along, axes};
use crate::play::{PlayError, Take, grasp};

/// One moment.
#[derive(Clone, Debug)]
pub(super) struct Pose {
    /// The palm's origin, m.
    pub(super) palm: World,
    /// Both ends of each link's axis, m.
    pub(super) links: [[World; 2]; 6],
    /// The object's centre, m, and its axes.
    pub(super) object: World,
    pub(super) axes: [World; 3],
    /// Height of the object's lowest point above the floor, m.
    pub(super) clearance: f64,
}

/// An episode.
#[derive(Clone, Debug)]
pub(super) struct Poses {
    pub(super) kind: ShapeKind,
    /// Half the edges of the object's bounding box, m.
    pub(super) half: World,
    pub(super) hand: HandDescription,
    /// A pose for each step.
    pub(super) moments: Vec<Pose>,
}

/// The poses of a film.
pub(super) fn poses(assembly: &Assembly, take: &Take) -> Result<Poses, PlayError> {
    let grasp = grasp(assembly, None)?;
    let hand = grasp.settings().hand.clone();
    let mut stage = Stage::new(&grasp);
    let failed = |what: String| PlayError::Pose { index: take.index, what };
    let mut bodies = Vec::new();
    for name in names::LINK_BODIES.iter().chain([&names::PALM, &names::OBJECT]) {
        bodies.push(stage.simulation().body(name).map_err(|error| failed(error.to_string()))?);
    }
    let lengths = hand.digits().map(|digit| [digit.proximal.length, digit.distal.length]);
    let mut moments = Vec::with_capacity(take.film.stills.len());
    for still in &take.film.stills {
        stage.pose(still).map_err(|error| failed(error.to_string()))?;
        let at = |i: usize| stage.simulation().body_position(bodies[i]);
        let turned = |i: usize| axes(stage.simulation().body_orientation(bodies[i]));
        moments.push(Pose {
            palm: at(6),
            links: std::array::from_fn(|i| [at(i), along(at(i), lengths[i / 2][i % 2], turned(i)[2])]),
            object: at(7),
            axes: turned(7),
            clearance: still.clearance,
        });
    }
    let half = take.object.size.map(|edge| 0.5 * edge);
    Ok(Poses { kind: take.object.kind, half, hand, moments })
}
