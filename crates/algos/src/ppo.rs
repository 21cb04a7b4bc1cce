//! Proximal policy optimisation (Schulman et al. 2017).

mod optimiser;

use std::sync::Arc;

use hwasp_core::{Batch, Executor, Policy};
use serde::{Deserialize, Serialize};

use self::optimiser::Optimiser;
use crate::archive::{Exchange, Persist, StateError};
use crate::baseline::{Baseline, BaselineConfig, InputDims};
use crate::draws::Draws;
use crate::gae::{AdvantageConfig, Advantages};
use crate::learner::{LearnError, Learner};
use crate::metrics::Metrics;

/// Settings of [`Ppo`].
///
/// | name | default | purpose |
/// |---|---|---|
/// | `discount` | 0.99 | γ |
/// | `gae_lambda` | 0.95 | λ of the advantages |
/// | `clip_ratio` | 0.2 | ε of the clipped surrogate |
/// | `epochs` | 4 | passes over a batch |
/// | `minibatch_rows` | 1000 | rows of a gradient step at most, the same for all steps but for one row; 0 for the whole batch |
/// | `learning_rate` | 1e-3 | of Adam |
/// | `learning_rate_final` | 1 | fraction of it left at the end of a linear decay |
/// | `design_lr_scale` | 1 | times the rate, for design parameters |
/// | `log_std_lr_scale` | 1 | times the rate, for log standard deviations |
/// | `entropy_coef` | 0 | weight of the entropy in the objective |
/// | `max_grad_norm` | 0.5 | longest gradient |
/// | `target_kl` | none | epochs end when the KL divergence, of steps or of draws, passes 1.5 times this |
/// | `normalize_advantages` | true | mean 0, variance 1 over the batch |
/// | `bootstrap_truncated` | true | value the state after a truncated episode; the paper's toolkit does not |
/// | `recompute_advantages` | false | advantages of each epoch after the first come from the values as they are by then |
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PpoConfig {
    /// γ, of returns and advantages.
    pub discount: f64,
    /// λ of the advantages.
    pub gae_lambda: f64,
    /// ε of the clipped surrogate (eq. 7).
    pub clip_ratio: f64,
    /// Passes over a batch.
    pub epochs: usize,
    /// Rows of a gradient step at most: a batch is divided evenly. 0 for the whole batch.
    pub minibatch_rows: usize,
    /// Step size of Adam at the start.
    pub learning_rate: f64,
    /// What fraction of it is left at the end.
    pub learning_rate_final: f64,
    /// Times the rate, for design parameters.
    pub design_lr_scale: f64,
    /// Times the rate, for log standard deviations.
    pub log_std_lr_scale: f64,
    /// Adam's epsilon.
    pub adam_epsilon: f64,
    /// Weight of the entropy in the objective (c₂ of eq. 9).
    pub entropy_coef: f64,
    /// Longest gradient.
    pub max_grad_norm: Option<f64>,
    /// Epochs end when the KL divergence, of steps or of draws, passes 1.5 times this.
    pub target_kl: Option<f64>,
    /// Whether advantages are centred and scaled over the batch.
    pub normalize_advantages: bool,
    /// Whether the state after a truncated episode is valued.
    pub bootstrap_truncated: bool,
    /// Whether the advantages of each epoch after the first are computed anew, with the baseline that the epoch before has
    /// fitted; and so is what the baseline learns (Andrychowicz et al. 2021, section 3.5, recommend it).
    pub recompute_advantages: bool,
}

impl Default for PpoConfig {
    fn default() -> Self {
        Self {
            discount: 0.99,
            gae_lambda: 0.95,
            clip_ratio: 0.2,
            epochs: 4,
            minibatch_rows: 1000,
            learning_rate: 1e-3,
            learning_rate_final: 1.0,
            design_lr_scale: 1.0,
            log_std_lr_scale: 1.0,
            adam_epsilon: 1e-8,
            entropy_coef: 0.0,
            max_grad_norm: Some(0.5),
            target_kl: None,
            normalize_advantages: true,
            bootstrap_truncated: true,
            recompute_advantages: false,
        }
    }
}

impl PpoConfig {
    /// What of it concerns advantages.
    fn advantages(&self) -> AdvantageConfig {
        AdvantageConfig {
            discount: self.discount,
            gae_lambda: self.gae_lambda,
            normalize: self.normalize_advantages,
            bootstrap_truncated: self.bootstrap_truncated,
        }
    }
}

/// PPO with its baseline.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PpoSettings {
    /// Of the policy's updates.
    pub ppo: PpoConfig,
    /// The value baseline.
    pub baseline: BaselineConfig,
}

/// What an update of [`Ppo`] tells of a policy that draws a part of the design once an episode.
const DRAW_METRICS: &[&str] = &[
    "kl",
    "entropy",
    "clip_fraction",
    "grad_norm",
    "epochs",
    "value_loss",
    "explained_variance",
    "design_kl",
    "design_clip_fraction",
];
/// The same of other policies, which have no draws to tell of.
const METRICS: &[&str] = DRAW_METRICS.split_at(7).0;

/// What an update of this policy tells.
fn metric_names(policy: &impl Policy) -> &'static [&'static str] {
    if policy.drawn_actions() == 0 { METRICS } else { DRAW_METRICS }
}

/// The learner: a policy's parameters, their optimiser and a baseline.
///
/// | metric | meaning |
/// |---|---|
/// | `kl` | KL divergence from the policy that acted, nats: an estimate, the mean over the rows of the last epoch, each taken before its gradient step |
/// | `entropy` | entropy of the action distribution after the update, nats |
/// | `clip_fraction` | share of rows in the last epoch whose ratio was clipped |
/// | `grad_norm` | mean norm of the policy gradient before clipping |
/// | `epochs` | epochs done; fewer than asked for where the KL limit stopped them |
/// | `value_loss` | mean square of the error of the values that the advantages come from, before they learn: reward², of the rewards that the learner sees |
/// | `explained_variance` | the share of the variance of what they learn that these values account for: 1 at best, 0 for values that know the mean alone |
/// | `design_kl`, `design_clip_fraction` | the first and the third for what is drawn once an episode, the mean over the episodes; only where something is |
pub struct Ppo<P: Policy> {
    optimiser: Optimiser<P>,
    baseline: Baseline,
}

impl<P: Policy> Ppo<P> {
    /// Starts from `params`. `seed` names the streams of minibatches and of the baseline.
    pub fn new(settings: &PpoSettings, policy: Arc<P>, params: Vec<f32>, seed: u64) -> Self {
        let baseline = Baseline::new(&settings.baseline, InputDims::of(&*policy), seed);
        Self { optimiser: Optimiser::new(settings.ppo.clone(), policy, params, seed), baseline }
    }
}

impl<P: Policy> Learner for Ppo<P> {
    fn params(&self) -> &[f32] {
        &self.optimiser.params
    }

    fn metric_names(&self) -> &'static [&'static str] {
        metric_names(&*self.optimiser.policy)
    }

    fn update(
        &mut self,
        executor: &dyn Executor,
        batch: &Batch,
        progress: f64,
        iteration: u64,
    ) -> Result<Metrics, LearnError> {
        let Self { optimiser, baseline } = self;
        let config = optimiser.config.advantages();
        let targets = baseline.targets(batch, &config, iteration)?;
        let draws = Draws::new(&*optimiser.policy, batch, &targets, &config);
        let before = (optimiser.params.clone(), optimiser.adam.clone());
        let when = (progress, iteration);
        let result = if optimiser.config.recompute_advantages {
            baseline
                .or_as_before(iteration, |baseline| epoch_by_epoch(executor, optimiser, baseline, batch, targets, when))
        } else {
            baseline.fit_beside(executor, (batch, &targets), when, || {
                optimiser.update(batch, (&targets, &draws), progress, iteration)
            })
        };
        if result.is_err() {
            (optimiser.params, optimiser.adam) = before;
        }
        result
    }
}

/// An update in which each epoch of the policy has one of the baseline beside it, and advantages are computed anew between
/// them. The baseline's own number of epochs is spread over those of the policy.
fn epoch_by_epoch<P: Policy>(
    executor: &dyn Executor,
    optimiser: &mut Optimiser<P>,
    baseline: &mut Baseline,
    batch: &Batch,
    mut targets: Advantages,
    (progress, iteration): (f64, u64),
) -> Result<Metrics, LearnError> {
    let config = optimiser.config.advantages();
    let (own, epochs) = (baseline.epochs(), optimiser.config.epochs);
    let mut update = optimiser.begin(batch.rows(), targets.foresight, progress, iteration);
    let mut fit = baseline.begin(batch, &targets, progress, iteration);
    for epoch in 0..epochs {
        let draws = Draws::new(&*optimiser.policy, batch, &targets, &config);
        let done = |epochs_done: usize| (own * epochs_done).div_ceil(epochs);
        let (count, rest) = (done(epoch + 1) - done(epoch), own - done(epoch + 1));
        let mut goes_on = Ok(false);
        executor.both(&mut || goes_on = optimiser.epoch(&mut update, batch, (&targets.advantage, &draws)), &mut || {
            baseline.fit_epochs(&mut fit, batch, &targets, count);
        });
        if !goes_on? {
            // What the limit on the divergence ends is the policy's.
            baseline.fit_epochs(&mut fit, batch, &targets, rest);
            break;
        }
        targets = baseline.targets(batch, &config, iteration)?;
    }
    baseline.check(iteration)?;
    optimiser.finish(&update)
}

impl<P: Policy> Persist for Ppo<P> {
    fn exchange(&mut self, with: &mut Exchange<'_>) -> Result<(), StateError> {
        with.vector("params", &mut self.optimiser.params)?;
        with.part("adam", &mut self.optimiser.adam)?;
        with.part("baseline", &mut self.baseline)
    }
}

#[cfg(test)]
mod tests;
