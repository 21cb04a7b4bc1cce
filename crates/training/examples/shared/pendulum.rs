//! A pendulum that has to be lifted from hanging to level and held there.
//!
//! Observation and state: `angle` (rad, 0 hanging, π/2 level) and `speed` (rad/s). Command: `motor` (N·m). Effort:
//! `torque` (N·m at the joint). Reward of a step: -(angle - π/2)² - 0.5·(motor/limit)². Episodes: 100 steps of 20 ms.

use std::f64::consts::FRAC_PI_2;

use hwasp_core::{CommandPort, Dimension, EnvSpec, Environment, Plant, Port, Robot, Stream, Task};
use rand::RngExt;

/// Stall torque of the motor, N·m.
pub(crate) const MOTOR_LIMIT: f64 = 0.1;
/// What gravity does to the level pendulum, m·g·l for 1 kg at 0.3 m, N·m.
pub(crate) const GRAVITY_TORQUE: f64 = 9.81 * 0.3;
/// m·l², kg·m².
const INERTIA: f64 = 0.09;
/// Length of a simulation step, s.
const DT: f64 = 0.005;
/// Simulation steps in one of the controller's.
const SUBSTEPS: u32 = 4;

/// A point mass on a massless arm.
#[derive(Clone, Debug, Default)]
pub(crate) struct Pendulum {
    angle: f64,
    speed: f64,
}

impl Plant for Pendulum {
    fn advance(&mut self, effort: &[f64], _command: &[f64]) {
        for _ in 0..SUBSTEPS {
            let torque = effort[0] - GRAVITY_TORQUE * self.angle.sin();
            self.speed += torque / INERTIA * DT;
            self.angle += self.speed * DT;
        }
    }

    fn state(&self, out: &mut [f64]) {
        out.copy_from_slice(&[self.angle, self.speed]);
    }
}

/// Lift it and hold it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Lift;

impl Task for Lift {
    type Plant = Pendulum;

    fn spec(&self) -> EnvSpec {
        let port = |name: &str, dimension| Port { name: name.to_owned(), dimension };
        let seen = vec![port("angle", Dimension::Angle), port("speed", Dimension::AngularSpeed)];
        EnvSpec {
            observation: seen.clone(),
            state: seen,
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
            time_step: f64::from(SUBSTEPS) * DT,
            shaped_by: vec![],
            terms: vec![],
        }
    }

    fn reset(&mut self, plant: &mut Pendulum, rng: &mut Stream) {
        *plant = Pendulum { angle: 0.4 * rng.random::<f64>() - 0.2, speed: 0.0 };
    }

    fn observe(&self, plant: &Pendulum, out: &mut [f64]) {
        plant.state(out);
    }

    fn reward(&mut self, plant: &Pendulum, command: &[f64]) -> f64 {
        -(plant.angle - FRAC_PI_2).powi(2) - 0.5 * (command[0] / MOTOR_LIMIT).powi(2)
    }
}

/// Makes one.
pub(crate) fn environment(horizon: Option<usize>) -> Box<dyn Environment> {
    Box::new(Robot::new(Pendulum::default(), Lift, horizon))
}
