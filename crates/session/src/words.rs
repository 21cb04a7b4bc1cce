//! Words that several commands and Python use.

use std::path::Path;

use hwasp_experiment::Experiment;
use hwasp_runs::text::grouped;
use hwasp_training::Checkpoint;

/// The line before a training.
pub fn beginning(spec: &Experiment, path: &Path, resumed: bool, from: Option<&Checkpoint>) -> String {
    let steps = grouped(spec.train.env_steps);
    let (verb, steps) = match from {
        Some(_) if !resumed => ("training", format!("further for {steps}")),
        Some(from) => ("resuming", format!("after {} of {steps}", grouped(from.env_steps))),
        None if resumed => ("resuming", format!("from the beginning (it has no checkpoint yet) for {steps}")),
        None => ("training", format!("for {steps}")),
    };
    let (name, method, seed) = (&spec.name, spec.method.name(), spec.seed);
    format!("{verb} {name} ({method}, seed {seed}) {steps} steps into {}", path.display())
}

/// A path as a shell reads it.
pub fn shell(path: &Path) -> String {
    let path = path.display().to_string();
    let plain = |c: char| c.is_alphanumeric() || "/._-+".contains(c);
    if path.chars().all(plain) { path } else { format!("'{}'", path.replace('\'', "'\\''")) }
}
