//! Why a list or a picture of the workshop cannot be written.

use hwasp_plot::PlotError;
use hwasp_runs::RunError;
use thiserror::Error;

/// Why a list or a picture of the workshop cannot be written.
#[derive(Debug, Error)]
pub enum WorkshopError {
    /// The folder, or a list in it.
    #[error(transparent)]
    Run(#[from] RunError),
    /// The picture.
    #[error(transparent)]
    Plot(#[from] PlotError),
}
