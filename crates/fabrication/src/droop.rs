//! Whether springs hold the digits open against the weight of the links as they are built.

use hwasp_tasks::hand::names::KINDS;
use hwasp_tasks::hand::{DESIGN_LEN, HandDescription};
use serde::{Deserialize, Serialize};

use crate::bodies::{LinkBody, link_of};

/// Poses of a joint that are looked at, from open to closed.
const POSES: u32 = 32;

/// The pose in which a kind of joint comes nearest to falling shut, palm down.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct JointDroop {
    /// The joint.
    pub joint: String,
    /// Angles of the proximal and the distal joint of the digit, rad.
    pub pose: [f64; 2],
    /// Torque of gravity there, N·m; positive closes.
    pub weight: f64,
    /// Torque of the springs there, N·m; it opens.
    pub spring: f64,
}

impl JointDroop {
    /// What holds the joint open beyond its weight, N·m.
    pub fn margin(&self) -> f64 {
        self.spring - self.weight
    }
}

/// The worst pose of each of [`KINDS`], over the joints' whole range, palm down, with links that weigh what `bodies` says.
pub fn droop_of(hand: &HandDescription, design: &[f64; DESIGN_LEN], bodies: &[LinkBody]) -> Vec<JointDroop> {
    let [open, closed] = hand.joint.range;
    let poses = || (0..=POSES).map(|i| open + (closed - open) * f64::from(i) / f64::from(POSES));
    let worst = |kind: usize| {
        let at = |pose: [f64; 2]| JointDroop {
            joint: KINDS[kind].to_owned(),
            pose,
            weight: weight(hand, bodies, kind, pose),
            spring: design[4 + kind] * (pose[kind % 2] + design[8 + kind]),
        };
        poses()
            .flat_map(|proximal| poses().map(move |distal| at([proximal, distal])))
            .min_by(|a, b| a.margin().total_cmp(&b.margin()))
    };
    (0..KINDS.len()).filter_map(worst).collect()
}

/// Torque of gravity about a kind of joint, N·m, palm down; positive closes.
fn weight(hand: &HandDescription, bodies: &[LinkBody], kind: usize, [proximal, distal]: [f64; 2]) -> f64 {
    let first = kind - kind % 2;
    let leans = [hand.joint.rest_angle - proximal, hand.joint.rest_angle - proximal - distal];
    // How far outward of its joint a link's mass is, times that mass: z along the link, y away from the closing side.
    let of = |link: usize| {
        bodies.iter().find(|body| body.kind == first + link).map_or(0.0, |body| {
            let [_, y, z] = body.weight.centre;
            body.weight.mass * (z * leans[link].sin() + y * leans[link].cos())
        })
    };
    let carried = bodies.iter().find(|body| body.kind == first + 1).map_or(0.0, |body| body.weight.mass);
    let of_proximal = of(0) + carried * link_of(hand, first).length * leans[0].sin();
    hand.gravity * if kind % 2 == 1 { of(1) } else { of_proximal + of(1) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parts::Weight;
    use hwasp_tasks::hand::{PAPER_HWASP, droop};

    /// Links with the simulation's masses and centres weigh what the statics of the hand say, and nothing is worse than the open hand.
    #[test]
    fn simulated_links_droop_as_the_statics_say() {
        let hand = HandDescription::default();
        let bodies: Vec<LinkBody> = (0..4)
            .map(|kind| {
                let link = link_of(&hand, kind);
                let weight = Weight { mass: link.mass, centre: [0.0, 0.0, link.centre] };
                LinkBody { kind, infill: 1.0, printed: weight, weight, simulated: link.mass }
            })
            .collect();
        let found = droop_of(&hand, &PAPER_HWASP, &bodies);
        for (finger, kinds) in [(false, [0, 1]), (true, [2, 3])] {
            let known = droop(&hand, &PAPER_HWASP, finger);
            for (i, kind) in kinds.into_iter().enumerate() {
                assert_eq!(found[kind].pose, [0.0, 0.0], "{}", found[kind].joint);
                assert!((found[kind].weight - known.gravity[i]).abs() < 1e-12, "{:?}", found[kind]);
                assert!((found[kind].spring - known.springs[i]).abs() < 1e-12, "{:?}", found[kind]);
            }
        }
        // A centre on the side of the back weighs more, and most where the link hangs down.
        let mut heavy = bodies.clone();
        heavy[1].weight.centre[1] = 0.004;
        let more = droop_of(&hand, &PAPER_HWASP, &heavy)[1].weight - found[1].weight;
        assert!((more - 9.81 * heavy[1].weight.mass * 0.004 * hand.joint.rest_angle.cos()).abs() < 1e-12);
    }
}
