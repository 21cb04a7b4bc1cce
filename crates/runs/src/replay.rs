//! One iteration of a run once more, from the checkpoint before it.

use std::path::{Path, PathBuf};

use hwasp_algos::Metrics;
use hwasp_core::Executor;
use hwasp_experiment::{Catalogue, EXPERIMENT};
use hwasp_training::{Checkpoint, TrainError, repeat, stage_at};
use thiserror::Error;

use crate::checkpoint::{Header, LARGEST_CHECKPOINT, decode, experiment_hash, has_batch, has_this_batch};
use crate::error::{RunError, encode};
use crate::files::read_limited;
use crate::run_folder::SavedRun;

/// Why an iteration cannot be repeated.
#[derive(Debug, Error)]
pub enum ReplayError {
    /// Not a file of a run folder.
    #[error(
        "{path} is no checkpoint of a run folder: name a file of its `faults` or `checkpoints`, such as \
         RUN/faults/iteration-00000012.safetensors"
    )]
    Place {
        /// The file.
        path: PathBuf,
    },
    /// A method that has generations.
    #[error("{path} is of a search: resume the run to see its generation again")]
    Search {
        /// The file.
        path: PathBuf,
    },
    /// The end of a training, or of its main stage.
    #[error(
        "{path} is of the end of its training, or of the stage before its polish: no iteration follows; name an earlier checkpoint of the run, or one of `faults`"
    )]
    End {
        /// The file.
        path: PathBuf,
    },
    /// The run folder or the file.
    #[error(transparent)]
    Run(#[from] RunError),
}

/// An iteration, repeated.
#[derive(Debug)]
pub struct Replay {
    /// Its number, from 0.
    pub iteration: u64,
    /// Real simulator steps before it.
    pub env_steps: u64,
    /// What failed then, if something did.
    pub fault: Option<String>,
    /// Whether the episodes have the bits of those that were written down, where they were.
    pub same_batch: Option<bool>,
    /// What happens now.
    pub outcome: Result<Metrics, TrainError>,
}

/// Repeats the iteration that follows a checkpoint: a file of a run folder's `faults`, or of its `checkpoints`.
pub fn replay(path: &Path, catalogue: &Catalogue, executor: &dyn Executor) -> Result<Replay, ReplayError> {
    let file = path.canonicalize().ok().filter(|file| file.is_file());
    let run = file.and_then(|file| Some(file.parent()?.parent()?.to_owned()));
    let run = run.ok_or_else(|| ReplayError::Place { path: path.to_owned() })?;
    let saved = SavedRun::open(&run, catalogue).map_err(|error| match error {
        RunError::NotARun { .. } => ReplayError::Place { path: path.to_owned() },
        other => other.into(),
    })?;
    let assembly = saved.assembly();
    let bytes = read_limited(path, LARGEST_CHECKPOINT)?;
    let checkpoint_error = |source| RunError::Checkpoint { path: path.to_owned(), source };
    let experiment = assembly.experiment().to_toml().map_err(|e| encode(EXPERIMENT, &e))?;
    let checkpoint = decode(&bytes, &experiment_hash(&experiment)).map_err(checkpoint_error)?;
    let fault = Header::read(&bytes).map_err(checkpoint_error)?.fault;
    let state_error = |source: TrainError| RunError::State { path: path.to_owned(), source: Box::new(source) };
    let stage = stage_at(assembly, &checkpoint).map_err(state_error)?;
    if stage.experiment().method.searches() {
        return Err(ReplayError::Search { path: path.to_owned() });
    }
    if !stage.iterates(checkpoint.env_steps) {
        return Err(ReplayError::End { path: path.to_owned() });
    }
    let archive = &checkpoint.archive;
    let (batch, outcome) = repeat(&stage, archive, executor).map_err(state_error)?;
    let same_batch = batch.filter(|_| has_batch(archive)).map(|batch| has_this_batch(archive, &batch));
    let Checkpoint { iteration, env_steps, .. } = checkpoint;
    Ok(Replay { iteration, env_steps, fault, same_batch, outcome })
}
