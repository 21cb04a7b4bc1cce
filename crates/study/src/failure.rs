//! Trainings that fail whenever they are repeated: remembered in their cells, so that nobody waits for them twice.

use std::path::Path;

use hwasp_runs::files::{Disk, json, replace};
use hwasp_runs::{RunError, io_error, saved_json};
use hwasp_training::TrainError;
use serde::{Deserialize, Serialize};

/// The file in the folder of a cell.
pub const FAILURE: &str = "failure.json";

/// Why a training failed: `failure.json` in the folder of its cell.
///
/// The same seed gives the same bits, so that the training would fail again. It is not tried again as long as this file
/// is there.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Failure {
    /// What went wrong.
    pub reason: String,
    /// The experiment that failed, every setting resolved, as TOML.
    pub experiment: String,
    /// The program that tried it.
    pub hwasp_version: String,
}

impl Failure {
    /// Of an experiment, where its error is one that comes again; none where it was asked to stop, could not write, or nobody answered.
    pub(crate) fn of(error: &TrainError, experiment: &str) -> Option<Self> {
        match error {
            TrainError::Interrupted { .. } | TrainError::Observer(_) | TrainError::Collect(_) => None,
            _ => Some(Self {
                reason: error.to_string(),
                experiment: experiment.to_owned(),
                hwasp_version: env!("CARGO_PKG_VERSION").to_owned(),
            }),
        }
    }

    /// Remembers it.
    pub(crate) fn write(&self, cell: &Path) -> Result<(), RunError> {
        let path = cell.join(FAILURE);
        replace(&Disk, &path, &json(FAILURE, self)?).map_err(|source| io_error("write", &path, source))
    }

    /// What a cell remembers of this experiment and this version of the program. Others may do better.
    pub(crate) fn read(cell: &Path, experiment: &str) -> Result<Option<Self>, RunError> {
        let found: Option<Self> = saved_json(&cell.join(FAILURE))?;
        let version = env!("CARGO_PKG_VERSION");
        Ok(found.filter(|failure| failure.experiment == experiment && failure.hwasp_version == version))
    }
}

/// A seed without figures.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct MissingSeed {
    /// The seed.
    pub seed: u64,
    /// Whether its training failed, and would fail again; otherwise it is not finished.
    pub failed: bool,
    /// Why there are no figures, in one line.
    pub reason: String,
}

impl MissingSeed {
    pub(crate) fn failed(seed: u64, reason: &str) -> Self {
        Self { seed, failed: true, reason: one_line(reason) }
    }

    pub(crate) fn unfinished(seed: u64, reason: &str) -> Self {
        Self { seed, failed: false, reason: one_line(reason) }
    }
}

/// In words: `seed 3 failed: …`.
impl std::fmt::Display for MissingSeed {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let verb = if self.failed { "failed" } else { "is not finished" };
        write!(f, "seed {} {verb}: {}", self.seed, self.reason)
    }
}

fn one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}
