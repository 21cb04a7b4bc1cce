//! What the blocks of a design come to: good, tight or bad, with the limit that they are judged by.

use std::fmt;

use hwasp_fabrication::Workshop;
use hwasp_tasks::hand::HandDescription;
use serde::Serialize;

use super::GroupReport;
use super::hand::{HEAVIEST, JointReport, PinchReport};

/// The share of its range that a parameter should keep from its limits.
const FROM_LIMITS: f64 = 0.05;
/// What a figure should have beyond what is wanted, as a share.
const RESERVE: f64 = 0.2;
/// Parameters that a sentence names.
const NAMED: usize = 4;

/// How a block does.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Grade {
    /// As it should be, with room.
    Good,
    /// As it has to be, and no more; or a limit decides.
    Tight,
    /// Not as it has to be.
    Bad,
}

impl Grade {
    /// `good`, `tight` or `bad`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Good => "good",
            Self::Tight => "tight",
            Self::Bad => "bad",
        }
    }

    /// Of something of which there is as much as it takes, and with a reserve, or not.
    fn of(enough: bool, reserve: bool) -> Self {
        match (enough, reserve) {
            (true, true) => Self::Good,
            (true, false) => Self::Tight,
            (false, _) => Self::Bad,
        }
    }
}

/// A block, judged. It prints as `tight: …`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Judgement {
    /// How it does.
    pub grade: Grade,
    /// In words, with figures and limits.
    pub told: String,
}

impl fmt::Display for Judgement {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.grade.name(), self.told)
    }
}

/// The blocks of a hand.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct HandJudgements {
    /// Whether springs hold it open, palm down.
    pub open: Judgement,
    /// Whether its fingertips lift the heaviest object.
    pub pinch: Judgement,
    /// Whether its motor winds enough to close it and to pull.
    pub closing: Judgement,
}

impl HandJudgements {
    pub(super) fn of(
        hand: &HandDescription,
        (joints, pinches): (&[JointReport], &[PinchReport]),
        (end, spends_its_tension): (f64, bool),
    ) -> Self {
        Self {
            open: open(joints),
            pinch: pinch(pinches, hand.transmission.tension_limit),
            closing: closing((end, hand.transmission.travel), spends_its_tension, hand.transmission.tension_limit),
        }
    }
}

/// How far the parameters are from their limits; none where nothing is designed.
pub(super) fn limits(groups: &[GroupReport]) -> Option<Judgement> {
    let of_group = |group: &GroupReport| -> Vec<(f64, String)> {
        let name =
            |i: usize| if group.position.len() == 1 { group.name.clone() } else { format!("{}[{i}]", group.name) };
        let near = |(i, &position): (usize, &f64)| {
            let side = if position < 0.5 { "above its lower" } else { "below its upper" };
            let from = position.min(1.0 - position).max(0.0);
            (from, format!("{} ({:.1} % {side} limit)", name(i), 100.0 * from))
        };
        group.position.iter().enumerate().map(near).collect()
    };
    let mut all: Vec<(f64, String)> = groups.iter().flat_map(of_group).collect();
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    let near = all.iter().filter(|(from, _)| *from < FROM_LIMITS).count();
    let percent = 100.0 * FROM_LIMITS;
    let (_, nearest) = all.first()?;
    Some(if near == 0 {
        let told =
            format!("all parameters keep {percent:.0} % of their range and more from its limits; nearest is {nearest}");
        Judgement { grade: Grade::Good, told }
    } else {
        let names: Vec<&str> = all.iter().take(near.min(NAMED)).map(|(_, told)| told.as_str()).collect();
        let more = if near > NAMED { ", …" } else { "" };
        let (count, names) = (all.len(), names.join(", "));
        let told = format!(
            "{near} of {count} are nearer than {percent:.0} % of their range to a limit, which may decide instead of the training: {names}{more}"
        );
        Judgement { grade: Grade::Tight, told }
    })
}

/// Whether the springs of a hand hold its joints open, by as much as a workshop wants.
fn open(joints: &[JointReport]) -> Judgement {
    let wanted = Workshop::default().droop_margin;
    let mm = |torque: f64| format!("{:.2} N·mm", 1e3 * torque);
    let Some(worst) = joints.iter().min_by(|a, b| a.margin.total_cmp(&b.margin)) else {
        return Judgement { grade: Grade::Good, told: "there are no joints".into() };
    };
    let (grade, joint) = (Grade::of(worst.margin >= 0.0, worst.margin >= wanted), worst.joint.replace('_', " "));
    let told = match grade {
        Grade::Bad => format!("{joint} falls shut, its spring is {} short of the weight", mm(-worst.margin)),
        Grade::Tight | Grade::Good => format!("all stay open, {joint} by the least, {}", mm(worst.margin)),
    };
    Judgement { grade, told: format!("{told}; a margin of {} is wanted", mm(wanted)) }
}

/// Whether the fingertips lift the heaviest object at the limit of the tension, whatever its width.
fn pinch(pinches: &[PinchReport], tension_limit: f64) -> Judgement {
    let capacity = |pinch: &PinchReport| pinch.capacity.unwrap_or(0.0);
    let Some(weakest) = pinches.iter().min_by(|a, b| capacity(a).total_cmp(&capacity(b))) else {
        return Judgement { grade: Grade::Good, told: "nothing is pinched".into() };
    };
    let lifts = capacity(weakest);
    let grade = Grade::of(lifts >= HEAVIEST, lifts >= (1.0 + RESERVE) * HEAVIEST);
    let told = format!(
        "at {tension_limit:.0} N the fingertips lift {:.0} g at {:.0} mm, where they lift least; the heaviest object has {:.0} g{}",
        1e3 * lifts,
        1e3 * weakest.width,
        1e3 * HEAVIEST,
        if grade == Grade::Good { "" } else { ", and has to be embraced" }
    );
    Judgement { grade, told }
}

/// Whether the motor reaches its limit before it has wound all there is.
fn closing((end, travel): (f64, f64), spends_its_tension: bool, tension_limit: f64) -> Judgement {
    let (end_mm, travel_mm) = (1e3 * end, 1e3 * travel);
    if !spends_its_tension {
        let told = format!(
            "all {travel_mm:.1} mm are wound before the tendons pull {tension_limit:.0} N: it cannot grip as it should"
        );
        return Judgement { grade: Grade::Bad, told };
    }
    let spare = 1.0 - end / travel;
    Judgement {
        grade: Grade::of(true, spare >= RESERVE),
        told: format!(
            "the tendons pull {tension_limit:.0} N at {end_mm:.1} mm of the {travel_mm:.1} mm that can be wound; {:.0} % to spare are wanted",
            100.0 * RESERVE
        ),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::design::DigitPair;

    fn group(name: &str, position: &[f64]) -> GroupReport {
        let group = hwasp_runs::DesignGroupSummary {
            unit: "m".into(),
            limits: [0.0, 1.0],
            values: position.to_vec(),
            as_built: position.to_vec(),
            total: 0.0,
            total_as_built: 0.0,
            optimum: None,
        };
        GroupReport { name: name.into(), group, position: position.to_vec() }
    }

    #[test]
    fn parameters_at_their_limits_are_tight() {
        assert_eq!(limits(&[]), None);
        let free = limits(&[group("gear", &[0.5]), group("bar", &[0.06, 0.9])]).unwrap();
        assert_eq!(
            free.to_string(),
            "good: all parameters keep 5 % of their range and more from its limits; nearest is bar[0] (6.0 % above its lower limit)"
        );
        let near = limits(&[group("gear", &[0.5]), group("bar", &[0.04, 0.999])]).unwrap();
        assert_eq!(near.grade, Grade::Tight);
        assert!(
            near.told.ends_with(": bar[1] (0.1 % below its upper limit), bar[0] (4.0 % above its lower limit)"),
            "{near}"
        );
        let many = limits(&[group("stiffness", &[0.0; 10])]).unwrap().told;
        assert!(many.starts_with("10 of 10 are nearer") && many.ends_with("limit), …"), "{many}");
    }

    #[test]
    fn springs_are_judged_by_the_joint_that_is_nearest_to_falling() {
        let joint = |joint: &'static str, margin: f64| JointReport {
            joint,
            design: [0.0; 3],
            paper_hwasp: [0.0; 3],
            paper_minimal: [0.0; 3],
            weight: 0.0,
            spring: margin,
            margin,
        };
        let told = |margin: f64| open(&[joint("thumb_distal", 0.004), joint("finger_distal", margin)]).to_string();
        assert_eq!(
            told(0.001),
            "good: all stay open, finger distal by the least, 1.00 N·mm; a margin of 0.50 N·mm is wanted"
        );
        assert!(told(0.0002).starts_with("tight: all stay open"), "{}", told(0.0002));
        assert!(
            told(-0.003).starts_with("bad: finger distal falls shut, its spring is 3.00 N·mm short"),
            "{}",
            told(-0.003)
        );
    }

    #[test]
    fn pinches_are_judged_by_the_weakest() {
        let pinch_of = |width: f64, capacity: Option<f64>| PinchReport {
            width,
            band: None,
            torque_ratio: DigitPair { thumb: None, finger: None },
            capacity,
            heaviest: None,
        };
        let grade = |capacity| pinch(&[pinch_of(0.04, Some(2.0)), pinch_of(0.08, capacity)], 75.0).grade;
        assert_eq!(
            [Some(0.6), Some(0.55), Some(0.3), None].map(grade),
            [Grade::Good, Grade::Tight, Grade::Bad, Grade::Bad]
        );
        let told = pinch(&[pinch_of(0.08, Some(0.3))], 75.0).told;
        assert!(
            told.starts_with("at 75 N the fingertips lift 300 g at 80 mm") && told.ends_with("has to be embraced"),
            "{told}"
        );
    }

    #[test]
    fn a_motor_needs_travel_to_spare() {
        let grade = |end: f64, spends| closing((end, 0.045), spends, 75.0).grade;
        assert_eq!(
            [grade(0.028, true), grade(0.043, true), grade(0.045, false)],
            [Grade::Good, Grade::Tight, Grade::Bad]
        );
    }
}
