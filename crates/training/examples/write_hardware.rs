//! A new mechanism: a gear between a motor and a pendulum, its ratio trained together with the controller.
//!
//! Run it: `cargo run --release -p hwasp-training --example write_hardware`
//!
//! The law below is all there is to write. It is run by the simulator, and traced it becomes a part of the policy that the
//! policy gradient passes through. The plant is in `shared/pendulum.rs`, the training loop in `shared/mod.rs`.

#![allow(clippy::print_stdout)] // an example shows what it finds

#[path = "shared/pendulum.rs"]
mod pendulum;
mod shared;

use std::sync::Arc;

use hwasp_core::{DesignGroup, DesignSpace, Dimension, Hardware, Initial, Law, MakeEnvironment, Placement, Ports};
use hwasp_diff::Scalar;

/// A gear without friction. The motor turns `ratio` times as fast as the joint, and loses torque the faster it turns.
struct Gear {
    design: DesignSpace,
}

/// Torque that the motor loses per speed of its shaft (back-EMF), N·m·s/rad: none is left at 400 rad/s.
const BACK_EMF: f64 = pendulum::MOTOR_LIMIT / 400.0;

impl Hardware for Gear {
    fn design(&self) -> &DesignSpace {
        &self.design
    }

    fn ports(&self) -> Ports {
        let names = |names: &[&str]| names.iter().map(|&n| n.to_owned()).collect();
        Ports { command: names(&["motor"]), state: names(&["angle", "speed"]), effort: names(&["torque"]) }
    }

    fn effort<T: Scalar>(&self, design: &[T], command: &[T], state: &[T], effort: &mut [T]) {
        let ratio = design[0];
        let shaft_speed = ratio * state[1];
        effort[0] = ratio * (command[0] - shaft_speed * BACK_EMF);
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let (dimension, lo, hi, count) = (Dimension::None, 10.0, 150.0, 1);
    let group = DesignGroup { name: "ratio".into(), dimension, lo, hi, count, initial: Initial::Value(20.0) };
    let law = Law::new(Gear { design: DesignSpace::new(vec![group])? });
    let make: Arc<dyn MakeEnvironment> = Arc::new(pendulum::environment);
    let train = |placement| shared::train(&law, &make, placement, (&[0.0, 0.0], &[1.0, 5.0]), 1.0);

    let found = train(Placement::Graph)?;
    let (first, ratio) = (found.first[0], found.design[0]);
    println!("ratio {first:.1} -> {ratio:.1}, discounted return {:.2}", found.discounted_return);

    // A low gear is too weak to hold the pendulum level (that takes m·g·l / 0.1 N·m = 29.4), a high one too slow to lift it
    // in time. What is best in between has no formula, but a controller trained for each of some fixed ratios tells.
    let sweep = [20.0, 40.0, 60.0, 80.0, 100.0, 140.0];
    let mut returns = Vec::new();
    for fixed in sweep {
        returns.push(train(Placement::Fixed(fixed))?.discounted_return);
        println!("fixed at {fixed:>5}: {:.2}", returns[returns.len() - 1]);
    }
    let best = (1..sweep.len() - 1).fold(1, |best, i| if returns[i] > returns[best] { i } else { best });
    if !(sweep[best - 1]..=sweep[best + 1]).contains(&ratio) {
        return Err(format!("ratio {ratio:.1} is not beside the best of the sweep, {}", sweep[best]).into());
    }
    Ok(())
}
