//! Running statistics of a training: of what controllers observe, and of what their episodes return.

use hwasp_algos::{Exchange, Persist, StateError};
use hwasp_core::{Batch, Moments};

use crate::assemble::Assembly;

/// Added to every variance: what hardly varies is not blown up (as Gymnasium's `NormalizeObservation` and `NormalizeReward`
/// have it).
const LEAST_VARIANCE: f64 = 1e-8;

/// The statistics that an experiment asks for.
#[derive(Clone, Debug)]
pub(crate) struct Running {
    /// Of the observations, SI, in all rows that were learned from.
    observed: Option<Moments>,
    /// Of the discounted sum of rewards since the start of an episode, in all rows that were learned from, and the discount.
    returns: Option<(Moments, f64)>,
}

impl Running {
    /// Before the first iteration.
    pub(crate) fn new(assembly: &Assembly) -> Self {
        let (policy, experiment) = (&assembly.policy, assembly.experiment());
        let observations = policy.spec().observation_center.len();
        Self {
            observed: policy.spec().normalize.map(|_| Moments::new(observations)),
            returns: experiment.train.reward_scaling.then(|| (Moments::new(1), experiment.discount())),
        }
    }

    /// Goes on with the statistics that a policy's centre and scale `[2 × observations]` came from, over so many rows.
    pub(crate) fn go_on(&mut self, normalizer: &[f32], rows: u64) {
        if let Some(observed) = &mut self.observed {
            let (center, scale) = normalizer.split_at(observed.mean.len());
            observed.count = rows as f64;
            observed.mean = center.iter().map(|&x| f64::from(x)).collect();
            let variance = |&x: &f32| (f64::from(x).powi(2) - LEAST_VARIANCE).max(0.0);
            observed.squares = scale.iter().map(|x| observed.count * variance(x)).collect();
        }
    }

    /// Takes in a batch, its episodes in their order.
    pub(crate) fn take(&mut self, batch: &Batch) {
        if let Some(observed) = &mut self.observed {
            batch.observed.iter().for_each(|part| observed.merge(part));
        }
        if let Some((returns, discount)) = &mut self.returns {
            for episode in &batch.episodes {
                let mut sum = 0.0;
                for reward in &batch.reward[episode.rows.clone()] {
                    sum = *discount * sum + reward;
                    returns.push(&[sum]);
                }
            }
        }
    }

    /// Writes centre and scale `[2 × observations]` into a policy's parameters; before the first rows they stay.
    pub(crate) fn publish(&self, normalizer: &mut [f32]) {
        let Some(observed) = self.observed.as_ref().filter(|observed| observed.count > 0.0) else { return };
        let (center, scale) = normalizer.split_at_mut(observed.mean.len());
        for (to, mean) in center.iter_mut().zip(&observed.mean) {
            *to = *mean as f32;
        }
        for (to, variance) in scale.iter_mut().zip(observed.variances()) {
            *to = (variance + LEAST_VARIANCE).sqrt() as f32;
        }
    }

    /// The rewards that a learner sees; none where they are those of the task.
    pub(crate) fn rewards(&self, batch: &Batch) -> Option<Vec<f64>> {
        let (returns, _) = self.returns.as_ref()?;
        let std = returns.variances().map(|variance| (variance + LEAST_VARIANCE).sqrt()).next().unwrap_or(1.0);
        Some(batch.reward.iter().map(|reward| reward / std).collect())
    }
}

impl Persist for Running {
    fn exchange(&mut self, with: &mut Exchange<'_>) -> Result<(), StateError> {
        if let Some(observed) = &mut self.observed {
            with.part("observed", observed)?;
        }
        if let Some((returns, _)) = &mut self.returns {
            with.part("returns", returns)?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use hwasp_core::{End, Episode};

    fn episode(rows: std::ops::Range<usize>) -> Episode {
        Episode {
            rows,
            end: End::Truncated,
            cut: false,
            last_obs: vec![],
            last_state: vec![],
            context: vec![],
            log_prob: 0.0,
            outcome: None,
            terms: vec![],
        }
    }

    fn moments(rows: &[f64]) -> Moments {
        let mut moments = Moments::new(1);
        for &x in rows {
            moments.push(&[x]);
        }
        moments
    }

    /// With γ = 0.5, rewards 2, 4 | 1, 2, 3 sum up to 2, 5 | 1, 2.5, 4.25: mean 2.95, squared deviations 0.9025 + 4.2025 +
    /// 3.8025 + 0.2025 + 1.69 = 10.8, variance 2.16. The sums begin anew with each episode.
    #[test]
    fn rewards_are_divided_by_the_deviation_of_discounted_sums() {
        let mut running = Running { observed: None, returns: Some((Moments::new(1), 0.5)) };
        let reward = vec![2.0, 4.0, 1.0, 2.0, 3.0];
        let batch = Batch { reward: reward.clone(), episodes: vec![episode(0..2), episode(2..5)], ..Batch::default() };
        running.take(&batch);
        for (scaled, reward) in running.rewards(&batch).unwrap().into_iter().zip(reward) {
            assert!((scaled - reward / (2.16_f64 + 1e-8).sqrt()).abs() < 1e-12, "{scaled} of {reward}");
        }
    }

    /// 1, 2 | 4, 9 have mean 4 and variance 38/4. Before them nothing is written.
    #[test]
    fn centre_and_scale_are_mean_and_deviation_of_what_was_observed() {
        let mut running = Running { observed: Some(Moments::new(1)), returns: None };
        let mut normalizer = [0.25, 3.0];
        running.publish(&mut normalizer);
        assert_eq!(normalizer, [0.25, 3.0]);
        running.take(&Batch { observed: vec![moments(&[1.0, 2.0]), moments(&[4.0, 9.0])], ..Batch::default() });
        running.publish(&mut normalizer);
        assert_eq!(normalizer, [4.0, (9.5_f64 + 1e-8).sqrt() as f32]);
        assert!(running.rewards(&Batch::default()).is_none());
        // Whoever goes on with them has them again, and what comes next counts by its share.
        let mut further = Running { observed: Some(Moments::new(1)), returns: None };
        further.go_on(&normalizer, 4);
        let mut again = [0.0; 2];
        further.publish(&mut again);
        assert_eq!(again, normalizer);
        further.take(&Batch { observed: vec![moments(&[9.0; 4])], ..Batch::default() });
        further.publish(&mut again);
        assert_eq!(again[0], 6.5);
    }
}
