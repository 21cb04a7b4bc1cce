//! From a run to a robot on the bench: what a run comes to, in files that other programs read.
//!
//! A [`Kind`] is what can be asked for; it gives named files, and [`export`] alone writes them. A new kind is a variant of
//! [`Kind`] with a function from [`Source`] to files.

mod contract;
mod controller;
mod deployed;
mod folder;
mod meaning;
mod model;
mod onnx;
mod samples;

use std::cell::OnceCell;
use std::path::{Path, PathBuf};

use hwasp_core::RolloutError;
use thiserror::Error;

use self::deployed::Deployed;
use crate::assemble::AssembleError;
use crate::run_folder::{RunError, SavedRun, saved_spec};
use crate::spec::Spec;

/// The most random observations that are written: files of some hundred MB.
pub const MOST_SAMPLES: u64 = 1_000_000;

/// What can be exported.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// The controller, and the controller with the hardware's law, as ONNX models.
    Onnx,
    /// The controller's numbers as safetensors.
    Safetensors,
    /// The controller's numbers as JSON.
    Json,
}

impl Kind {
    /// All of them: what is exported if nothing is asked for.
    pub const ALL: [Self; 3] = [Self::Onnx, Self::Safetensors, Self::Json];

    /// The files of this kind. Every form of the controller has the contract beside it.
    fn files(self, source: &Source) -> Result<Vec<ExportFile>, ExportError> {
        let deployed = source.deployed()?;
        let contract = contract::Contract::new(deployed);
        let mut files = match self {
            Self::Onnx => onnx::models(deployed, &contract)?,
            Self::Safetensors => vec![controller::safetensors(deployed, &contract)?],
            Self::Json => vec![controller::json(deployed, &contract)?],
        };
        files.push(contract.file()?);
        Ok(files)
    }
}

/// A file to be written.
#[derive(Clone, Debug, PartialEq)]
pub struct ExportFile {
    /// Its place in the folder of the export.
    pub name: String,
    /// What is in it.
    pub contents: Vec<u8>,
}

/// Why there is no export.
#[derive(Debug, Error)]
pub enum ExportError {
    /// The run folder.
    #[error(transparent)]
    Run(#[from] RunError),
    /// A file of the export that cannot be written.
    #[error(transparent)]
    Write(RunError),
    /// The trained controller does not fit the hardware as built.
    #[error(transparent)]
    Assemble(#[from] AssembleError),
    /// No episode from which states could be taken for samples.
    #[error(transparent)]
    Rollout(#[from] RolloutError),
    /// Something else is where a file should go.
    #[error("{path} exists already, no export wrote it, and it is not overwritten; name another folder with --out")]
    Foreign {
        /// The file.
        path: PathBuf,
    },
    /// The folder belongs to another run.
    #[error("{path} has the export of {there}, and this would be {this}; name another folder with --out")]
    OtherRun {
        /// The folder.
        path: PathBuf,
        /// The run whose export is there: experiment, method and seed.
        there: String,
        /// The run asked for.
        this: String,
    },
}

/// A run to export from. What a kind does not need is not read: the experiment is there at once, the trained policy when it
/// is asked for.
pub struct Source {
    path: PathBuf,
    spec: Spec,
    deployed: OnceCell<Deployed>,
}

impl Source {
    /// Opens a run folder.
    pub fn open(path: &Path) -> Result<Self, RunError> {
        Ok(Self { path: path.to_owned(), spec: saved_spec(path, &[])?, deployed: OnceCell::new() })
    }

    /// Its experiment.
    pub fn spec(&self) -> &Spec {
        &self.spec
    }

    /// The trained controller on the hardware as built.
    fn deployed(&self) -> Result<&Deployed, ExportError> {
        if let Some(deployed) = self.deployed.get() {
            return Ok(deployed);
        }
        let saved = SavedRun::open(&self.path)?;
        let params = saved.params()?;
        let deployed = Deployed::new(saved.assembly(), &params)?;
        Ok(self.deployed.get_or_init(|| deployed))
    }
}

/// Makes the files of some kinds, and of `samples` random observations if they are asked for, and writes them into `out`,
/// which is created where it is missing. Files of an earlier export of the same run are replaced; nothing else is.
/// Returns what was written.
pub fn export(
    source: &Source,
    kinds: &[Kind],
    samples: Option<u64>,
    out: &Path,
) -> Result<Vec<ExportFile>, ExportError> {
    let mut files: Vec<ExportFile> = Vec::new();
    for kind in kinds {
        for file in kind.files(source)? {
            if files.iter().all(|other| other.name != file.name) {
                files.push(file);
            }
        }
    }
    if let Some(count) = samples {
        files.push(samples::samples(source.deployed()?, count as usize)?);
    }
    folder::write(out, &source.spec, &files)?;
    Ok(files)
}
