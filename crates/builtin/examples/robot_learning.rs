//! Learning curves as published benchmarks have them: every so many steps of a training its deterministic policy on a few held-out
//! starts. Each line is a training in JSON: its seed, the curve, and the evaluation at the end.
//!
//!     robot_learning EXPERIMENT EVERY EPISODES SEED...        e.g. robot_learning hopper.toml 30000 10 100 101 102
//!
//! One thread. `python benches/gym/learning.py` runs it and compares.

#![allow(clippy::print_stdout)] // a program

use std::error::Error;
use std::sync::atomic::AtomicBool;

use hwasp_core::Serial;
use hwasp_experiment::{load, resolve};
use hwasp_training::{Assembly, Event, Observer, ObserverError, evaluate, params_at, train};
use serde_json::json;

/// Evaluates on the way.
struct Curve<'a> {
    assembly: &'a Assembly,
    every: u64,
    episodes: u64,
    due: bool,
    next: u64,
    /// Steps, and the mean return by then.
    points: Vec<(u64, f64)>,
}

impl Observer for Curve<'_> {
    fn on(&mut self, event: Event<'_>) -> Result<(), ObserverError> {
        match event {
            Event::Iteration(row) if row.env_steps >= self.next => self.due = true,
            Event::Checkpoint(checkpoint) if self.due => {
                let point = self.point(checkpoint.env_steps, &params_at(self.assembly, checkpoint).map_err(boxed)?)?;
                self.points.push(point);
                self.due = false;
                self.next += self.every;
            }
            _ => {}
        }
        Ok(())
    }

    fn due(&self) -> bool {
        self.due
    }
}

impl Curve<'_> {
    /// Each point has starts of its own, as has the evaluation at the end.
    fn point(&self, env_steps: u64, params: &[f32]) -> Result<(u64, f64), ObserverError> {
        let seed = self.assembly.experiment().train.evaluation_seed + 1 + env_steps;
        let evaluation = evaluate(self.assembly, params, (self.episodes, seed), &Serial).map_err(boxed)?;
        Ok((env_steps, evaluation.undiscounted_return.mean))
    }
}

fn boxed(error: impl Error + Send + Sync + 'static) -> ObserverError {
    ObserverError(Box::new(error))
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [file, every, episodes, seeds @ ..] = &arguments[..] else {
        println!("robot_learning EXPERIMENT EVERY EPISODES SEED...: see benches/gym/learning.py");
        return Ok(());
    };
    let (every, episodes): (u64, u64) = (every.parse()?, episodes.parse()?);
    let catalogue = hwasp_builtin::catalogue();
    for seed in seeds {
        let layers = load(file, &catalogue)?.with_override("seed", seed);
        let assembly = Assembly::new(&resolve(layers, Some("fixed"), &catalogue)?)?;
        let mut curve = Curve { assembly: &assembly, every, episodes, due: false, next: every, points: Vec::new() };
        let trained = train(&assembly, &Serial, &mut curve, &AtomicBool::new(false))?;
        let end = &trained.evaluation.undiscounted_return;
        println!("{}", json!({ "seed": seed, "curve": curve.points, "final": end.mean, "train_s": trained.wall_s }));
    }
    Ok(())
}
