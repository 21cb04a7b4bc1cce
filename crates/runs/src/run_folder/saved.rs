//! Run folders read back.

use std::fs::File;
use std::io::{self, BufReader};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use hwasp_experiment::{Catalogue, EXPERIMENT, Experiment, LONGEST_FILE, Layers, resolve};
use hwasp_settings::Folder;
use hwasp_settings::text::shorten;
use hwasp_training::{Assembly, Checkpoint, params_at};
use serde::Deserialize;
use serde::de::DeserializeOwned;

use super::Provenance;
use crate::checkpoint::experiment_hash;
use crate::error::{RunError, encode, io_error};
use crate::files::{Disk, read_limited};
use crate::layout::{LARGEST_SUMMARY, METRICS, POLICY, PROVENANCE, SUMMARY};
use crate::metrics::MetricsTable;
use crate::policy_file::{LARGEST_POLICY, read_policy};
use crate::store::{CheckpointStore, Found};
use crate::summary::{Summary, values_hash};

/// A run that was written before.
pub struct SavedRun {
    path: PathBuf,
    /// As it was trained.
    trained: Assembly,
    /// As it is judged.
    assembly: Assembly,
}

impl SavedRun {
    /// Opens a run folder and puts its experiment together again.
    pub fn open(path: &Path, catalogue: &Catalogue) -> Result<Self, RunError> {
        Self::open_with(path, &[], catalogue)
    }

    /// The same with values of the experiment set anew (`key=value`), to see what a result is worth in another world.
    ///
    /// # Errors
    /// [`RunError::OtherMachine`] where one of them changes design, law, ports or controller: what was trained is nothing there.
    pub fn open_with(path: &Path, assignments: &[String], catalogue: &Catalogue) -> Result<Self, RunError> {
        let assembly = |set: &[String]| -> Result<Assembly, RunError> {
            Ok(Assembly::new(&saved_experiment(path, set, catalogue)?)?)
        };
        let mut asked = assembly(assignments)?;
        let mut trained = asked.clone();
        if !assignments.is_empty() {
            trained = assembly(&[])?;
            if let Some(what) = trained.other_machine(&asked) {
                // The first of them after which it is another one; a part of them may be no experiment by itself.
                let other =
                    |i: &usize| assembly(&assignments[..=*i]).is_ok_and(|a| trained.other_machine(&a).is_some());
                let at = (0..assignments.len()).find(other).unwrap_or(assignments.len() - 1);
                let assignment = shorten(&assignments[at], 120);
                return Err(RunError::OtherMachine { path: path.to_owned(), assignment, what });
            }
            asked = trained.judged_in(&asked);
        }
        Ok(Self { path: path.to_owned(), trained, assembly: asked })
    }

    /// Its experiment, ready to run.
    pub fn assembly(&self) -> &Assembly {
        &self.assembly
    }

    /// The trained parameters; those of the newest checkpoint where the training did not come to its end.
    pub fn params(&self) -> Result<Vec<f32>, RunError> {
        let path = self.path.join(POLICY);
        if !path.is_file() {
            // What a checkpoint has is not what the summary is of.
            let finished = self.path.join(SUMMARY).is_file();
            if finished {
                return Err(RunError::Unfinished { path: self.path.clone(), file: POLICY });
            }
            return self.params_so_far();
        }
        let bytes = read_limited(&path, LARGEST_POLICY)?;
        read_policy(&self.trained.policy, &bytes).map_err(|source| RunError::Policy { path, source })
    }

    fn params_so_far(&self) -> Result<Vec<f32>, RunError> {
        let found = self.found()?;
        found.warn();
        let unfinished = || RunError::Unfinished { path: self.path.clone(), file: POLICY };
        let checkpoint = found.checkpoint.ok_or_else(unfinished)?;
        let steps = checkpoint.env_steps;
        tracing::warn!("{} did not come to its end: this is what it was after {steps} steps", self.path.display());
        self.params_at(&checkpoint)
    }

    /// The newest checkpoint of a training that did not come to its end yet.
    pub fn found(&self) -> Result<Found, RunError> {
        let experiment = self.trained.experiment().to_toml().map_err(|e| encode(EXPERIMENT, &e))?;
        CheckpointStore::new(&self.path, Arc::new(Disk), experiment_hash(&experiment)).newest()
    }

    /// The parameters that it had come to.
    pub fn params_at(&self, checkpoint: &Checkpoint) -> Result<Vec<f32>, RunError> {
        params_at(&self.trained, checkpoint)
            .map_err(|source| RunError::State { path: self.path.clone(), source: Box::new(source) })
    }

    /// Its figures.
    pub fn summary(&self) -> Result<Summary, RunError> {
        saved_summary(&self.path)
    }

    /// Its learning curve as a table.
    pub fn metrics(&self) -> Result<MetricsTable, RunError> {
        saved_metrics(&self.path)
    }
}

/// The experiment of a run folder, with values of it set anew (`key=value`).
pub fn saved_experiment(path: &Path, assignments: &[String], catalogue: &Catalogue) -> Result<Experiment, RunError> {
    let file = path.join(EXPERIMENT);
    if !file.is_file() {
        return Err(RunError::NotARun { path: path.to_owned(), file: EXPERIMENT });
    }
    let text = read_limited(&file, LONGEST_FILE as u64)?;
    let text = String::from_utf8_lossy(&text);
    let layers = Layers::from_text(&file.to_string_lossy(), &text)?.with_folder(Folder::Disk(path.to_owned()));
    let layers = assignments.iter().fold(layers, |layers, set| layers.with_assignment(set));
    let experiment = resolve(layers, None, catalogue)?;
    check_unchanged(path, &text)?;
    Ok(experiment)
}

/// Refuses the experiment of a finished run that is not the one it was trained with. A summary that cannot be read is the
/// business of those who need it.
fn check_unchanged(run: &Path, experiment: &str) -> Result<(), RunError> {
    let Ok(Some(Trained { experiment_sha256: Some(trained) })) = saved_json(&run.join(SUMMARY)) else { return Ok(()) };
    if values_hash(experiment).is_some_and(|found| found == trained) {
        return Ok(());
    }
    Err(RunError::Edited { path: run.join(EXPERIMENT) })
}

/// What a summary says of the experiment.
#[derive(Deserialize)]
struct Trained {
    experiment_sha256: Option<String>,
}

/// The figures of a run folder.
pub fn saved_summary(run: &Path) -> Result<Summary, RunError> {
    let summary = saved_json(&run.join(SUMMARY))?;
    summary.ok_or_else(|| RunError::Unfinished { path: run.to_owned(), file: SUMMARY })
}

/// The learning curve of a run folder.
pub fn saved_metrics(run: &Path) -> Result<MetricsTable, RunError> {
    let path = run.join(METRICS);
    // A pipe would be waited for.
    if path.exists() && !path.is_file() {
        return Err(io_error("read", &path, io::Error::other("it is no file")));
    }
    let file = File::open(&path).map_err(|source| io_error("read", &path, source))?;
    MetricsTable::read(BufReader::new(file)).map_err(|source| RunError::Metrics { path, source })
}

/// Where a run came from, if its folder says so.
pub fn saved_provenance(run: &Path) -> Result<Option<Provenance>, RunError> {
    saved_json(&run.join(PROVENANCE))
}

/// What a file holds as JSON; none where there is no such file.
pub fn saved_json<T: DeserializeOwned>(path: &Path) -> Result<Option<T>, RunError> {
    if !path.is_file() {
        return Ok(None);
    }
    let bytes = read_limited(path, LARGEST_SUMMARY)?;
    let decode = |e: serde_json::Error| RunError::Decode { path: path.to_owned(), message: e.to_string() };
    serde_json::from_slice(&bytes).map(Some).map_err(decode)
}
