//! What a training loop knows of a learner.

use hwasp_core::{Batch, Executor};
use thiserror::Error;

use crate::archive::Persist;

/// What an update did.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct UpdateMetrics {
    /// KL divergence from the policy that acted, nats. PPO: an estimate, the mean over the rows of the last epoch, each
    /// taken before its gradient step. TRPO: exact, over all rows, after the update.
    pub kl: f64,
    /// Entropy of the action distribution after the update, nats.
    pub entropy: f64,
    /// The share of rows in the last epoch whose ratio was clipped.
    pub clip_fraction: f64,
    /// Mean norm of the policy gradient before clipping.
    pub grad_norm: f64,
    /// Epochs done; fewer than asked for where the KL limit stopped them.
    pub epochs: usize,
    /// What TRPO did; none of other learners.
    pub trust_region: Option<TrustRegionMetrics>,
}

/// How a step within a trust region came about.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TrustRegionMetrics {
    /// The share of the full step that was taken; 0 where none was.
    pub step_fraction: f64,
    /// What the step gained in the surrogate objective, mean of ρ·A.
    pub gain: f64,
    /// Iterations of conjugate gradients.
    pub cg_iterations: usize,
    /// Steps that the line search tried.
    pub tried: usize,
    /// Updates so far that took no step.
    pub rejected: u64,
}

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
pub trait Learner: Persist {
    /// The policy's parameters.
    fn params(&self) -> &[f32];

    /// Learns from a batch that the present parameters gave. `progress` in [0, 1] drives schedules; `iteration` names the
    /// random stream. `executor` runs passes over blocks of rows, where a learner has use for it; its number of threads
    /// changes no bit. After an error the learner is as it was before the update.
    fn update(
        &mut self,
        executor: &dyn Executor,
        batch: &Batch,
        progress: f64,
        iteration: u64,
    ) -> Result<UpdateMetrics, LearnError>;
}
