//! Whether the hand of a run can be built of its parts, and why: the one verdict that all commands tell.

use std::path::Path;

use hwasp_experiment::Catalogue;
use hwasp_fabrication::{FittedSpring, LegHoles, Verdict, Workshop, verdict};
use hwasp_runs::{RunError, saved_experiment};
use hwasp_tasks::hand::{DESIGN_LEN, HandDescription};

use super::list::design_of;
use super::{ChosenParts, JointParts};
use crate::design::{DesignReport, hand_of};

/// The springs of four kinds of joints as the hand is made for them.
pub(super) fn fitted(joints: &[JointParts; 4]) -> [FittedSpring; 4] {
    joints.each_ref().map(|joint| FittedSpring {
        part: joint.spring.part.clone(),
        seated: joint.spring.seated(),
        stress_share: joint.spring.stress_share,
    })
}

/// The verdict on a hand that is built of these parts.
pub(super) fn verdict_on(hand: &HandDescription, joints: &[JointParts; 4], workshop: &Workshop) -> Verdict {
    verdict(hand, &design_of(joints, |joint| joint.built), &fitted(joints), workshop)
}

impl ChosenParts {
    /// The springs of each kind of joint, as the hand is made for them.
    pub fn fitted(&self) -> [FittedSpring; 4] {
        fitted(&self.joints)
    }

    /// The holes of their fixed legs.
    pub fn leg_holes(&self) -> LegHoles {
        self.joints.each_ref().map(|joint| joint.spring.hole)
    }

    /// Whether the hand can be built of them, and why.
    pub fn verdict(&self, hand: &HandDescription) -> Verdict {
        verdict_on(hand, &self.joints, &self.workshop)
    }
}

/// Whether the hand of a finished run can be built, and why: of the parts that [`ChosenParts::of_run`] finds. `None` for what is no hand.
/// Where there are no parts, the verdict says what kept them from being found.
pub fn verdict_of_run(run: &Path, catalogue: &Catalogue) -> Result<Option<Verdict>, RunError> {
    let experiment = saved_experiment(run, &[], catalogue)?;
    let Some(hand) = hand_of(&experiment) else { return Ok(None) };
    let report = DesignReport::open(run, catalogue)?;
    let built: Vec<f64> = report.groups.into_iter().flat_map(|group| group.group.as_built).collect();
    let design: [f64; DESIGN_LEN] = std::array::from_fn(|i| built[i]);
    let chosen = ChosenParts::of_run(run, &experiment, hand, &design);
    Ok(Some(match chosen {
        Ok(chosen) => chosen.verdict(hand),
        Err(error) => Verdict::without_parts(error.to_string().replace("\n  = hint:", ";").replace('\n', ";")),
    }))
}
