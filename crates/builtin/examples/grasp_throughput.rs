//! How much of the time of a training of z-grasp by TRPO the simulator takes, and where the rest goes. The last line says it in JSON.
//!
//!     grasp_throughput [THREADS [ITERATIONS]]        default: 2 threads, 2 iterations of 20,000 steps
//!
//! The clock runs inside of every environment step, which is ten steps of the physics. What the same threads would do
//! stepping the same physics alone is their number over the mean of those times.

#![allow(clippy::print_stdout)] // a program

use std::error::Error;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

use hwasp_core::{Environment, EpisodeKind, Episodes, Sampler, Step, Threads, Watch, Watched};
use hwasp_experiment::{load, resolve};
use hwasp_training::Assembly;
use serde_json::json;

/// Adds up the time of steps.
struct Timer {
    nanoseconds: Arc<AtomicU64>,
}

impl Watch for Timer {
    fn step(&mut self, inner: &mut dyn Environment, effort: &[f64], command: &[f64]) -> Step {
        let began = Instant::now();
        let step = inner.step(effort, command);
        self.nanoseconds.fetch_add(began.elapsed().as_nanos() as u64, Ordering::Relaxed);
        step
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1).map(|argument| argument.parse::<u64>());
    let threads = arguments.next().transpose()?.unwrap_or(2);
    let iterations = arguments.next().transpose()?.unwrap_or(2);
    let settings = [
        ("learner.algorithm", "trpo".to_owned()),
        ("train.episodes_per_iteration", "40".to_owned()),
        ("train.env_steps", (20_000 * iterations).to_string()),
    ];
    let catalogue = hwasp_builtin::catalogue();
    let layers =
        settings.iter().fold(load("z-grasp", &catalogue)?, |layers, (key, value)| layers.with_override(key, value));
    let mut assembly = Assembly::new(&resolve(layers, None, &catalogue)?)?;
    let (whole, nanoseconds) = (Arc::clone(&assembly.worlds.training.make), Arc::new(AtomicU64::new(0)));
    let counted = Arc::clone(&nanoseconds);
    assembly.worlds.training.make = Arc::new(move |horizon| {
        let timer = Timer { nanoseconds: Arc::clone(&counted) };
        Box::new(Watched::new(whole.make(horizon), timer)) as Box<dyn Environment>
    });

    let executor = Threads::new(threads as usize)?;
    let train = &assembly.experiment().train;
    let sampler = Sampler::new(
        Arc::clone(&assembly.policy),
        Arc::clone(&assembly.worlds.training.make),
        Some(train.episode_steps),
    );
    let mut learner = assembly.learner(assembly.init());
    let (mut sampling, mut updating, mut steps) = (0.0, 0.0, 0.0);
    for iteration in 0..iterations {
        let progress = iteration as f64 / iterations as f64;
        let indices = 0..train.episodes_per_iteration as u64;
        let asked = Episodes { seed: 0, iteration, indices, progress, kind: EpisodeKind::Training };
        let began = Instant::now();
        let batch = sampler.collect(&executor, learner.params(), &asked)?;
        let collected = Instant::now();
        learner.update(&executor, &batch, progress, iteration)?;
        sampling += (collected - began).as_secs_f64();
        updating += collected.elapsed().as_secs_f64();
        steps += batch.rows() as f64;
    }
    let physics = 1e-9 * nanoseconds.load(Ordering::Relaxed) as f64 / threads as f64;
    let whole = sampling + updating;

    println!("z-grasp, {steps} steps on {threads} threads");
    println!("  training, everything included  {:8.0} steps/s", steps / whole);
    println!("  the same physics alone         {:8.0} steps/s", steps / physics);
    println!("  share of the time in physics   {:8.1} %", 100.0 * physics / whole);
    println!("  controller, law, waiting       {:8.1} %", 100.0 * (sampling - physics) / whole);
    println!("  updates                        {:8.1} %", 100.0 * updating / whole);
    println!(
        "{}",
        json!({ "training": steps / whole, "physics": steps / physics, "share": physics / whole,
                "acting": (sampling - physics) / whole, "updates": updating / whole })
    );
    Ok(())
}
