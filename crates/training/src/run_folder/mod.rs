//! Run folders: everything about one training, in files that explain themselves.

mod lock;
mod provenance;
mod saved;
mod table;
mod writer;

use std::fs::File;
use std::io::{self, Read};
use std::path::{Path, PathBuf};

use serde::Serialize;
use thiserror::Error;

pub use self::provenance::Provenance;
pub use self::saved::SavedRun;
pub(crate) use self::saved::{saved_json, saved_metrics, saved_provenance, saved_spec, saved_summary};
pub(crate) use self::writer::told;
pub use self::writer::{Keeping, Resumed, RunFolder};
use crate::assemble::AssembleError;
use crate::checkpoint::CheckpointError;
use crate::metrics::MetricsError;
use crate::plot::PlotError;
use crate::policy_file::PolicyFileError;
use crate::spec::SpecErrors;
use crate::train::TrainError;

/// Why a run folder cannot be written or read.
#[derive(Debug, Error)]
pub enum RunError {
    /// Something is there already.
    #[error("{path} exists already and is not overwritten; name another folder with --out, or remove it first")]
    Exists {
        /// The folder.
        path: PathBuf,
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
    Spec(#[from] SpecErrors),
    /// The experiment in it, put together.
    #[error(transparent)]
    Assemble(#[from] AssembleError),
    /// The learning curve.
    #[error("{path}: {source}")]
    Metrics {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        source: MetricsError,
    },
    /// The picture.
    #[error(transparent)]
    Plot(#[from] PlotError),
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

pub(crate) const EXPERIMENT: &str = "experiment.toml";
const PROVENANCE: &str = "provenance.json";
const METRICS: &str = "metrics.csv";
pub(crate) const DESIGN: &str = "design.toml";
const POLICY: &str = "policy.safetensors";
/// Checkpoints of a training that is under way, or was.
pub(crate) const CHECKPOINTS: &str = "checkpoints";
/// What it takes to see iterations fail again.
pub(crate) const FAULTS: &str = "faults";
/// Written last: a folder that has it is finished.
pub(crate) const SUMMARY: &str = "summary.json";
const CURVES: &str = "curves.svg";

/// The largest summary that is read, bytes: ten thousand parameters take less than one.
pub(crate) const LARGEST_SUMMARY: u64 = 16 << 20;

/// The first few of some files and what is wrong with them, line by line.
fn listed(damaged: &[(PathBuf, CheckpointError)]) -> String {
    damaged.iter().take(5).fold(String::new(), |text, (path, error)| {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        format!("{text}\n  {name}: {error}")
    })
}

pub(crate) fn io_error(action: &'static str, path: &Path, source: io::Error) -> RunError {
    RunError::Io { action, path: path.to_owned(), source }
}

pub(crate) fn encode(file: &'static str, error: &dyn std::fmt::Display) -> RunError {
    RunError::Encode { file, message: error.to_string() }
}

/// A value as the text of a JSON file.
pub(crate) fn json(file: &'static str, value: &impl Serialize) -> Result<Vec<u8>, RunError> {
    let mut text = serde_json::to_vec_pretty(value).map_err(|e| encode(file, &e))?;
    text.push(b'\n');
    Ok(text)
}

/// Reads a file that a stranger may have sent.
pub(crate) fn read_limited(path: &Path, limit: u64) -> Result<Vec<u8>, RunError> {
    let error = |source| io_error("read", path, source);
    let file = File::open(path).map_err(error)?;
    let mut bytes = Vec::new();
    file.take(limit + 1).read_to_end(&mut bytes).map_err(error)?;
    if bytes.len() as u64 > limit {
        let source = io::Error::new(io::ErrorKind::FileTooLarge, format!("it is larger than {limit} bytes"));
        return Err(error(source));
    }
    Ok(bytes)
}
