//! The surrogate objective of policy gradients: the mean of ρ·A, with ρ the ratio of new to old probabilities.

use std::ops::Range;

use hwasp_core::gaussian;
use hwasp_diff::fast::{exp, vectorised};

use crate::minibatch::{BLOCK, Minibatch};

/// The surrogate of one block of rows, clipped as PPO has it or as it is. What is [drawn](crate::draws) once an episode has a
/// ratio of its own.
pub(crate) struct Surrogate<'a> {
    pub(crate) minibatch: &'a Minibatch,
    pub(crate) block: Range<usize>,
    /// Means `[A × BLOCK]`.
    pub(crate) mean: &'a [f32],
    pub(crate) log_std: &'a [f32],
    /// Action components, the first ones, that are drawn once an episode.
    pub(crate) drawn: usize,
    /// Infinite for the surrogate without a clip.
    pub(crate) clip_ratio: f32,
}

/// Sums over rows, for steps or for draws: each row counts as its share of a draw.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct RatioSums {
    /// Of the estimate (ρ - 1) - log ρ of the divergence.
    pub(crate) kl: f64,
    /// Of what the clip has taken over.
    pub(crate) clipped: f64,
}

/// A part of the action with a ratio of its own: its components and, by row, its old log-probabilities, advantages and, for
/// draws, shares.
struct Part<'a> {
    components: Range<usize>,
    old: &'a [f32],
    advantage: &'a [f32],
    share: Option<&'a [f32]>,
}

impl Surrogate<'_> {
    /// Writes the cotangents of the means `[A × BLOCK]` and adds those of the log standard deviations. Returns the sums over
    /// the steps, and over the draws.
    pub(crate) fn differentiate(&self, cotangent: &mut [f32], log_std_gradient: &mut [f32]) -> [RatioSums; 2] {
        vectorised(
            #[inline(always)]
            || {
                let steps = self.differentiate_part(&self.steps(), cotangent, log_std_gradient);
                let draws = self.draws().map(|part| self.differentiate_part(&part, cotangent, log_std_gradient));
                [steps, draws.unwrap_or_default()]
            },
        )
    }

    /// What is sampled at every step.
    #[inline(always)]
    fn steps(&self) -> Part<'_> {
        Part {
            components: self.drawn..self.log_std.len(),
            old: &self.minibatch.log_prob[self.block.clone()],
            advantage: &self.minibatch.advantage[self.block.clone()],
            share: None,
        }
    }

    /// What is drawn once an episode, where there is something.
    #[inline(always)]
    fn draws(&self) -> Option<Part<'_>> {
        let draws = &self.minibatch.draws;
        (self.drawn > 0).then(|| Part {
            components: 0..self.drawn,
            old: &draws.log_prob[self.block.clone()],
            advantage: &draws.advantage[self.block.clone()],
            share: Some(&draws.share[self.block.clone()]),
        })
    }

    #[inline(always)]
    fn differentiate_part(&self, part: &Part<'_>, cotangent: &mut [f32], log_std_gradient: &mut [f32]) -> RatioSums {
        let count = self.block.len();
        let weight = -1.0 / self.minibatch.count as f32;
        let log_prob = self.log_prob(&part.components);
        // d loss / d log-probability of each row; zero where the clip has taken over.
        let mut pull = [0.0_f32; BLOCK];
        let mut kl = [0.0_f32; BLOCK];
        let mut clipped = [0.0_f32; BLOCK];
        let (lo, hi) = (1.0 - self.clip_ratio, 1.0 + self.clip_ratio);
        for r in 0..count {
            let log_ratio = log_prob[r] - part.old[r];
            let ratio = exp(log_ratio);
            let a = part.advantage[r];
            let outside = if a >= 0.0 { ratio > hi } else { ratio < lo };
            pull[r] = if outside { 0.0 } else { weight * ratio * a };
            kl[r] = ratio - 1.0 - log_ratio;
            clipped[r] = f32::from(u8::from(outside));
        }
        for (r, share) in part.share.into_iter().flatten().enumerate() {
            pull[r] *= share;
            kl[r] *= share;
            clipped[r] *= share;
        }
        for (j, (mean, &log_std)) in self.columns(&part.components) {
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
        RatioSums { kl: f64::from(kl.iter().sum::<f32>()), clipped: f64::from(clipped.iter().sum::<f32>()) }
    }

    /// Σ ρ·A over the block, without a clip.
    pub(crate) fn sum(&self) -> f64 {
        vectorised(
            #[inline(always)]
            || self.sum_part(&self.steps()) + self.draws().map_or(0.0, |part| self.sum_part(&part)),
        )
    }

    #[inline(always)]
    fn sum_part(&self, part: &Part<'_>) -> f64 {
        let log_prob = self.log_prob(&part.components);
        let mut weighted = [0.0_f32; BLOCK];
        for r in 0..self.block.len() {
            weighted[r] = exp(log_prob[r] - part.old[r]) * part.advantage[r];
        }
        for (r, share) in part.share.into_iter().flatten().enumerate() {
            weighted[r] *= share;
        }
        weighted.iter().map(|&w| f64::from(w)).sum()
    }

    #[inline(always)]
    fn columns(&self, components: &Range<usize>) -> impl Iterator<Item = (usize, (&[f32], &f32))> {
        let all = self.mean.chunks_exact(BLOCK).zip(self.log_std).enumerate();
        all.skip(components.start).take(components.len())
    }

    /// Log-probabilities of these components of the block's actions.
    #[inline(always)]
    fn log_prob(&self, components: &Range<usize>) -> [f32; BLOCK] {
        let mut log_prob = [0.0_f32; BLOCK];
        log_prob.fill(-gaussian::log_norm(&self.log_std[components.clone()]) as f32);
        for (j, (mean, &log_std)) in self.columns(components) {
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
