//! A new plant and a new task: a lift with a spring of constant force that carries a part of the cabin's weight.
//!
//! Run it: `cargo run --release -p hwasp-training --example write_environment`
//!
//! The plant knows physics and no purpose, the task the purpose. `check_env` holds them to the promises that rollouts rely
//! on; then the controller and the spring's force are trained together. The best force is known here: the cabin's weight,
//! 19.62 N, because then the motor rests.

#![allow(clippy::print_stdout)] // an example shows what it finds

mod shared;

use std::error::Error;
use std::sync::Arc;

use hwasp_core::{
    CommandPort, DesignGroup, DesignSpace, Dimension, EnvSpec, Environment, Hardware, Initial, Law, MakeEnvironment,
    Placement, Plant, Port, Ports, Robot, Stream, Task, check_env,
};
use hwasp_diff::Scalar;
use rand::RngExt;

/// Mass of the cabin, kg.
const MASS: f64 = 2.0;
/// Its weight, N.
const WEIGHT: f64 = MASS * 9.81;
/// The motor pulls and pushes at most so much, N.
const MOTOR_LIMIT: f64 = 30.0;
/// Height of the shaft, m.
const SHAFT: f64 = 3.0;
/// Length of a step, s.
const DT: f64 = 0.02;
/// Where the cabin has to be, m above the floor.
const GOAL: f64 = 2.0;

/// A cabin in a shaft.
#[derive(Clone, Debug, Default)]
struct Cabin {
    height: f64,
    speed: f64,
}

impl Plant for Cabin {
    /// `effort` is the force of motor and spring, N upwards.
    fn advance(&mut self, effort: &[f64], _command: &[f64]) {
        self.speed += (effort[0] - WEIGHT) / MASS * DT;
        self.height += self.speed * DT;
    }

    fn state(&self, out: &mut [f64]) {
        out.copy_from_slice(&[self.height, self.speed]);
    }
}

/// Bring the cabin to its goal and spare the motor, without touching floor or roof.
#[derive(Clone, Copy, Debug)]
struct Deliver;

impl Task for Deliver {
    type Plant = Cabin;

    fn spec(&self) -> EnvSpec {
        let port = |name: &str, dimension| Port { name: name.to_owned(), dimension };
        let seen = vec![port("height", Dimension::Length), port("speed", Dimension::Speed)];
        EnvSpec {
            observation: seen.clone(),
            state: seen,
            context: vec![],
            effort: vec![port("force", Dimension::Force)],
            command: vec![CommandPort {
                name: "motor".to_owned(),
                dimension: Dimension::Force,
                lo: -MOTOR_LIMIT,
                hi: MOTOR_LIMIT,
                direct: true,
            }],
            horizon: 150,
            time_step: DT,
            shaped_by: vec![],
            terms: vec![],
        }
    }

    fn reset(&mut self, plant: &mut Cabin, rng: &mut Stream) {
        *plant = Cabin { height: 0.5 + 2.0 * rng.random::<f64>(), speed: 0.0 };
    }

    fn observe(&self, plant: &Cabin, out: &mut [f64]) {
        plant.state(out);
    }

    // Positive everywhere in the shaft: where rewards are negative, a crash that ends the episode would pay.
    fn reward(&mut self, plant: &Cabin, command: &[f64]) -> f64 {
        1.0 - ((plant.height - GOAL) / SHAFT).powi(2) - 0.3 * (command[0] / MOTOR_LIMIT).powi(2)
    }

    fn terminated(&self, plant: &Cabin) -> bool {
        !(0.0..=SHAFT).contains(&plant.height)
    }
}

/// The motor beside a spring of constant force.
struct Balancer {
    design: DesignSpace,
}

impl Hardware for Balancer {
    fn design(&self) -> &DesignSpace {
        &self.design
    }

    fn ports(&self) -> Ports {
        let names = |names: &[&str]| names.iter().map(|&n| n.to_owned()).collect();
        Ports { command: names(&["motor"]), state: names(&["height", "speed"]), effort: names(&["force"]) }
    }

    fn effort<T: Scalar>(&self, design: &[T], command: &[T], _state: &[T], effort: &mut [T]) {
        effort[0] = command[0] + design[0];
    }
}

fn environment(horizon: Option<usize>) -> Box<dyn Environment> {
    Box::new(Robot::new(Cabin::default(), Deliver, horizon))
}

fn main() -> Result<(), Box<dyn Error>> {
    let (dimension, lo, hi, count) = (Dimension::Force, 0.0, 40.0, 1);
    let group = DesignGroup { name: "balance".into(), dimension, lo, hi, count, initial: Initial::Value(5.0) };
    let law = Law::new(Balancer { design: DesignSpace::new(vec![group])? });
    let make: Arc<dyn MakeEnvironment> = Arc::new(environment);

    check_env(&*make, &law, false)?;
    println!("the environment keeps its promises");

    let found = shared::train(&law, &make, Placement::Graph, (&[GOAL, 0.0], &[1.0, 1.0]), 3.0)?;
    let (first, force) = (found.first[0], found.design[0]);
    println!(
        "spring {first:.2} N -> {force:.2} N (weight {WEIGHT:.2} N), discounted return {:.2}",
        found.discounted_return
    );
    if (force - WEIGHT).abs() > 1.0 {
        return Err(format!("the spring should have come within 1 N of the weight, not to {force:.2} N").into());
    }
    Ok(())
}
