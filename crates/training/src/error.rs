//! Why a training ends early.

use hwasp_algos::{LearnError, SearchError, StateError};
use hwasp_core::RolloutError;
use thiserror::Error;

use crate::assemble::AssembleError;
use crate::collect::CollectError;
use crate::evaluation::EvaluateError;
use crate::observer::ObserverError;

/// Why a training ended early.
#[derive(Debug, Error)]
pub enum TrainError {
    /// An episode failed.
    #[error(transparent)]
    Rollout(#[from] RolloutError),
    /// An update failed.
    #[error(transparent)]
    Learn(#[from] LearnError),
    /// An update failed after rewards that single precision, in which learners compute, does not hold for long.
    #[error(
        "the reward is too large to learn from: up to {largest:.1e} in a step of iteration {iteration}{}; divide it, so that a step \
         is worth about 1, or set train.reward_scaling = true ({source})",
        .term.as_ref().map_or_else(String::new, |term| format!(", most of it from the term `{term}`"))
    )]
    Reward {
        /// The largest reward of a step that the learner saw, without its sign.
        largest: f64,
        /// The iteration.
        iteration: u64,
        /// The term that has the most of it, where the reward has names for several.
        term: Option<String>,
        /// What the learner found.
        source: LearnError,
    },
    /// The physics of most episodes failed, again and again: what is learned from the rest is worth nothing.
    #[error(
        "the physics of most episodes failed in {iterations} iterations in a row ({failed} of {asked} in the last); {first}"
    )]
    Physics {
        /// How many iterations.
        iterations: u64,
        /// Episodes that failed in the last of them.
        failed: usize,
        /// Episodes asked for in each.
        asked: usize,
        /// The first of those that failed.
        first: RolloutError,
    },
    /// Every candidate of a generation failed.
    #[error("all {candidates} candidates of generation {generation} failed, {alike} of them as the first: {first}")]
    AllFailed {
        /// Candidates.
        candidates: usize,
        /// The generation.
        generation: u64,
        /// How many failed of the same cause as the first.
        alike: usize,
        /// How the first failed: episode, step and cause.
        first: String,
    },
    /// Whoever was asked for episodes has not answered.
    #[error(transparent)]
    Collect(CollectError),
    /// It failed where it was asked for, in these words, and would again.
    #[error("{0}")]
    Elsewhere(String),
    /// Someone asked it to stop. Its observer has a checkpoint of all that was done.
    #[error("stopped after {env_steps} of {budget} steps")]
    Interrupted {
        /// Real simulator steps taken.
        env_steps: u64,
        /// Those of the whole training.
        budget: u64,
    },
    /// The state of what learns cannot be saved, or a saved one is not of this experiment.
    #[error(transparent)]
    State(#[from] StateError),
    /// A search could not go on.
    #[error(transparent)]
    Search(#[from] SearchError),
    /// A candidate's own training cannot be put together.
    #[error(transparent)]
    Assemble(#[from] AssembleError),
    /// The evaluation failed.
    #[error(transparent)]
    Evaluate(#[from] EvaluateError),
    /// Someone who watched could not go on, the run folder for one.
    #[error(transparent)]
    Observer(#[from] ObserverError),
}

impl From<CollectError> for TrainError {
    fn from(error: CollectError) -> Self {
        match error {
            CollectError::Rollout(error) => Self::Rollout(error),
            CollectError::Setup(text) => Self::Assemble(AssembleError::Elsewhere(text)),
            CollectError::Unanswered(_) | CollectError::Interrupted => Self::Collect(error),
        }
    }
}
