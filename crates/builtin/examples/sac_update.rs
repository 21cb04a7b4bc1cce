//! Gradient steps of SAC on z-grasp with fixed hardware, 11 observations and 2 commands, 256 rows, twin critics, 256-256 throughout:
//! how long one takes, for the comparison of `benches/peers`.
//!
//!     sac_update [STEPS [THREADS [WIDTH [ROWS]]]]        default: 1000 steps, 1 thread, 256, 256
//!
//! Prints one line of JSON.

#![allow(clippy::print_stdout)] // a program

use std::error::Error;
use std::sync::Arc;
use std::time::Instant;

use hwasp_core::{EpisodeKind, Episodes, Sampler, Threads};
use hwasp_experiment::{Layers, load, resolve};
use hwasp_training::Assembly;
use serde_json::json;

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1).map(|given| given.parse::<usize>());
    let mut next = |usual| arguments.next().unwrap_or(Ok(usual));
    let (steps, threads, width, rows) = (next(1000)?, next(1)?, next(256)?, next(256)?.to_string());
    let (episodes, length) = (8, 500);
    let hidden = format!("[{width}, {width}]");
    let each = (steps as f64 / f64::from(episodes * length)).to_string();
    let settings = [
        ("learner.algorithm", "sac"),
        ("controller.hidden", &hidden),
        ("controller.activation", "relu"),
        ("controller.squash", "true"),
        ("sac.critic_hidden", &hidden),
        ("sac.batch_rows", &rows),
        ("sac.warmup_steps", "1"),
        ("sac.updates_per_step", &each),
    ];
    let catalogue = hwasp_builtin::catalogue();
    let with = |layers: Layers, (key, value): &(&str, &str)| layers.with_override(key, value);
    let layers = settings.iter().fold(load("z-grasp", &catalogue)?, with);
    let assembly = Assembly::new(&resolve(layers, Some("fixed"), &catalogue)?)?;
    let executor = Threads::new(threads)?;
    let make = Arc::clone(&assembly.worlds.training.make);
    let sampler = Sampler::new(Arc::clone(&assembly.policy), make, Some(length as usize));
    let kind = EpisodeKind::Training;
    let asked = Episodes { seed: 0, iteration: 0, indices: 0..episodes as u64, progress: 0.0, kind };
    let batch = sampler.collect(&executor, &assembly.init(), &asked)?;
    let mut learner = assembly.learner(assembly.init());
    let began = Instant::now();
    let told = learner.update(&executor, &batch, 0.0, 0)?;
    let seconds = began.elapsed().as_secs_f64();
    let updates = told.get("updates").unwrap_or_default();
    println!("{}", json!({ "steps": updates, "seconds_a_step": seconds / updates, "td_error": told.get("td_error") }));
    Ok(())
}
