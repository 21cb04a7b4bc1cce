//! The surrogate objective of policy gradients: the mean of ρ·A, with ρ the ratio of new to old probabilities.

use std::ops::Range;

use hwasp_core::gaussian;
use hwasp_diff::fast::{exp, vectorised};

use crate::minibatch::{BLOCK, Minibatch};

/// The surrogate of one block of rows, clipped as PPO has it or as it is.
pub(crate) struct Surrogate<'a> {
    pub(crate) minibatch: &'a Minibatch,
    pub(crate) block: Range<usize>,
    /// Means `[A × BLOCK]`.
    pub(crate) mean: &'a [f32],
    pub(crate) log_std: &'a [f32],
    /// Infinite for the surrogate without a clip.
    pub(crate) clip_ratio: f32,
}

impl Surrogate<'_> {
    /// Writes the cotangents of the means `[A × BLOCK]` and adds those of the log standard deviations. Returns the sums of
    /// the KL estimate (ρ - 1) - log ρ and of the clipped rows.
    pub(crate) fn differentiate(&self, cotangent: &mut [f32], log_std_gradient: &mut [f32]) -> (f64, f64) {
        vectorised(
            #[inline(always)]
            || self.differentiate_inlined(cotangent, log_std_gradient),
        )
    }

    #[inline(always)]
    fn differentiate_inlined(&self, cotangent: &mut [f32], log_std_gradient: &mut [f32]) -> (f64, f64) {
        let count = self.block.len();
        let old = &self.minibatch.log_prob[self.block.clone()];
        let advantage = &self.minibatch.advantage[self.block.clone()];
        let weight = -1.0 / self.minibatch.count as f32;
        let log_prob = self.log_prob();
        // d loss / d log-probability of each row; zero where the clip has taken over.
        let mut pull = [0.0_f32; BLOCK];
        let mut kl = [0.0_f32; BLOCK];
        let mut clipped = [0.0_f32; BLOCK];
        let (lo, hi) = (1.0 - self.clip_ratio, 1.0 + self.clip_ratio);
        for r in 0..count {
            let log_ratio = log_prob[r] - old[r];
            let ratio = exp(log_ratio);
            let a = advantage[r];
            let outside = if a >= 0.0 { ratio > hi } else { ratio < lo };
            pull[r] = if outside { 0.0 } else { weight * ratio * a };
            kl[r] = ratio - 1.0 - log_ratio;
            clipped[r] = f32::from(u8::from(outside));
        }
        for (j, (mean, &log_std)) in self.columns() {
            let inverse = (-log_std).exp();
            let action = self.minibatch.action(j, &self.block);
            let out = &mut cotangent[j * BLOCK..][..count];
            let mut lanes = [0.0_f32; 16];
            for (r, out) in out.iter_mut().enumerate() {
                let z = (action[r] - mean[r]) * inverse;
                *out = pull[r] * z * inverse;
                lanes[r % 16] += pull[r] * (z * z - 1.0);
            }
            log_std_gradient[j] += lanes.iter().sum::<f32>();
        }
        (f64::from(kl.iter().sum::<f32>()), f64::from(clipped.iter().sum::<f32>()))
    }

    /// Σ ρ·A over the block, without a clip.
    pub(crate) fn sum(&self) -> f64 {
        vectorised(
            #[inline(always)]
            || {
                let count = self.block.len();
                let old = &self.minibatch.log_prob[self.block.clone()];
                let advantage = &self.minibatch.advantage[self.block.clone()];
                let log_prob = self.log_prob();
                let mut weighted = [0.0_f32; BLOCK];
                for r in 0..count {
                    weighted[r] = exp(log_prob[r] - old[r]) * advantage[r];
                }
                weighted.iter().map(|&w| f64::from(w)).sum()
            },
        )
    }

    fn columns(&self) -> impl Iterator<Item = (usize, (&[f32], &f32))> {
        self.mean.chunks_exact(BLOCK).zip(self.log_std).enumerate()
    }

    /// Log-probabilities of the block's actions.
    #[inline(always)]
    fn log_prob(&self) -> [f32; BLOCK] {
        let mut log_prob = [0.0_f32; BLOCK];
        log_prob.fill(-gaussian::log_norm(self.log_std) as f32);
        for (j, (mean, &log_std)) in self.columns() {
            let inverse = (-log_std).exp();
            let action = self.minibatch.action(j, &self.block);
            for ((p, a), m) in log_prob[..self.block.len()].iter_mut().zip(action).zip(mean) {
                let z = (a - m) * inverse;
                *p = (-0.5 * z).mul_add(z, *p);
            }
        }
        log_prob
    }
}
