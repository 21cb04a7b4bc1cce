//! What a training loop knows of a learner.

use hwasp_core::{Batch, Executor};
use thiserror::Error;

use crate::archive::Persist;
use crate::metrics::Metrics;

/// Why an update was not applied.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum LearnError {
    /// A number that is none.
    #[error("{what} is not finite in iteration {iteration}; the parameters before it were kept")]
    NotFinite {
        /// The loss, gradient, parameters …
        what: &'static str,
        /// The iteration.
        iteration: u64,
    },
}

/// Turns batches into better parameters.
pub trait Learner: Persist + Send {
    /// The policy's parameters.
    fn params(&self) -> &[f32];

    /// The names of what an update tells, always the same.
    fn metric_names(&self) -> &'static [&'static str];

    /// Learns from a batch that the present parameters gave, or earlier ones where it
    /// [keeps experience](crate::LearnerKind::keeps_experience). `progress` in [0, 1] drives schedules; `iteration` names the
    /// random stream. `executor` runs passes over blocks of rows, where a learner has use for it; its number of threads
    /// changes no bit. Returns what the update did, under the [names](Self::metric_names). After an error the learner is as
    /// it was before the update.
    fn update(
        &mut self,
        executor: &dyn Executor,
        batch: &Batch,
        progress: f64,
        iteration: u64,
    ) -> Result<Metrics, LearnError>;
}
