//! What is drawn once an episode: a design that a body keeps while the episode lasts.
//!
//! An episode draws d from p and then acts by a ~ π(· | s, d). The gradient of what it returns is
//!
//! ```text
//! E[Σ_t ∇log π(a_t | s_t)·A_t + ∇log p(d)·A]
//! ```
//!
//! where `A = Σ_t γ^t·r_t - b` is the worth of the draw, b any number that does not depend on d, and γ^t is left out of the first
//! sum as usual. Generalised advantages would credit d with the first few rewards alone. Learners take the mean over the rows of a
//! batch: the sum over its episodes, divided by the number of rows. So a draw weighs as much as one step, not as much as all
//! of an episode's.
//!
//! Each of the T rows of an episode carries 1/T of its draw's term. The sum is the same as if the first row carried all, and
//! every minibatch has a share of many draws. A draw has a ratio, a clip and a divergence of its own.

use hwasp_core::{Batch, Policy};

use crate::gae::{AdvantageConfig, Advantages, normalize};

/// What a surrogate needs of draws, a value for each row; empty where nothing is drawn.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Draws {
    /// One over the rows of its episode.
    pub(crate) share: Vec<f32>,
    /// Log-probability of its episode's draw, of the policy that acted.
    pub(crate) log_prob: Vec<f32>,
    /// What the draw was worth.
    pub(crate) advantage: Vec<f32>,
}

impl Draws {
    /// Of the episodes of a batch. `normalize` of the configuration centres and scales over the episodes.
    pub(crate) fn new(policy: &impl Policy, batch: &Batch, targets: &Advantages, config: &AdvantageConfig) -> Self {
        let mut draws = Self::default();
        if policy.drawn_actions() == 0 {
            return draws;
        }
        let mut worth: Vec<f32> = if policy.start_shows_draw() {
            over_the_others(&targets.episode_return)
        } else {
            targets.episode_advantage.iter().map(|&a| a as f32).collect()
        };
        if config.normalize {
            normalize(&mut worth);
        }
        for (episode, worth) in batch.episodes.iter().zip(worth) {
            let rows = episode.rows.len();
            draws.share.extend(std::iter::repeat_n(1.0 / rows as f32, rows));
            draws.log_prob.extend(std::iter::repeat_n(episode.log_prob, rows));
            draws.advantage.extend(std::iter::repeat_n(worth, rows));
        }
        draws
    }

    /// Makes these the draws of some rows of others.
    pub(crate) fn gather(&mut self, all: &Self, indices: &[u32]) {
        let columns =
            [(&mut self.share, &all.share), (&mut self.log_prob, &all.log_prob), (&mut self.advantage, &all.advantage)];
        for (to, from) in columns {
            to.clear();
            if !from.is_empty() {
                to.extend(indices.iter().map(|&i| from[i as usize]));
            }
        }
    }

    /// How many draws the rows stand for: the sum of their shares.
    pub(crate) fn count(&self) -> f64 {
        self.share.iter().map(|&share| f64::from(share)).sum()
    }
}

/// By how much each number exceeds the mean of the others, which do not depend on it; 0 where there are none.
fn over_the_others(values: &[f64]) -> Vec<f32> {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n.max(1.0);
    let more = if n > 1.0 { n / (n - 1.0) } else { 0.0 };
    values.iter().map(|value| (more * (value - mean)) as f32).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The baseline of a draw must not depend on it, or the gradient would not be that of the return.
    #[test]
    fn the_others_are_the_baseline() {
        assert_eq!(over_the_others(&[1.0, 2.0, 6.0]), [1.0 - 4.0, 2.0 - 3.5, 6.0 - 1.5]);
        assert_eq!(over_the_others(&[5.0]), [0.0]);
    }

    /// Minibatches of shuffled rows have the shares of their rows, and nothing where nothing is drawn.
    #[test]
    fn rows_keep_their_shares() {
        let all = Draws { share: vec![0.5, 0.5, 1.0], log_prob: vec![1.0, 1.0, 2.0], advantage: vec![3.0, 3.0, 4.0] };
        let mut some = all.clone();
        some.gather(&all, &[2, 0]);
        assert_eq!(some, Draws { share: vec![1.0, 0.5], log_prob: vec![2.0, 1.0], advantage: vec![4.0, 3.0] });
        assert_eq!(some.count(), 1.5);
        some.gather(&Draws::default(), &[2, 0]);
        assert_eq!(some, Draws::default());
    }
}
