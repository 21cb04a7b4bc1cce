//! Why there is no export.

use std::path::PathBuf;

use hwasp_core::RolloutError;
use hwasp_fabrication::PartError;
use hwasp_problem::AnyError;
use hwasp_runs::RunError;
use hwasp_training::AssembleError;
use hwasp_workshop::parts::ChosenPartsError;
use thiserror::Error;

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
    /// A form of the mechanism that runs of the problem do not have.
    #[error("runs of {problem} are not written as {kind}: they are as {}", .kinds.join(", "))]
    NoMechanism {
        /// The form.
        kind: &'static str,
        /// The problem.
        problem: String,
        /// Those that there are.
        kinds: Vec<&'static str>,
    },
    /// A mechanism that cannot have the design.
    #[error(transparent)]
    Mechanism(AnyError),
    /// A hand that cannot be printed.
    #[error(transparent)]
    Hand(#[from] PartError),
    /// A hand whose parts are not known.
    #[error(transparent)]
    Parts(#[from] ChosenPartsError),
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
