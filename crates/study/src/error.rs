//! Why a comparison cannot be made.

use std::path::PathBuf;

use hwasp_experiment::Faults;
use hwasp_plot::PlotError;
use hwasp_runs::RunError;
use hwasp_training::AssembleError;
use hwasp_training::stats::StatsError;
use thiserror::Error;

/// Why a comparison cannot be made.
#[derive(Debug, Error)]
pub enum CompareError {
    /// The experiment, for one of the methods.
    #[error(transparent)]
    Experiment(#[from] Faults),
    /// The experiment, put together for one of the methods.
    #[error("{label}: {source}")]
    Assemble {
        /// The contender.
        label: String,
        /// What is wrong.
        source: AssembleError,
    },
    /// A contender that is none.
    #[error("`{text}` is no contender: {hint}")]
    Contender {
        /// What was written.
        text: String,
        /// What is possible.
        hint: String,
    },
    /// A contender named twice.
    #[error("`{0}` is named twice; name it once, and say with --seeds how often it is to be trained")]
    Twice(String),
    /// Two contenders that would train the same.
    #[error("`{one}` and `{other}` are the same experiment, every setting resolved; name one of them")]
    Same {
        /// The one.
        one: String,
        /// The other.
        other: String,
    },
    /// A cell that holds a run of another experiment.
    #[error("{path} holds another experiment, or one with other settings; name another folder with --out")]
    Other {
        /// The cell.
        path: PathBuf,
    },
    /// A place where there is something else.
    #[error("{path} is no folder of a comparison, and what is in it is not overwritten; name another one with --out")]
    Taken {
        /// The place.
        path: PathBuf,
    },
    /// A folder or file.
    #[error(transparent)]
    Run(#[from] RunError),
    /// A figure over the seeds.
    #[error(transparent)]
    Stats(#[from] StatsError),
    /// A picture.
    #[error(transparent)]
    Plot(#[from] PlotError),
}
