//! Training from within a program of one's own: an experiment with some settings changed, an observer that listens, and
//! the trained policy put to use.
//!
//! Run it: `cargo run --release -p hwasp-builtin --example embed_training`

#![allow(clippy::print_stdout)] // an example shows what it finds

use std::error::Error;
use std::sync::atomic::AtomicBool;

use hwasp_core::{Actor, Purpose, Serial, stream};
use hwasp_experiment::{load, resolve};
use hwasp_training::{Assembly, Event, Observer, ObserverError, train};

/// Prints every fiftieth iteration. A run folder, a progress bar and a logger are observers too.
struct Listener;

impl Observer for Listener {
    fn on(&mut self, event: Event<'_>) -> Result<(), ObserverError> {
        match event {
            Event::Iteration(row) if row.iteration % 50 == 0 => {
                println!(
                    "{:>6} steps: return {:.2}, gear {:.3}",
                    row.env_steps, row.discounted_return, row.design_totals[0]
                );
            }
            Event::Evaluated(result) => println!("held-out starts: {:.2}", result.discounted_return.mean),
            _ => {}
        }
        Ok(())
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let catalogue = hwasp_builtin::catalogue();
    // An experiment by name, or the path of a TOML file; each override is what `--set` is on the command line.
    let layers =
        load("reach", &catalogue)?.with_override("task.goal", "30 cm").with_override("train.env_steps", "400_000");
    let assembly = Assembly::new(&resolve(layers, Some("hwasp"), &catalogue)?)?;

    // Set to true from another thread or a signal handler, the flag ends training after the iteration at hand.
    let stop = AtomicBool::new(false);
    let trained = train(&assembly, &Serial, &mut Listener, &stop)?;
    let gear = assembly.policy.design(&trained.params)[0];
    println!("gear {gear:.3}, best known {:?}", assembly.worlds.optimum[0]);

    // The controller on the hardware as built, in a loop of one's own.
    let built = assembly.worlds.training.law.as_built(&[gear]);
    let policy = assembly.deployed(&built)?;
    let world = &assembly.worlds.deployment;
    let mut env = world.make.make(None);
    env.reset(&mut stream(1, Purpose::EvaluationReset, 0, 0));
    let controller = assembly.policy.controller_params(&trained.params);
    let (normalizer, mut actor) = (policy.normalizer(controller), Actor::new(&policy, controller, 1.0, 1));
    let (mut seen, mut input, mut state, mut effort) = ([0.0], [0.0], [0.0], [0.0]);
    loop {
        env.observe(&mut seen);
        env.state(&mut state);
        normalizer.apply(&seen, &mut input);
        actor.act(&input, &state, 1, None);
        world.law.effort(&built, actor.action(0), &state, &mut effort);
        if env.step(&effort, actor.action(0)).end.is_some() {
            break;
        }
    }
    env.observe(&mut seen);
    println!("the point came to {:.3} m", seen[0]);
    if (seen[0] - 0.3).abs() > 0.05 {
        return Err("the trained policy misses its goal by more than 5 cm".into());
    }
    Ok(())
}
