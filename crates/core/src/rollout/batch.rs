//! Whole episodes with all of their rows.

use std::ops::Range;

use serde::{Deserialize, Serialize};

use super::{RolloutError, discounted};
use crate::environment::{End, Outcome};
use crate::moments::Moments;

/// One episode of a [`Batch`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Episode {
    /// Its rows in the batch.
    pub rows: Range<usize>,
    /// How it ended.
    pub end: End,
    /// Whether it was truncated because the steps of its lane were used up ([`LaneSteps`](super::LaneSteps)): the task would
    /// have gone on, so its return is that of a part.
    #[serde(default)]
    pub cut: bool,
    /// What the controller would have seen next: the state whose value a truncated episode is bootstrapped from.
    #[serde(with = "crate::bits")]
    pub last_obs: Vec<f32>,
    /// The law's state there, SI.
    #[serde(with = "crate::bits")]
    pub last_state: Vec<f32>,
    /// What the episode was about and no sensor told, SI.
    #[serde(with = "crate::bits")]
    pub context: Vec<f32>,
    /// The log-probability of what was drawn once for it; 0 where nothing was.
    #[serde(with = "crate::bits")]
    pub log_prob: f32,
    /// Whether it succeeded, for tasks that know.
    pub outcome: Option<Outcome>,
    /// What each named term of the reward came to, where it has some.
    #[serde(default, with = "crate::bits")]
    pub terms: Vec<f64>,
}

/// Whole episodes, one row per step, an episode's rows one after the other.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Batch {
    /// Controller inputs `[rows × obs_dim]`.
    #[serde(with = "crate::bits")]
    pub obs: Vec<f32>,
    /// The law's state `[rows × state_dim]`, SI.
    #[serde(with = "crate::bits")]
    pub state: Vec<f32>,
    /// Actions as sampled, not clipped `[rows × action_dim]`, SI.
    #[serde(with = "crate::bits")]
    pub action: Vec<f32>,
    /// Their log-probabilities, without what was drawn once an episode and is in the action of each of its rows.
    #[serde(with = "crate::bits")]
    pub log_prob: Vec<f32>,
    /// Rewards.
    #[serde(with = "crate::bits")]
    pub reward: Vec<f64>,
    /// The episodes, by index, without those whose physics failed.
    pub episodes: Vec<Episode>,
    /// Those whose physics failed; their rows were thrown away.
    pub faults: Vec<RolloutError>,
    /// Of each of the episodes, the moments of the observations in its rows, SI: of those that train a policy whose centre and
    /// scale are running statistics. None otherwise.
    #[serde(default)]
    pub observed: Vec<Moments>,
}

impl Batch {
    /// The number of rows.
    pub fn rows(&self) -> usize {
        self.reward.len()
    }

    /// Real simulator steps taken, those of discarded episodes included.
    pub fn env_steps(&self) -> u64 {
        self.rows() as u64 + self.faults.iter().map(RolloutError::env_steps).sum::<u64>()
    }

    /// The discounted return of each episode, Σ discount^t·reward.
    pub fn returns(&self, discount: f64) -> Vec<f64> {
        self.episodes.iter().map(|e| discounted(&self.reward[e.rows.clone()], discount)).collect()
    }

    /// Batches of consecutive episodes as one, in their order.
    pub fn join(parts: Vec<Self>) -> Self {
        let mut parts = parts.into_iter();
        let mut batch = parts.next().unwrap_or_default();
        batch.reserve(parts.as_slice());
        for part in parts {
            batch.append(part);
        }
        batch
    }

    /// The batch, where at least one of its episodes is of use.
    ///
    /// # Errors
    /// The first of those whose physics failed, where all did.
    pub fn sound(self) -> Result<Self, RolloutError> {
        match self.faults.first() {
            Some(fault) if self.episodes.is_empty() => Err(fault.clone()),
            _ => Ok(self),
        }
    }

    /// Makes room for what is to be appended, and no more: what grows by doubling takes up to twice as much.
    fn reserve(&mut self, more: &[Self]) {
        let sum = |length: fn(&Self) -> usize| more.iter().map(length).sum();
        self.obs.reserve_exact(sum(|b| b.obs.len()));
        self.state.reserve_exact(sum(|b| b.state.len()));
        self.action.reserve_exact(sum(|b| b.action.len()));
        self.log_prob.reserve_exact(sum(|b| b.log_prob.len()));
        self.reward.reserve_exact(sum(|b| b.reward.len()));
    }

    fn append(&mut self, other: Self) {
        let at = self.rows();
        self.obs.extend(other.obs);
        self.state.extend(other.state);
        self.action.extend(other.action);
        self.log_prob.extend(other.log_prob);
        self.reward.extend(other.reward);
        self.episodes.extend(other.episodes.into_iter().map(|mut e| {
            e.rows = e.rows.start + at..e.rows.end + at;
            e
        }));
        self.faults.extend(other.faults);
        self.observed.extend(other.observed);
    }
}
