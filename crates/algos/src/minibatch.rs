//! Rows gathered for one gradient step.

use std::ops::Range;

use hwasp_core::{Batch, Rows};

use crate::draws::Draws;

/// Rows of a block that is worked on at once: its activations stay in the first-level cache.
pub const BLOCK: usize = 64;

/// Rows in minibatches of even size: as few of them as hold no more than `size` rows each (0 for all rows in one), larger
/// ones first, by one row at most. Every minibatch is a full step, so that a small rest would weigh its rows far more.
pub(crate) fn minibatches(rows: &[u32], size: usize) -> impl Iterator<Item = &[u32]> {
    let count = if size == 0 { rows.len().min(1) } else { rows.len().div_ceil(size) };
    let (each, larger) = (rows.len() / count.max(1), rows.len() % count.max(1));
    let start = move |i: usize| i * each + i.min(larger);
    (0..count).map(move |i| &rows[start(i)..start(i + 1)])
}

/// What learners need of some rows of a batch: observations by row, all else by column.
#[derive(Clone, Debug, Default)]
pub(crate) struct Minibatch {
    pub(crate) count: usize,
    obs: Vec<f32>,
    state: Vec<f32>,
    action: Vec<f32>,
    pub(crate) log_prob: Vec<f32>,
    pub(crate) advantage: Vec<f32>,
    /// What was drawn once an episode; to be [gathered](Draws::gather) from the same rows.
    pub(crate) draws: Draws,
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

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// 2,001 rows by 1,000 were steps of 1,000, 1,000 and 1: the last row moved the policy as far as 1,000 others.
    #[test]
    fn a_rest_is_no_minibatch_of_its_own() {
        let rows: Vec<u32> = (0..2001).collect();
        let sizes: Vec<usize> = minibatches(&rows, 1000).map(<[u32]>::len).collect();
        assert_eq!(sizes, [667, 667, 667]);
    }

    proptest! {
        #[test]
        fn minibatches_are_even_and_hold_every_row_once(rows in 1..500_u32, size in 0..600_usize) {
            let all: Vec<u32> = (0..rows).collect();
            let parts: Vec<&[u32]> = minibatches(&all, size).collect();
            prop_assert_eq!(parts.concat(), all.clone());
            let sizes: Vec<usize> = parts.iter().map(|part| part.len()).collect();
            let (least, most) = (sizes[sizes.len() - 1], sizes[0]);
            prop_assert!(most - least <= 1 && sizes.is_sorted_by(|a, b| a >= b), "{sizes:?}");
            if size == 0 || size >= all.len() {
                prop_assert_eq!(sizes, [all.len()]);
            } else {
                prop_assert!(2 * least >= size && most <= size, "{sizes:?} of {size}");
                // Where the rows divide evenly nothing is new.
                if all.len().is_multiple_of(size) {
                    prop_assert_eq!(parts, all.chunks(size).collect::<Vec<_>>());
                }
            }
        }
    }
}
