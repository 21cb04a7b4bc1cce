//! How much of the time of a training of z-grasp the simulator takes, and where the rest goes. The last line says it in JSON.
//!
//!     grasp_throughput [THREADS [ITERATIONS]]        default: 2 threads, 2 iterations of 20,000 steps
//!
//! The clock runs inside of every environment step, which is ten steps of the physics. What the same threads would do
//! stepping the same physics alone is their number over the mean of those times.

#![allow(clippy::print_stdout)] // a program

use std::error::Error;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::Instant;

use hwasp_core::{EnvSpec, Environment, EpisodeKind, Episodes, Outcome, Sampler, Step, Stream, Threads};
use hwasp_lab::{Assembly, spec, train};
use serde_json::json;

/// An environment that adds up the time of its steps.
struct Timed {
    inner: Box<dyn Environment>,
    nanoseconds: Arc<AtomicU64>,
}

impl Environment for Timed {
    fn spec(&self) -> &EnvSpec {
        self.inner.spec()
    }

    fn set_progress(&mut self, progress: f64) {
        self.inner.set_progress(progress);
    }

    fn reset(&mut self, rng: &mut Stream) {
        self.inner.reset(rng);
    }

    fn observe(&self, out: &mut [f64]) {
        self.inner.observe(out);
    }

    fn state(&self, out: &mut [f64]) {
        self.inner.state(out);
    }

    fn step(&mut self, effort: &[f64], command: &[f64]) -> Step {
        let began = Instant::now();
        let step = self.inner.step(effort, command);
        self.nanoseconds.fetch_add(began.elapsed().as_nanos() as u64, Ordering::Relaxed);
        step
    }

    fn outcome(&self) -> Option<Outcome> {
        self.inner.outcome()
    }

    fn fault(&self) -> Option<String> {
        self.inner.fault()
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1).map(|argument| argument.parse::<u64>());
    let threads = arguments.next().transpose()?.unwrap_or(2);
    let iterations = arguments.next().transpose()?.unwrap_or(2);
    let settings =
        [("train.env_steps", (20_000 * iterations).to_string()), ("train.evaluation_episodes", "1".to_owned())];
    let layers = settings.iter().fold(spec::load("z-grasp")?, |layers, (key, value)| layers.with_override(key, value));
    let mut assembly = Assembly::new(&spec::resolve(layers, None)?)?;
    let (whole, nanoseconds) = (Arc::clone(&assembly.problem.training.make), Arc::new(AtomicU64::new(0)));
    let counted = Arc::clone(&nanoseconds);
    assembly.problem.training.make = Arc::new(move |horizon| {
        Box::new(Timed { inner: whole.make(horizon), nanoseconds: Arc::clone(&counted) }) as Box<dyn Environment>
    });

    let executor = Threads::new(threads as usize)?;
    let trained = train(&assembly, &executor, &mut (), &AtomicBool::new(false))?;
    let steps = trained.env_steps as f64;
    let physics = 1e-9 * nanoseconds.load(Ordering::Relaxed) as f64 / threads as f64;

    // The same episodes again, without learning.
    let horizon = assembly.spec().train.episode_steps;
    let sampler =
        Sampler::new(Arc::clone(&assembly.policy), Arc::clone(&assembly.problem.training.make), Some(horizon));
    let params = assembly.init();
    let began = Instant::now();
    for iteration in 0..iterations {
        let indices = 0..assembly.spec().train.episodes_per_iteration as u64;
        let asked = Episodes { seed: 0, iteration, indices, progress: 0.0, kind: EpisodeKind::Training };
        sampler.collect(&executor, &params, &asked)?;
    }
    let sampling = began.elapsed().as_secs_f64();

    let share = |seconds: f64| seconds / trained.wall_s;
    let (acting, updates) = (share((sampling - physics).max(0.0)), share((trained.wall_s - sampling).max(0.0)));
    println!("z-grasp, {steps} steps on {threads} threads");
    println!("  training, everything included  {:8.0} steps/s", steps / trained.wall_s);
    println!("  the same physics alone         {:8.0} steps/s", steps / physics);
    println!("  share of the time in physics   {:8.1} %", 100.0 * share(physics));
    println!("  controller, law, bookkeeping   {:8.1} %", 100.0 * acting);
    println!("  updates                        {:8.1} %", 100.0 * updates);
    println!(
        "{}",
        json!({ "training": steps / trained.wall_s, "physics": steps / physics, "share": share(physics),
                "acting": acting, "updates": updates })
    );
    Ok(())
}
