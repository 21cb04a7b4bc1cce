//! Rows gathered for one gradient step.

use std::ops::Range;

use hwasp_core::{Batch, Rows};

/// Rows of a block that is worked on at once: its activations stay in the first-level cache.
pub(crate) const BLOCK: usize = 64;

/// What learners need of some rows of a batch: observations by row, all else by column.
#[derive(Clone, Debug, Default)]
pub(crate) struct Minibatch {
    pub(crate) count: usize,
    obs: Vec<f32>,
    state: Vec<f32>,
    action: Vec<f32>,
    pub(crate) log_prob: Vec<f32>,
    pub(crate) advantage: Vec<f32>,
    obs_dim: usize,
}

impl Minibatch {
    /// Gathers the rows of these indices.
    pub(crate) fn gather(&mut self, batch: &Batch, advantage: &[f32], indices: &[u32], dims: (usize, usize, usize)) {
        let (obs_dim, state_dim, action_dim) = dims;
        let count = indices.len();
        (self.count, self.obs_dim) = (count, obs_dim);
        self.obs.resize(count * obs_dim, 0.0);
        self.state.resize(count * state_dim, 0.0);
        self.action.resize(count * action_dim, 0.0);
        self.log_prob.resize(count, 0.0);
        self.advantage.resize(count, 0.0);
        for (r, &i) in indices.iter().enumerate() {
            let i = i as usize;
            self.obs[r * obs_dim..][..obs_dim].copy_from_slice(&batch.obs[i * obs_dim..][..obs_dim]);
            for (s, &x) in batch.state[i * state_dim..][..state_dim].iter().enumerate() {
                self.state[s * count + r] = x;
            }
            for (a, &x) in batch.action[i * action_dim..][..action_dim].iter().enumerate() {
                self.action[a * count + r] = x;
            }
            self.log_prob[r] = batch.log_prob[i];
            self.advantage[r] = advantage[i];
        }
    }

    /// The blocks, in order.
    pub(crate) fn blocks(&self) -> impl Iterator<Item = Range<usize>> + use<> {
        let count = self.count;
        (0..count).step_by(BLOCK).map(move |at| at..(at + BLOCK).min(count))
    }

    /// A block as a policy takes it.
    pub(crate) fn rows(&self, block: &Range<usize>) -> Rows<'_> {
        Rows {
            count: block.len(),
            obs: &self.obs[block.start * self.obs_dim..block.end * self.obs_dim],
            state: self.state.get(block.start..).unwrap_or(&[]),
            action: &self.action[block.start..],
            stride: self.count,
        }
    }

    /// Column `j` of the actions of a block.
    pub(crate) fn action(&self, j: usize, block: &Range<usize>) -> &[f32] {
        &self.action[j * self.count + block.start..][..block.len()]
    }
}
