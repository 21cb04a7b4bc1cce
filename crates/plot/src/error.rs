//! Why a picture cannot be drawn or written.

use std::path::PathBuf;

use hwasp_training::stats::StatsError;
use thiserror::Error;

/// The most panels in a picture; further columns are left out, with a [`Note`](crate::Note).
pub const MOST_PANELS: usize = 24;
/// The most runs in a picture.
pub const MOST_RUNS: usize = 1000;
/// The longest trailing mean, in rows.
pub const LONGEST_WINDOW: usize = 1001;

/// Why a picture cannot be drawn or written.
#[derive(Debug, Error)]
pub enum PlotError {
    /// Nothing was given to draw.
    #[error("a plot needs at least one run, and there is none")]
    NoRuns,
    /// More runs than a picture can show.
    #[error("{0} runs are more than {MOST_RUNS} in one plot; plot fewer at a time")]
    Runs(usize),
    /// A trailing mean over too few or too many rows.
    #[error("a trailing mean over {0} rows is outside [1, {LONGEST_WINDOW}]; 11 is usual")]
    Window(usize),
    /// A column with another number of values than there are steps.
    #[error("`{label}` has {steps} rows of steps or times but {values} of {series}")]
    Lengths {
        /// The run's label.
        label: String,
        /// The column.
        series: String,
        /// Rows of steps.
        steps: usize,
        /// Rows of the column.
        values: usize,
    },
    /// A figure over the runs cannot be computed.
    #[error(transparent)]
    Stats(#[from] StatsError),
    /// A file name that names no format.
    #[error("`{}` ends neither in .svg nor in .png, so it names no format to write a plot in", path.display())]
    Extension {
        /// The file.
        path: PathBuf,
    },
    /// The SVG cannot be turned into pixels.
    #[error("the plot cannot be drawn as PNG: {0}")]
    Render(String),
    /// The file cannot be written.
    #[error("`{}` cannot be written: {source}", path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
}
