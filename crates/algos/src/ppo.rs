//! Proximal policy optimisation (Schulman et al. 2017).

use std::sync::Arc;

use hwasp_core::{Batch, Executor, Policy, Purpose, gaussian, stream};
use rand::seq::SliceRandom;
use serde::{Deserialize, Serialize};

use crate::adam::{Adam, AdamConfig, clip_norm};
use crate::archive::{Exchange, Persist, StateError};
use crate::baseline::{Baseline, BaselineConfig};
use crate::gae::AdvantageConfig;
use crate::learner::{LearnError, Learner, UpdateMetrics};
use crate::minibatch::{BLOCK, Minibatch};
use crate::surrogate::Surrogate;

/// Settings of [`Ppo`].
///
/// | name | default | purpose |
/// |---|---|---|
/// | `discount` | 0.99 | γ |
/// | `gae_lambda` | 0.95 | λ of the advantages |
/// | `clip_ratio` | 0.2 | ε of the clipped surrogate |
/// | `epochs` | 4 | passes over a batch |
/// | `minibatch_rows` | 1000 | rows of a gradient step; 0 for the whole batch |
/// | `learning_rate` | 1e-3 | of Adam |
/// | `learning_rate_final` | 1 | fraction of it left at the end of a linear decay |
/// | `design_lr_scale` | 1 | times the rate, for design parameters |
/// | `log_std_lr_scale` | 1 | times the rate, for log standard deviations |
/// | `entropy_coef` | 0 | weight of the entropy in the objective |
/// | `max_grad_norm` | 0.5 | longest gradient |
/// | `target_kl` | none | epochs end when the KL divergence passes 1.5 times this |
/// | `normalize_advantages` | true | mean 0, variance 1 over the batch |
/// | `bootstrap_truncated` | true | value the state after a truncated episode; the paper's toolkit does not |
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
    /// Rows of a gradient step; 0 for the whole batch.
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
    /// Epochs end when the KL divergence passes 1.5 times this.
    pub target_kl: Option<f64>,
    /// Whether advantages are centred and scaled over the batch.
    pub normalize_advantages: bool,
    /// Whether the state after a truncated episode is valued.
    pub bootstrap_truncated: bool,
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

/// The learner: a policy's parameters, their optimiser and a baseline.
pub struct Ppo<P: Policy> {
    actor: Actor<P>,
    baseline: Baseline,
}

/// What improves the policy. It knows of the baseline no more than the advantages.
struct Actor<P: Policy> {
    config: PpoConfig,
    policy: Arc<P>,
    params: Vec<f32>,
    adam: Adam,
    seed: u64,
    /// Working memory.
    step: GradientStep<P>,
}

/// Everything one gradient step writes, allocated once.
struct GradientStep<P: Policy> {
    tape: P::Tape,
    minibatch: Minibatch,
    cotangent: Vec<f32>,
    log_std: Vec<f32>,
    log_std_gradient: Vec<f32>,
    gradient: Vec<f32>,
}

/// Sums over the rows of one gradient step.
#[derive(Clone, Copy, Debug, Default)]
struct Totals {
    kl: f64,
    clipped: f64,
    rows: usize,
}

impl<P: Policy> Ppo<P> {
    /// Starts from `params`. `seed` names the streams of minibatches and of the baseline.
    pub fn new(settings: &PpoSettings, policy: Arc<P>, params: Vec<f32>, seed: u64) -> Self {
        let config = settings.ppo.clone();
        let actions = policy.action_dim();
        let step = GradientStep {
            tape: policy.tape(BLOCK),
            minibatch: Minibatch::default(),
            cotangent: vec![0.0; actions * BLOCK],
            log_std: vec![0.0; actions],
            log_std_gradient: vec![0.0; actions],
            gradient: vec![0.0; params.len()],
        };
        let adam = Adam::new(AdamConfig { epsilon: config.adam_epsilon, ..AdamConfig::default() }, params.len());
        let baseline = Baseline::new(&settings.baseline, policy.obs_dim(), policy.state_dim(), seed);
        Self { actor: Actor { config, policy, params, adam, seed, step }, baseline }
    }
}

impl<P: Policy> Actor<P> {
    /// Learning rates of all parameters at `progress` of training.
    fn learning_rates(&self, progress: f64) -> Vec<f32> {
        let config = &self.config;
        let rate = config.learning_rate * (1.0 + (config.learning_rate_final - 1.0) * progress);
        let mut rates = vec![rate as f32; self.params.len()];
        for group in self.policy.groups() {
            let scale = match group.name {
                "design" => config.design_lr_scale,
                "log_std" => config.log_std_lr_scale,
                _ => 1.0,
            };
            rates[group.range.clone()].fill((rate * scale) as f32);
        }
        rates
    }

    fn dims(&self) -> (usize, usize, usize) {
        (self.policy.obs_dim(), self.policy.state_dim(), self.policy.action_dim())
    }

    /// One update; leaves the parameters changed even where it fails.
    fn update(
        &mut self,
        batch: &Batch,
        advantage: &[f32],
        progress: f64,
        iteration: u64,
    ) -> Result<UpdateMetrics, LearnError> {
        let metrics = self.optimise(batch, advantage, progress, iteration)?;
        let sound = self.params.iter().all(|p| p.is_finite());
        sound.then_some(metrics).ok_or(LearnError::NotFinite { what: "a parameter", iteration })
    }

    /// The epochs of one update.
    fn optimise(
        &mut self,
        batch: &Batch,
        advantage: &[f32],
        progress: f64,
        iteration: u64,
    ) -> Result<UpdateMetrics, LearnError> {
        let rates = self.learning_rates(progress);
        let rows = batch.rows();
        let whole = self.config.minibatch_rows == 0 || self.config.minibatch_rows >= rows;
        let size = if whole { rows } else { self.config.minibatch_rows };
        let mut order: Vec<u32> = (0..rows as u32).collect();
        let mut shuffle = stream(self.seed, Purpose::Minibatches, iteration, 0);
        let mut metrics = UpdateMetrics::default();
        let mut steps = 0;
        for epoch in 0..self.config.epochs {
            if !whole {
                order.shuffle(&mut shuffle);
            }
            let mut epoch_totals = Totals::default();
            for indices in order.chunks(size.max(1)) {
                // The whole batch in its own order needs gathering but once.
                if !whole || epoch == 0 {
                    let dims = self.dims();
                    self.step.minibatch.gather(batch, advantage, indices, dims);
                }
                let totals = self.step.run(&*self.policy, &self.params, &self.config, progress);
                metrics.grad_norm += clip_norm(&mut self.step.gradient, self.config.max_grad_norm);
                steps += 1;
                if !metrics.grad_norm.is_finite() {
                    return Err(LearnError::NotFinite { what: "the policy gradient", iteration });
                }
                self.adam.step(&mut self.params, &self.step.gradient, &rates);
                epoch_totals.kl += totals.kl;
                epoch_totals.clipped += totals.clipped;
                epoch_totals.rows += totals.rows;
            }
            let n = epoch_totals.rows.max(1) as f64;
            metrics.kl = epoch_totals.kl / n;
            metrics.clip_fraction = epoch_totals.clipped / n;
            metrics.epochs = epoch + 1;
            if self.config.target_kl.is_some_and(|limit| metrics.kl > 1.5 * limit) {
                break;
            }
        }
        metrics.grad_norm /= f64::from(steps).max(1.0);
        self.policy.log_std(&self.params, progress, &mut self.step.log_std);
        metrics.entropy = gaussian::entropy(&self.step.log_std);
        Ok(metrics)
    }
}

impl<P: Policy> Learner for Ppo<P> {
    fn params(&self) -> &[f32] {
        &self.actor.params
    }

    fn update(
        &mut self,
        executor: &dyn Executor,
        batch: &Batch,
        progress: f64,
        iteration: u64,
    ) -> Result<UpdateMetrics, LearnError> {
        let Self { actor, baseline } = self;
        let targets = baseline.targets(batch, &actor.config.advantages(), iteration)?;
        let unsound = |_| LearnError::NotFinite { what: "a parameter of the baseline", iteration };
        let before = (actor.params.clone(), actor.adam.clone(), baseline.save().map_err(unsound)?);
        // Neither reads what the other writes, so they may run at once.
        let (mut updated, mut fitted) = (Ok(UpdateMetrics::default()), Ok(()));
        executor.both(&mut || updated = actor.update(batch, &targets.advantage, progress, iteration), &mut || {
            fitted = baseline.fit(batch, &targets, progress, iteration);
        });
        let result = updated.and_then(|metrics| fitted.map(|()| metrics));
        if result.is_err() {
            (actor.params, actor.adam) = (before.0, before.1);
            baseline.load(&before.2).map_err(unsound)?;
        }
        result
    }
}

impl<P: Policy> Persist for Ppo<P> {
    fn exchange(&mut self, with: &mut Exchange<'_>) -> Result<(), StateError> {
        with.vector("params", &mut self.actor.params)?;
        with.part("adam", &mut self.actor.adam)?;
        with.part("baseline", &mut self.baseline)
    }
}

impl<P: Policy> GradientStep<P> {
    /// The gradient of the loss over the minibatch, left in `gradient`:
    /// -mean[min(ρ·A, clip(ρ, 1±ε)·A)] - c·H (eqs. 7 and 9, without a value term).
    fn run(&mut self, policy: &P, params: &[f32], config: &PpoConfig, progress: f64) -> Totals {
        policy.bind(params, &mut self.tape);
        policy.log_std(params, progress, &mut self.log_std);
        self.log_std_gradient.fill(0.0);
        let mut totals = Totals { rows: self.minibatch.count, ..Totals::default() };
        for block in self.minibatch.blocks() {
            let rows = self.minibatch.rows(&block);
            let mean = policy.forward(&rows, &mut self.tape);
            let surrogate = Surrogate {
                minibatch: &self.minibatch,
                block,
                mean,
                log_std: &self.log_std,
                clip_ratio: config.clip_ratio as f32,
            };
            let (kl, clipped) = surrogate.differentiate(&mut self.cotangent, &mut self.log_std_gradient);
            totals.kl += kl;
            totals.clipped += clipped;
            policy.vjp(&rows, &self.cotangent, &mut self.tape);
        }
        policy.gradient(&mut self.tape, &mut self.gradient);
        if let Some(range) = policy.log_std_params() {
            for (to, from) in self.gradient[range].iter_mut().zip(&self.log_std_gradient) {
                // The entropy of a Gaussian grows by one nat per unit of log-std.
                *to = from - config.entropy_coef as f32;
            }
        }
        totals
    }
}

#[cfg(test)]
mod tests;
