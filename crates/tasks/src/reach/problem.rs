//! The reach problem as experiment files name it.

use hwasp_core::{Dimension, Initial};
use hwasp_problem::{AnyError, Built, Preset, Problem, Role, Words};
use hwasp_settings::{Fields, Settings};

use super::{Reach, ReachSettings};

/// `reach`: the gear of a point on a rail is the design.
#[derive(Clone, Copy, Debug, Default)]
pub struct ReachProblem;

/// What [`ReachProblem`] has in `[task]`.
#[derive(Clone, Debug, PartialEq)]
pub struct ReachTaskSettings {
    /// Where the point has to be, m.
    pub goal: f64,
}

impl Settings for ReachTaskSettings {
    fn fields(&mut self, fields: &mut Fields<'_, '_>) {
        fields.quantity("goal", &mut self.goal, Dimension::Length, -1.0..=1.0, "where the point has to be");
    }
}

impl Problem for ReachProblem {
    type Settings = ReachTaskSettings;

    fn name(&self) -> &'static str {
        "reach"
    }

    fn defaults(&self) -> ReachTaskSettings {
        ReachTaskSettings { goal: ReachSettings::default().goal }
    }

    fn build(&self, task: &ReachTaskSettings) -> Result<Built, AnyError> {
        let initial = Initial::Logit { half_width: 5.0 };
        let reach = Reach::new(ReachSettings { goal: task.goal, initial, ..ReachSettings::default() })?;
        let words = Words::about(
            "A motor moves a point on a rail through a gear, and the point has to reach a goal. The ratio of the gear is the design.",
        )
        .with(Role::Observation, &[("x", "place on the rail")])
        .with(Role::State, &[("x", "place on the rail")])
        .with(Role::Command, &[("speed", "speed of the motor, as a fraction of its highest")])
        .with(Role::Effort, &[("velocity", "speed of the point")]);
        Ok(Built { optimum: vec![Some(reach.optimum())], words, ..Built::new(reach.law(), reach) })
    }

    fn presets(&self) -> Vec<Preset> {
        vec![Preset::new("reach", include_str!("../../../../experiments/reach.toml"))]
    }
}
