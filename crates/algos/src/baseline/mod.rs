//! Value baselines: what return to expect from a state.

mod linear;
mod mlp;

pub use linear::LinearBaseline;
use mlp::Fit;
pub use mlp::{MlpBaseline, MlpBaselineConfig};

use hwasp_core::{Batch, Executor, Policy};
use serde::{Deserialize, Serialize};

use crate::archive::{Exchange, Persist, StateError};
use crate::gae::{AdvantageConfig, Advantages, Foresight, advantages, normalize};
use crate::learner::LearnError;

/// Which baseline.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum BaselineConfig {
    /// Ridge regression on observation and time features.
    Linear {
        /// The ridge.
        ridge: f64,
        /// Whether it also sees the law's state.
        privileged: bool,
        /// Whether it also sees the episode's context.
        context: bool,
    },
    /// A perceptron.
    Mlp(MlpBaselineConfig),
}

/// How many numbers a baseline has before it at each step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct InputDims {
    /// Of the controller's input.
    pub obs: usize,
    /// Of the law's state.
    pub state: usize,
    /// Of what an episode is about.
    pub context: usize,
}

impl InputDims {
    /// What a policy's batches have.
    pub fn of(policy: &impl Policy) -> Self {
        Self { obs: policy.obs_dim(), state: policy.state_dim(), context: policy.context_dim() }
    }

    /// What is left of it for one that sees the state or does not, and the context or not.
    fn visible(self, state: bool, context: bool) -> Self {
        let visible = |sees, count| if sees { count } else { 0 };
        Self { state: visible(state, self.state), context: visible(context, self.context), ..self }
    }
}

/// A value baseline.
#[derive(Debug)]
pub enum Baseline {
    /// See [`LinearBaseline`].
    Linear(LinearBaseline),
    /// See [`MlpBaseline`].
    Mlp(Box<MlpBaseline>),
}

impl Baseline {
    /// A fresh one for batches of these dimensions.
    pub fn new(config: &BaselineConfig, dims: InputDims, seed: u64) -> Self {
        match config {
            BaselineConfig::Linear { ridge, privileged, context } => {
                Self::Linear(LinearBaseline::new(dims.visible(*privileged, *context), *ridge))
            }
            BaselineConfig::Mlp(config) => Self::Mlp(Box::new(MlpBaseline::new(config.clone(), dims, seed))),
        }
    }

    /// V of every row, and of the state after each episode.
    pub fn predict(&mut self, batch: &Batch) -> (Vec<f32>, Vec<f32>) {
        match self {
            Self::Linear(linear) => linear.predict(batch),
            Self::Mlp(mlp) => mlp.predict(batch),
        }
    }

    /// Advantages and what to learn from the batch, with the values as they are before it.
    pub fn targets(
        &mut self,
        batch: &Batch,
        config: &AdvantageConfig,
        iteration: u64,
    ) -> Result<Advantages, LearnError> {
        let (values, last_values) = self.predict(batch);
        let discounting = (config.discount, config.gae_lambda);
        let mut targets = advantages(batch, &values, &last_values, discounting, config.bootstrap_truncated);
        if !targets.advantage.iter().all(|a| a.is_finite()) {
            return Err(LearnError::NotFinite { what: "an advantage", iteration });
        }
        targets.foresight = Foresight::of(&values, self.learns(&targets));
        if config.normalize {
            normalize(&mut targets.advantage);
        }
        Ok(targets)
    }

    /// What of them it learns.
    fn learns<'t>(&self, targets: &'t Advantages) -> &'t [f32] {
        match self {
            Self::Linear(_) => &targets.discounted_return,
            Self::Mlp(_) => &targets.lambda_return,
        }
    }

    /// Learns from the batch: the linear one the discounted return, the perceptron the λ-return. After an error it is as it
    /// was before.
    pub fn fit(
        &mut self,
        batch: &Batch,
        targets: &Advantages,
        progress: f64,
        iteration: u64,
    ) -> Result<(), LearnError> {
        match self {
            Self::Linear(linear) => linear.fit(batch, &targets.discounted_return),
            Self::Mlp(mlp) => {
                let not_finite = LearnError::NotFinite { what: "a parameter of the baseline", iteration };
                let Ok(before) = mlp.save() else { return Err(not_finite) };
                mlp.fit(batch, &targets.lambda_return, progress, iteration);
                // What cannot be saved is not finite; and what was saved can be loaded.
                if mlp.save().is_err() {
                    let _ = mlp.load(&before);
                    return Err(not_finite);
                }
            }
        }
        Ok(())
    }

    /// [Fits](Self::fit) while `improve` improves the policy, at once where there are threads for it: both learn from the same
    /// targets, and neither looks at the other. If either fails the baseline is as it was before.
    pub(crate) fn fit_beside<T: Send>(
        &mut self,
        executor: &dyn Executor,
        (batch, targets): (&Batch, &Advantages),
        (progress, iteration): (f64, u64),
        mut improve: impl FnMut() -> Result<T, LearnError> + Send,
    ) -> Result<T, LearnError> {
        self.or_as_before(iteration, |baseline| {
            let (mut improved, mut fitted) = (None, None);
            executor.both(&mut || improved = Some(improve()), &mut || {
                fitted = Some(baseline.fit(batch, targets, progress, iteration));
            });
            let (improved, fitted) = improved.zip(fitted).expect("an executor runs every job");
            improved.and_then(|improved| fitted.map(|()| improved))
        })
    }

    /// Does something with it. If that fails, the baseline is as it was before.
    pub(crate) fn or_as_before<T>(
        &mut self,
        iteration: u64,
        act: impl FnOnce(&mut Self) -> Result<T, LearnError>,
    ) -> Result<T, LearnError> {
        let not_finite = |_| LearnError::NotFinite { what: "a parameter of the baseline", iteration };
        let before = self.save().map_err(not_finite)?;
        let result = act(self);
        if result.is_err() {
            self.load(&before).map_err(not_finite)?;
        }
        result
    }

    /// Whether all its parameters are numbers.
    pub(crate) fn check(&mut self, iteration: u64) -> Result<(), LearnError> {
        // What cannot be saved is not finite.
        let saved = self.save().map(drop);
        saved.map_err(|_| LearnError::NotFinite { what: "a parameter of the baseline", iteration })
    }

    /// Passes over a batch that a fit takes.
    pub(crate) fn epochs(&self) -> usize {
        match self {
            Self::Linear(_) => 1,
            Self::Mlp(mlp) => mlp.epochs(),
        }
    }

    /// A fit that is done epoch by epoch, before its first.
    pub(crate) fn begin(&mut self, batch: &Batch, targets: &Advantages, progress: f64, iteration: u64) -> Option<Fit> {
        match self {
            Self::Linear(_) => None,
            Self::Mlp(mlp) => Some(mlp.begin(batch, &targets.lambda_return, progress, iteration)),
        }
    }

    /// So many epochs of a fit that was begun with this batch; the targets may have changed since.
    pub(crate) fn fit_epochs(&mut self, fit: &mut Option<Fit>, batch: &Batch, targets: &Advantages, count: usize) {
        match (self, fit) {
            (Self::Linear(linear), None) if count > 0 => linear.fit(batch, &targets.discounted_return),
            (Self::Mlp(mlp), Some(fit)) => mlp.fit_epochs(fit, batch, &targets.lambda_return, count),
            _ => {}
        }
    }
}

impl Persist for Baseline {
    fn exchange(&mut self, with: &mut Exchange<'_>) -> Result<(), StateError> {
        match self {
            Self::Linear(linear) => with.part("linear", linear),
            Self::Mlp(mlp) => with.part("mlp", &mut **mlp),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use hwasp_core::{End, Episode};

    /// Two episodes of 20 rows that show a controller the same and are worth 10 and -10, and a context of 0.3 and 0.5.
    pub(super) fn two_that_look_alike() -> (Batch, Vec<f32>) {
        let episode = |i: usize| Episode {
            rows: 20 * i..20 * (i + 1),
            end: End::Truncated,
            cut: false,
            last_obs: vec![0.5],
            last_state: vec![],
            context: vec![0.3 + 0.2 * i as f32],
            log_prob: 0.0,
            outcome: None,
            terms: vec![],
        };
        let batch = Batch {
            obs: vec![0.5; 40],
            reward: vec![0.0; 40],
            episodes: vec![episode(0), episode(1)],
            ..Batch::default()
        };
        let targets = (0..40).map(|row| if row < 20 { 10.0 } else { -10.0 }).collect();
        (batch, targets)
    }
}
