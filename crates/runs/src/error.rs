//! Why a run folder cannot be written or read.

use std::io;
use std::path::{Path, PathBuf};

use hwasp_experiment::{EXPERIMENT, Faults};
use hwasp_training::{AssembleError, TrainError};
use thiserror::Error;

use crate::checkpoint::CheckpointError;
use crate::metrics::MetricsError;
use crate::policy_file::PolicyFileError;

/// Why a run folder cannot be written or read.
#[derive(Debug, Error)]
pub enum RunError {
    /// Something is there already.
    #[error("{path} exists already and is not overwritten; name another folder with --out, or remove it first")]
    Exists {
        /// The folder.
        path: PathBuf,
    },
    /// A file that the experiment names would lie where a run has one of its own.
    #[error(
        "the experiment names the file {file}, and a run folder, which keeps such files, has something of its own there; give the \
         file or its folder another name"
    )]
    Taken {
        /// Its path from the experiment's folder.
        file: String,
    },
    /// It is not a run folder.
    #[error("{path} is not a run folder: it has no {file}")]
    NotARun {
        /// The folder.
        path: PathBuf,
        /// What it lacks.
        file: &'static str,
    },
    /// It is neither a run folder nor a comparison.
    #[error("{path} is neither a run nor a comparison: it has neither {EXPERIMENT} nor comparison.json")]
    Nothing {
        /// The folder.
        path: PathBuf,
    },
    /// A run that has not come to its end.
    #[error("{path} has no {file}: the training did not finish, or the file was removed")]
    Unfinished {
        /// The folder.
        path: PathBuf,
        /// What it lacks.
        file: &'static str,
    },
    /// An experiment that was changed after the training.
    #[error(
        "{path} was changed after the training: policy and figures beside it belong to another experiment; put back what it \
         said, or train the changed one into a folder of its own"
    )]
    Edited {
        /// The file.
        path: PathBuf,
    },
    /// Another program writes to it.
    #[error(
        "{path} is in use by process {owner}, which trains into it; wait for it or stop it, or train into another folder"
    )]
    InUse {
        /// The folder.
        path: PathBuf,
        /// The process that holds it, as it says of itself.
        owner: String,
    },
    /// A run that has nothing left to do.
    #[error("{path} has come to its end: there is nothing to resume")]
    Finished {
        /// The folder.
        path: PathBuf,
    },
    /// A checkpoint.
    #[error("{path}: {source}")]
    Checkpoint {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        source: CheckpointError,
    },
    /// Checkpoints none of which can be used.
    #[error("no checkpoint in {folder} is sound:{}", listed(damaged))]
    Unsound {
        /// The folder of the checkpoints.
        folder: PathBuf,
        /// What is wrong with each, the newest first.
        damaged: Vec<(PathBuf, CheckpointError)>,
    },
    /// A state in a checkpoint that does not belong to its experiment.
    #[error("{path}: {source}")]
    State {
        /// The run folder, or the checkpoint.
        path: PathBuf,
        /// What is wrong.
        source: Box<TrainError>,
    },
    /// The file system.
    #[error("cannot {action} {path}: {source}")]
    Io {
        /// read, write …
        action: &'static str,
        /// The file or folder.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// The experiment in it.
    #[error(transparent)]
    Experiment(#[from] Faults),
    /// The experiment in it, put together.
    #[error(transparent)]
    Assemble(#[from] AssembleError),
    /// Another machine than the one that was trained.
    #[error("--set {assignment} changes {what}: {path} was trained for another machine")]
    OtherMachine {
        /// The run folder.
        path: PathBuf,
        /// What was set.
        assignment: String,
        /// What of the machine is another one for it.
        what: &'static str,
    },
    /// The learning curve.
    #[error("{path}: {source}")]
    Metrics {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        source: MetricsError,
    },
    /// What else was to be put into a finished run, a picture for one.
    #[error(transparent)]
    Extra(Box<dyn std::error::Error + Send + Sync>),
    /// The parameters.
    #[error("{path}: {source}")]
    Policy {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        source: PolicyFileError,
    },
    /// A file that does not hold what it should.
    #[error("{path}: {message}")]
    Decode {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        message: String,
    },
    /// A value that cannot be written as TOML or JSON.
    #[error("cannot write {file}: {message}")]
    Encode {
        /// The file.
        file: &'static str,
        /// What is wrong.
        message: String,
    },
}

/// The first few of some files and what is wrong with them, line by line.
fn listed(damaged: &[(PathBuf, CheckpointError)]) -> String {
    damaged.iter().take(5).fold(String::new(), |text, (path, error)| {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        format!("{text}\n  {name}: {error}")
    })
}

/// What the system says of a file or a folder.
pub fn io_error(action: &'static str, path: &Path, source: io::Error) -> RunError {
    RunError::Io { action, path: path.to_owned(), source }
}

/// What cannot be written as TOML or JSON.
pub fn encode(file: &'static str, error: &dyn std::fmt::Display) -> RunError {
    RunError::Encode { file, message: error.to_string() }
}
