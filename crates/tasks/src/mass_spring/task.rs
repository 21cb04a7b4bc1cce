//! The purpose: bring the lower mass to the goal and keep it there with as little motor as can be.

use hwasp_core::{CommandPort, EnvSpec, Sight, Stream, Task};
use rand::RngExt;

use super::look::Looks;
use super::{Coupling, MassSpringPlant, MassSpringSettings, Reward, ports};

/// Starts anywhere in the range of the upper mass, sees y1 and v1, and never ends early.
#[derive(Clone, Debug)]
pub struct MassSpringTask {
    coupling: Coupling,
    reward: Reward,
    goal: f64,
    motor_limit: f64,
    horizon: usize,
    /// Of an action, s.
    time_step: f64,
    max_position: f64,
    max_speed: f64,
    /// How far the lower mass starts below the upper one.
    initial_gap: f64,
    looks: Looks,
}

impl MassSpringTask {
    /// The task for a plant of this coupling.
    pub fn new(settings: &MassSpringSettings, coupling: Coupling) -> Self {
        let (reward, initial_gap) = match coupling {
            Coupling::FixedBar(length) => (settings.stiffness_reward, length),
            // The middle of the range of ONE segment: what the authors' code does, and calls a guess. A rigid bar has
            // its true length from the first step on.
            Coupling::GivenBar | Coupling::Free => {
                (settings.bar_reward, 0.5 * settings.max_total_length / settings.count as f64)
            }
        };
        Self {
            coupling,
            reward,
            goal: settings.goal,
            motor_limit: settings.motor_limit(),
            horizon: settings.horizon,
            time_step: settings.time_step * settings.substeps as f64,
            max_position: settings.max_position,
            max_speed: settings.max_speed,
            initial_gap,
            looks: Looks::new(settings),
        }
    }
}

impl Task for MassSpringTask {
    type Plant = MassSpringPlant;

    fn spec(&self) -> EnvSpec {
        let (name, dimension) = ports::MOTOR;
        let effort = match self.coupling {
            Coupling::FixedBar(_) => ports::EFFORT,
            Coupling::GivenBar => ports::LENGTH,
            Coupling::Free => ports::INTERFACE,
        };
        EnvSpec {
            observation: ports::of_environment(ports::OBSERVATION),
            state: ports::of_environment(ports::STATE),
            context: vec![],
            effort: ports::of_environment(effort),
            command: vec![CommandPort {
                name: name.to_owned(),
                dimension,
                lo: -self.motor_limit,
                hi: self.motor_limit,
                direct: true,
            }],
            horizon: self.horizon,
            time_step: self.time_step,
            shaped_by: vec![],
            terms: vec![],
        }
    }

    fn set_design(&mut self, design: &[f64]) {
        self.looks.set_design(design);
    }

    fn reset(&mut self, plant: &mut MassSpringPlant, rng: &mut Stream) {
        let y1 = rng.random::<f64>() * self.max_position;
        let v1 = (rng.random::<f64>() * 2.0 - 1.0) * self.max_speed;
        plant.place(y1, v1, self.initial_gap);
    }

    #[inline]
    fn observe(&self, plant: &MassSpringPlant, out: &mut [f64]) {
        let (y1, v1) = plant.upper();
        out.copy_from_slice(&[y1, v1]);
    }

    #[inline]
    fn reward(&mut self, plant: &MassSpringPlant, command: &[f64]) -> f64 {
        let (y2, v2) = plant.lower();
        self.reward.value(y2 - self.goal, v2, command[0], self.motor_limit)
    }

    fn look(&mut self, plant: &MassSpringPlant) -> Option<Sight> {
        Some(self.looks.sight(plant))
    }
}
