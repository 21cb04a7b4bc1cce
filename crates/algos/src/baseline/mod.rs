//! Value baselines: what return to expect from a state.

mod linear;
mod mlp;

pub use linear::LinearBaseline;
pub use mlp::{MlpBaseline, MlpBaselineConfig};

use hwasp_core::{Batch, Executor};
use serde::{Deserialize, Serialize};

use crate::archive::{Exchange, Persist, StateError};
use crate::gae::{AdvantageConfig, Advantages, advantages, normalize};
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
    },
    /// A perceptron.
    Mlp(MlpBaselineConfig),
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
    /// A fresh one for observations of `obs_dim` components and a state of `state_dim`.
    pub fn new(config: &BaselineConfig, obs_dim: usize, state_dim: usize, seed: u64) -> Self {
        match config {
            BaselineConfig::Linear { ridge, privileged } => {
                Self::Linear(LinearBaseline::new(obs_dim, if *privileged { state_dim } else { 0 }, *ridge))
            }
            BaselineConfig::Mlp(config) => {
                Self::Mlp(Box::new(MlpBaseline::new(config.clone(), obs_dim, state_dim, seed)))
            }
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
        if config.normalize {
            normalize(&mut targets.advantage);
        }
        Ok(targets)
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
    pub(crate) fn fit_beside<T: Default + Send>(
        &mut self,
        executor: &dyn Executor,
        (batch, targets): (&Batch, &Advantages),
        (progress, iteration): (f64, u64),
        mut improve: impl FnMut() -> Result<T, LearnError> + Send,
    ) -> Result<T, LearnError> {
        let not_finite = |_| LearnError::NotFinite { what: "a parameter of the baseline", iteration };
        let before = self.save().map_err(not_finite)?;
        let (mut improved, mut fitted) = (Ok(T::default()), Ok(()));
        executor.both(&mut || improved = improve(), &mut || {
            fitted = self.fit(batch, targets, progress, iteration);
        });
        let result = improved.and_then(|improved| fitted.map(|()| improved));
        if result.is_err() {
            self.load(&before).map_err(not_finite)?;
        }
        result
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
