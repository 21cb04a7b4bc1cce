//! Rollouts: whole episodes by index, in lock step, over any number of threads with the same bits.

mod batch;
mod lanes;
mod sampler;

use std::ops::Range;
use std::sync::Arc;

use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::environment::{End, Outcome, shared_text};

pub use batch::{Batch, Episode};
pub use sampler::{Sampler, all_failed};

/// Why an episode is worth nothing.
#[derive(Clone, Debug, Error, PartialEq, Eq, Serialize, Deserialize)]
#[error("episode {episode} of iteration {iteration} (seed {seed}) failed at step {step}: {what}")]
pub struct RolloutError {
    /// The run's root seed.
    pub seed: u64,
    /// The iteration.
    pub iteration: u64,
    /// The episode's index in it.
    pub episode: u64,
    /// The step.
    pub step: usize,
    /// What went wrong.
    pub what: String,
}

impl RolloutError {
    /// Real simulator steps that the episode took, the one in which it failed included.
    pub fn env_steps(&self) -> u64 {
        self.step as u64 + 1
    }
}

/// What is left of an episode whose rows nobody needs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct EpisodeResult {
    /// Σ discount^t·reward.
    #[serde(with = "crate::bits")]
    pub discounted_return: f64,
    /// Σ reward.
    #[serde(with = "crate::bits")]
    pub undiscounted_return: f64,
    /// Its steps.
    pub steps: usize,
    /// How it ended.
    pub end: End,
    /// The name of what ended it, where it [terminated](End::Terminated) and the task has one.
    #[serde(default, with = "shared_text::option")]
    pub ended_by: Option<Arc<str>>,
    /// Whether it succeeded, for tasks that know.
    pub outcome: Option<Outcome>,
    /// What each named term of the reward came to, where it has some.
    #[serde(default, with = "crate::bits")]
    pub terms: Vec<f64>,
}

/// Which episodes to run, and how.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Episodes {
    /// The root seed.
    pub seed: u64,
    /// Part of the streams' names; evaluation uses 0.
    pub iteration: u64,
    /// Indices of the episodes.
    pub indices: Range<u64>,
    /// Fraction of training done, for schedules of noise and task.
    #[serde(with = "crate::bits")]
    pub progress: f64,
    /// Training episodes explore; evaluation episodes start from held-out seeds.
    pub kind: EpisodeKind,
}

/// Steps that are shared evenly by lanes. A lane runs one episode after the other until its share is used up, and the last of
/// them is [cut](Episode::cut) there: that makes as many rows as are asked for, and no step is taken in vain.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct LaneSteps {
    /// All lanes there are, at least one.
    pub lanes: u64,
    /// Steps of all lanes together.
    pub steps: u64,
}

impl LaneSteps {
    /// The steps of a lane: where they do not divide evenly, the first lanes take one more.
    pub fn share(&self, lane: u64) -> usize {
        (self.steps / self.lanes + u64::from(lane < self.steps % self.lanes)) as usize
    }

    /// The index that names the streams of an episode, which follows `before` others in its lane: another one for each of an
    /// iteration. The first of a lane has the streams that it would have if episodes were counted.
    fn episode(&self, lane: u64, before: u64) -> u64 {
        lane + before * self.lanes
    }
}

/// What episodes are for: chooses the streams, and whether there is noise.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum EpisodeKind {
    /// With action noise.
    Training,
    /// The starts of training, the deterministic policy: for searches, whose noise is in the parameters.
    Deterministic,
    /// Held-out starts, the deterministic policy.
    Evaluation,
    /// Held-out starts, with action noise.
    NoisyEvaluation,
}

/// Σ discount^t·reward, summed from the end.
fn discounted(rewards: &[f64], discount: f64) -> f64 {
    rewards.iter().rev().fold(0.0, |sum, reward| reward + discount * sum)
}
