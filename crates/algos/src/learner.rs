//! What a training loop knows of a learner.

use hwasp_core::Batch;
use thiserror::Error;

/// What an update did.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct UpdateMetrics {
    /// KL divergence from the policy that acted, nats: the mean over the rows of the last epoch, each taken before its
    /// gradient step.
    pub kl: f64,
    /// Entropy of the action distribution after the update, nats.
    pub entropy: f64,
    /// The share of rows in the last epoch whose ratio was clipped.
    pub clip_fraction: f64,
    /// Mean norm of the policy gradient before clipping.
    pub grad_norm: f64,
    /// Epochs done; fewer than asked for where the KL limit stopped them.
    pub epochs: usize,
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
pub trait Learner {
    /// The policy's parameters.
    fn params(&self) -> &[f32];

    /// Learns from a batch that the present parameters gave. `progress` in [0, 1] drives schedules; `iteration` names the
    /// random stream. After an error the parameters are those from before the update.
    fn update(&mut self, batch: &Batch, progress: f64, iteration: u64) -> Result<UpdateMetrics, LearnError>;
}
