//! The pendulum as experiment files name it.

use hwasp_core::Initial;
use hwasp_problem::{AnyError, Built, Preset, Problem, Role, Words};

use super::{Pendulum, PendulumSettings};

/// `pendulum`: the gear is the design; the rest is the classic problem, and there is nothing to set.
#[derive(Clone, Copy, Debug, Default)]
pub struct PendulumProblem;

impl Problem for PendulumProblem {
    type Settings = ();

    fn name(&self) -> &'static str {
        "pendulum"
    }

    fn defaults(&self) {}

    fn build(&self, (): &()) -> Result<Built, AnyError> {
        let initial = Initial::Logit { half_width: 5.0 };
        let pendulum = Pendulum::new(&PendulumSettings { initial, ..PendulumSettings::default() })?;
        let words = Words::about(
            "A motor too weak to lift a pendulum in one go has to swing it up and hold it there. The ratio of the gear behind the \
             motor is the design.",
        )
        .with(
            Role::Observation,
            &[
                ("cos", "cosine of the angle from upright"),
                ("sin", "sine of the angle from upright"),
                ("speed", "angular speed, counter-clockwise"),
            ],
        )
        .with(
            Role::State,
            &[
                ("angle", "angle from upright, counter-clockwise, not wrapped"),
                ("speed", "angular speed, counter-clockwise"),
            ],
        )
        .with(Role::Command, &[("motor", "torque of the motor, before the gear")])
        .with(Role::Effort, &[("torque", "torque on the rod, behind the gear")]);
        Ok(Built { words, ..Built::new(pendulum.law(), pendulum) })
    }

    fn presets(&self) -> Vec<Preset> {
        vec![
            Preset::new("pendulum", include_str!("../../../../experiments/pendulum.toml")),
            Preset::new("pendulum-trpo", include_str!("../../../../experiments/pendulum-trpo.toml")),
            Preset::new("pendulum-sac", include_str!("../../../../experiments/pendulum-sac.toml")),
        ]
    }
}
