//! A robot: in which order a step asks its task.

#![allow(clippy::unwrap_used)] // a panic is how a test fails

mod common;

use hwasp_core::{End, EnvSpec, Environment, Plant, Purpose, Robot, Stream, Task, stream};

/// A plant that only counts.
struct Count(f64);

impl Plant for Count {
    fn advance(&mut self, _effort: &[f64], _command: &[f64]) {
        self.0 += 1.0;
    }

    fn state(&self, out: &mut [f64]) {
        out.fill(self.0);
    }
}

/// Hold still for three steps: the reward counts them, and then the episode is over.
#[derive(Default)]
struct Hold {
    held: usize,
}

impl Task for Hold {
    type Plant = Count;

    fn spec(&self) -> EnvSpec {
        common::env_spec()
    }

    fn reset(&mut self, plant: &mut Count, _rng: &mut Stream) {
        (self.held, plant.0) = (0, 0.0);
    }

    fn observe(&self, plant: &Count, out: &mut [f64]) {
        out.fill(plant.0);
    }

    fn reward(&mut self, _plant: &Count, _command: &[f64]) -> f64 {
        self.held += 1;
        self.held as f64
    }

    fn terminated(&self, _plant: &Count) -> bool {
        self.held == 3
    }
}

/// The end was asked for before the reward had counted the step: an episode that should end with its third step went on to
/// the fourth.
#[test]
fn the_reward_of_a_step_counts_before_its_end_is_asked_for() {
    let mut robot = Robot::new(Count(0.0), Hold::default(), None);
    robot.reset(&mut stream(0, Purpose::Check, 0, 0));
    let steps = [(); 3].map(|()| robot.step(&[0.0; 2], &[0.0; 2]));
    assert_eq!(steps.map(|step| step.reward), [1.0, 2.0, 3.0]);
    assert_eq!(steps.map(|step| step.end), [None, None, Some(End::Terminated)]);
}
