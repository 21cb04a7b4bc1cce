//! The task: bring the lamp to an angle and hold it there, with as little motor as possible.

use hwasp_core::{CommandPort, Cord, Dimension, EnvSpec, Plant, Port, Sight, Stream, Task};
use rand::RngExt;

use crate::arm::{Arm, PIVOT, TIME_STEP};
use crate::spring::{ANCHOR, HOOK};

/// What the motor gives at most, of either sign, N·m: not enough to hold the level arm without a spring.
const MOTOR_LIMIT: f64 = 1.5;

/// Hold the lamp at `goal`, rad from upright.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Hold {
    pub(crate) goal: f64,
}

impl Task for Hold {
    type Plant = Arm;

    /// Names, units and limits of what goes in and out, and the length of an episode.
    fn spec(&self) -> EnvSpec {
        let port = |name: &str, dimension| Port { name: name.to_owned(), dimension };
        let both = vec![port("angle", Dimension::Angle), port("speed", Dimension::AngularSpeed)];
        EnvSpec {
            observation: both.clone(),
            state: both,
            context: vec![],
            effort: vec![port("torque", Dimension::Torque)],
            command: vec![CommandPort {
                name: "motor".to_owned(),
                dimension: Dimension::Torque,
                lo: -MOTOR_LIMIT,
                hi: MOTOR_LIMIT,
                direct: true,
            }],
            horizon: 100,
            time_step: TIME_STEP,
            shaped_by: vec![],
            terms: vec![],
        }
    }

    /// At rest, within 0.3 rad of the goal.
    fn reset(&mut self, arm: &mut Arm, rng: &mut Stream) {
        arm.place(self.goal + 0.6 * rng.random::<f64>() - 0.3);
    }

    fn observe(&self, arm: &Arm, out: &mut [f64]) {
        arm.state(out);
    }

    /// The motor that holds what the spring does not costs as much as being far off.
    fn reward(&mut self, arm: &Arm, command: &[f64]) -> f64 {
        1.0 - (arm.angle() - self.goal).powi(2) - (command[0] / MOTOR_LIMIT).powi(2)
    }

    /// What films show: the arm and its spring, m. Without this method there are none.
    fn look(&mut self, arm: &Arm) -> Option<Sight> {
        let (sin, cos) = arm.angle().sin_cos();
        let ends = [[0.0, 0.0, PIVOT + ANCHOR], [HOOK * sin, 0.0, PIVOT + HOOK * cos]];
        let mut sight = arm.sight();
        sight.cords.push(Cord::spring(ends, [0.01, 0.0, 0.0], 11, [213, 94, 0]));
        sight.told = format!("{:.0}° from upright", arm.angle().to_degrees());
        Some(sight)
    }
}
