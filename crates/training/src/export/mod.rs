//! From a run to a robot on the bench: what a run comes to, in files that other programs read.
//!
//! A [`Kind`] is what can be asked for; it gives named files, and [`export`] alone writes them. A new kind is a variant of
//! [`Kind`] with a function from [`Source`] to files.

mod contract;
mod controller;
mod deployed;
mod folder;
mod meaning;
mod mechanism;
mod model;
mod onnx;
mod samples;

use std::cell::OnceCell;
use std::path::{Path, PathBuf};

use hwasp_core::RolloutError;
use hwasp_tasks::hand::HandError;
use thiserror::Error;

use self::contract::Contract;
use self::deployed::Deployed;
use self::mechanism::Mechanism;
use crate::assemble::AssembleError;
use crate::design::DesignReport;
use crate::run_folder::{DESIGN, RunError, SavedRun, saved_spec};
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
    /// The hand and its task as a `MuJoCo` model, with native tendons and springs.
    Mjcf,
    /// The hand's links and joints as URDF.
    Urdf,
    /// Its printed parts as STL.
    Stl,
    /// The same as an OpenSCAD file, with the parameters at its top.
    Scad,
}

impl Kind {
    /// All of them.
    pub const ALL: [Self; 7] =
        [Self::Onnx, Self::Safetensors, Self::Json, Self::Mjcf, Self::Urdf, Self::Stl, Self::Scad];

    /// Its name, as the command line has it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Onnx => "onnx",
            Self::Safetensors => "safetensors",
            Self::Json => "json",
            Self::Mjcf => "mjcf",
            Self::Urdf => "urdf",
            Self::Stl => "stl",
            Self::Scad => "scad",
        }
    }

    /// Whether a run of this experiment has it: only hands have a mechanism to be written.
    pub fn is_of(self, spec: &Spec) -> bool {
        let of_mechanism = matches!(self, Self::Mjcf | Self::Urdf | Self::Stl | Self::Scad);
        !of_mechanism || mechanism::hand(spec).is_some()
    }

    /// The files of this kind. Every form of the controller has the contract beside it.
    fn files(self, source: &Source) -> Result<Vec<ExportFile>, ExportError> {
        match self {
            Self::Onnx => source.with_contract(onnx::models),
            Self::Safetensors => {
                source.with_contract(|deployed, contract| Ok(vec![controller::safetensors(deployed, contract)?]))
            }
            Self::Json => source.with_contract(|deployed, contract| Ok(vec![controller::json(deployed, contract)?])),
            Self::Mjcf => Ok(source.mechanism(self)?.mjcf()?),
            Self::Urdf => Ok(source.mechanism(self)?.urdf()?),
            Self::Stl => Ok(source.mechanism(self)?.stl()?),
            Self::Scad => Ok(source.mechanism(self)?.scad()?),
        }
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
    /// A form of the mechanism of a run without one.
    #[error(
        "{problem} has no mechanism to write as {kind}: mjcf, urdf, stl and scad are for the hand, in z-grasp and 3d-grasp"
    )]
    NoMechanism {
        /// The form.
        kind: &'static str,
        /// The problem.
        problem: &'static str,
    },
    /// A hand that cannot be built.
    #[error(transparent)]
    Hand(#[from] HandError),
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

    /// Files of the controller, and its contract.
    fn with_contract(
        &self,
        make: impl FnOnce(&Deployed, &Contract) -> Result<Vec<ExportFile>, ExportError>,
    ) -> Result<Vec<ExportFile>, ExportError> {
        let deployed = self.deployed()?;
        let contract = Contract::new(deployed);
        let mut files = make(deployed, &contract)?;
        files.push(contract.file()?);
        Ok(files)
    }

    /// The mechanism, to be written as `kind`.
    fn mechanism(&self, kind: Kind) -> Result<Mechanism, ExportError> {
        let none = || ExportError::NoMechanism { kind: kind.name(), problem: self.spec.task.name() };
        let hand = mechanism::hand(&self.spec).ok_or_else(none)?;
        if !self.path.join(DESIGN).is_file() {
            // Of a training that did not come to its end.
            return Ok(Mechanism::new(hand, &self.deployed()?.design));
        }
        let design: Vec<f64> =
            DesignReport::open(&self.path)?.groups.into_iter().flat_map(|group| group.group.as_built).collect();
        Ok(Mechanism::new(hand, &design))
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
