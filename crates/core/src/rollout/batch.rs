//! Whole episodes with all of their rows.

use std::ops::Range;

use super::{RolloutError, discounted};
use crate::environment::{End, Outcome};
use crate::policy::{HardwarePolicy, Policy};

/// One episode of a [`Batch`].
#[derive(Clone, Debug, PartialEq)]
pub struct Episode {
    /// Its rows in the batch.
    pub rows: Range<usize>,
    /// How it ended.
    pub end: End,
    /// What the controller would have seen next: the state whose value a truncated episode is bootstrapped from.
    pub last_obs: Vec<f32>,
    /// The law's state there, SI.
    pub last_state: Vec<f32>,
    /// What the episode was about and no sensor told, SI.
    pub context: Vec<f32>,
    /// Whether it succeeded, for tasks that know.
    pub outcome: Option<Outcome>,
}

/// Whole episodes, one row per step, an episode's rows one after the other.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Batch {
    /// Controller inputs `[rows × obs_dim]`.
    pub obs: Vec<f32>,
    /// The law's state `[rows × state_dim]`, SI.
    pub state: Vec<f32>,
    /// Actions as sampled, not clipped `[rows × action_dim]`, SI.
    pub action: Vec<f32>,
    /// Their log-probabilities.
    pub log_prob: Vec<f32>,
    /// Rewards.
    pub reward: Vec<f64>,
    /// The episodes, by index, without those whose physics failed.
    pub episodes: Vec<Episode>,
    /// Those whose physics failed; their rows were thrown away.
    pub faults: Vec<RolloutError>,
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

    /// Makes room for so many rows in all, and no more: what grows by doubling takes up to twice as much.
    pub(super) fn reserve(&mut self, rows: usize, policy: &HardwarePolicy) {
        let more = rows - self.rows();
        self.obs.reserve_exact(more * policy.obs_dim());
        self.state.reserve_exact(more * policy.state_dim());
        self.action.reserve_exact(more * policy.action_dim());
        self.log_prob.reserve_exact(more);
        self.reward.reserve_exact(more);
    }

    pub(super) fn append(&mut self, other: Self) {
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
    }
}
