//! All that a training needs to go on to the bits of one that was never interrupted.

use hwasp_algos::Archive;
use serde::{Deserialize, Serialize};

/// Where a training stands.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Checkpoint {
    /// Iterations done.
    pub iteration: u64,
    /// Real simulator steps so far.
    pub env_steps: u64,
    /// The mean undiscounted return of the last iterations, if there were any.
    pub training_return: Option<f64>,
    /// The state of everything that learns, and the counters of the loop.
    pub archive: Archive,
}
