//! TRPO's update of z-grasp, 20,000 rows of an 11-128-128-2 controller under the tendon law: how long it takes, and, for the
//! comparison of `benches/peers`, the rows and parameters that others need to make the same update.
//!
//!     trpo_update [UPDATES [THREADS [SHARE [FOLDER]]]]        default: 1 update, 1 thread, curvature of all rows
//!
//! Every update starts anew from the same parameters. Prints one line of JSON.

#![allow(clippy::print_stdout)] // a program

use std::error::Error;
use std::fs;
use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

use hwasp_core::{Batch, EpisodeKind, Episodes, Policy, Sampler, Threads};
use hwasp_experiment::{load, resolve};
use hwasp_tasks::grasp::GraspTaskSettings;
use hwasp_training::Assembly;
use serde_json::json;

fn write(folder: &Path, assembly: &Assembly, batch: &Batch) -> Result<(), Box<dyn Error>> {
    fs::create_dir_all(folder)?;
    let task: &GraspTaskSettings = assembly.experiment().task.settings().ok_or("z-grasp is a grasp")?;
    let (policy, transmission) = (&assembly.policy, task.hand().transmission);
    let groups = policy.groups().iter().map(|group| (group.kind.name(), [group.range.start, group.range.end]));
    let limits = |(lo, hi)| [lo, hi];
    let about = json!({
        "controller": policy.controller().sizes(),
        "groups": groups.collect::<std::collections::BTreeMap<_, _>>(),
        "design_limits": (0..policy.space().len()).map(|i| limits(policy.space().bounds(i))).collect::<Vec<_>>(),
        "command_limits": assembly.worlds.training.make.make(None).spec().command.iter().map(|c| [c.lo, c.hi]).collect::<Vec<_>>(),
        "tendon_stiffness": transmission.tendon_stiffness,
        "tension_limit": transmission.tension_limit,
        "spool_radius": transmission.spool_radius,
        "travel": transmission.travel,
        "reference": transmission.reference,
        "episodes": batch.episodes.len(),
    });
    fs::write(folder.join("policy.json"), about.to_string())?;
    let params = assembly.init();
    let rewards: Vec<f32> = batch.reward.iter().map(|&reward| reward as f32).collect();
    for (name, numbers) in [
        ("params", &params),
        ("obs", &batch.obs),
        ("state", &batch.state),
        ("action", &batch.action),
        ("log_prob", &batch.log_prob),
        ("reward", &rewards),
    ] {
        let bytes: Vec<u8> = numbers.iter().flat_map(|x| x.to_le_bytes()).collect();
        fs::write(folder.join(name).with_extension("f32"), bytes)?;
    }
    Ok(())
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let updates = arguments.next().map_or(Ok(1), |count| count.parse::<usize>())?;
    let threads = arguments.next().map_or(Ok(1), |count| count.parse::<usize>())?;
    let share = arguments.next().unwrap_or_else(|| "1.0".to_owned());
    // Ten products, however small the residual.
    let settings = [
        ("learner.algorithm", "trpo"),
        ("train.episodes_per_iteration", "40"),
        ("trpo.fisher_rows", share.as_str()),
        ("trpo.cg_iterations", "10"),
        ("trpo.cg_tolerance", "0.0"),
    ];
    let catalogue = hwasp_builtin::catalogue();
    let layers =
        settings.iter().fold(load("z-grasp", &catalogue)?, |layers, (key, value)| layers.with_override(key, value));
    let assembly = Assembly::new(&resolve(layers, None, &catalogue)?)?;

    let executor = Threads::new(threads)?;
    let train = &assembly.experiment().train;
    let sampler = Sampler::new(
        Arc::clone(&assembly.policy),
        Arc::clone(&assembly.worlds.training.make),
        Some(train.episode_steps),
    );
    let indices = 0..train.episodes_per_iteration as u64;
    let asked = Episodes { seed: 0, iteration: 0, indices, progress: 0.0, kind: EpisodeKind::Training };
    let batch = sampler.collect(&executor, &assembly.init(), &asked)?;
    if let Some(folder) = arguments.next() {
        write(Path::new(&folder), &assembly, &batch)?;
    }

    let mut seconds = Vec::new();
    let mut last = None;
    for _ in 0..updates {
        let mut learner = assembly.learner(assembly.init());
        let began = Instant::now();
        last = Some(learner.update(&executor, &batch, 0.0, 0)?);
        seconds.push(began.elapsed().as_secs_f64());
    }
    let told = |name| last.as_ref().and_then(|metrics| metrics.get(name));
    println!(
        "{}",
        json!({ "rows": batch.rows(), "seconds": seconds, "kl": told("kl"),
                "cg_iterations": told("cg_iterations"), "tried": told("tried") })
    );
    Ok(())
}
