//! What moves a policy: minibatches, gradients of the clipped surrogate, Adam.

use std::sync::Arc;

use hwasp_core::{Batch, Policy, Purpose, Stream, gaussian, share_left, stream};
use rand::seq::SliceRandom;

use super::{PpoConfig, metric_names};
use crate::adam::{Adam, AdamConfig, clip_norm, group_rates};
use crate::draws::Draws;
use crate::gae::{Advantages, Foresight};
use crate::learner::LearnError;
use crate::metrics::Metrics;
use crate::minibatch::{BLOCK, Minibatch, minibatches};
use crate::surrogate::{RatioSums, Surrogate};

/// A policy's parameters and their optimiser.
pub(super) struct Optimiser<P: Policy> {
    pub(super) config: PpoConfig,
    pub(super) policy: Arc<P>,
    pub(super) params: Vec<f32>,
    pub(super) adam: Adam,
    seed: u64,
    /// Working memory.
    pub(super) step: GradientStep<P>,
}

/// Everything one gradient step writes, allocated once.
pub(super) struct GradientStep<P: Policy> {
    tape: P::Tape,
    pub(super) minibatch: Minibatch,
    pub(super) cotangent: Vec<f32>,
    log_std: Vec<f32>,
    log_std_gradient: Vec<f32>,
    pub(super) gradient: Vec<f32>,
}

/// An update on its way, from epoch to epoch.
pub(super) struct Update {
    progress: f64,
    iteration: u64,
    /// Learning rates of all parameters.
    rates: Vec<f32>,
    /// Whether a gradient step takes the whole batch.
    whole: bool,
    order: Vec<u32>,
    shuffle: Stream,
    /// Of the last epoch.
    kl: f64,
    clip_fraction: f64,
    of_draws: RatioSums,
    /// Sum of the gradients' norms, and gradient steps.
    norms: f64,
    steps: u32,
    epochs: usize,
    /// Of the values that its advantages began with.
    foresight: Foresight,
}

/// Sums over the rows of one gradient step.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct RowSums {
    pub(super) kl: f64,
    pub(super) clipped: f64,
    pub(super) rows: usize,
    /// Of the rows' shares of draws, and how many draws these are together.
    pub(super) draws: RatioSums,
    pub(super) drawn: f64,
}

impl RowSums {
    fn add(&mut self, other: Self) {
        self.kl += other.kl;
        self.clipped += other.clipped;
        self.rows += other.rows;
        self.draws.kl += other.draws.kl;
        self.draws.clipped += other.draws.clipped;
        self.drawn += other.drawn;
    }
}

impl<P: Policy> Optimiser<P> {
    /// Starts from `params`. `seed` names the streams of minibatches.
    pub(super) fn new(config: PpoConfig, policy: Arc<P>, params: Vec<f32>, seed: u64) -> Self {
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
        Self { config, policy, params, adam, seed, step }
    }

    /// Learning rates of all parameters at `progress` of training.
    fn learning_rates(&self, progress: f64) -> Vec<f32> {
        let config = &self.config;
        let rate = config.learning_rate * share_left(config.learning_rate_final, progress);
        group_rates(self.policy.groups(), self.params.len(), rate, config.design_lr_scale, config.log_std_lr_scale)
    }

    fn dims(&self) -> (usize, usize, usize) {
        (self.policy.obs_dim(), self.policy.state_dim(), self.policy.action_dim())
    }

    /// The epochs of one update; leaves the parameters changed even where it fails.
    pub(super) fn update(
        &mut self,
        batch: &Batch,
        (targets, draws): (&Advantages, &Draws),
        progress: f64,
        iteration: u64,
    ) -> Result<Metrics, LearnError> {
        let mut update = self.begin(batch.rows(), targets.foresight, progress, iteration);
        while self.epoch(&mut update, batch, (&targets.advantage, draws))? {}
        self.finish(&update)
    }

    /// An update from a batch of so many rows, before its first epoch.
    pub(super) fn begin(&self, rows: usize, foresight: Foresight, progress: f64, iteration: u64) -> Update {
        let size = self.config.minibatch_rows;
        Update {
            progress,
            iteration,
            rates: self.learning_rates(progress),
            whole: size == 0 || size >= rows,
            order: (0..rows as u32).collect(),
            shuffle: stream(self.seed, Purpose::Minibatches, iteration, 0),
            kl: 0.0,
            clip_fraction: 0.0,
            of_draws: RatioSums::default(),
            norms: 0.0,
            steps: 0,
            epochs: 0,
            foresight,
        }
    }

    /// An epoch; returns whether another one is to follow.
    pub(super) fn epoch(
        &mut self,
        update: &mut Update,
        batch: &Batch,
        (advantage, draws): (&[f32], &Draws),
    ) -> Result<bool, LearnError> {
        if !update.whole {
            update.order.shuffle(&mut update.shuffle);
        }
        // The whole batch in its own order needs gathering but once, unless its advantages change.
        let gather = !update.whole || update.epochs == 0 || self.config.recompute_advantages;
        let mut epoch_sums = RowSums::default();
        for indices in minibatches(&update.order, self.config.minibatch_rows) {
            if gather {
                let dims = self.dims();
                self.step.minibatch.gather(batch, advantage, indices, dims);
                self.step.minibatch.draws.gather(draws, indices);
            }
            let sums = self.step.run(&*self.policy, &self.params, &self.config, update.progress);
            update.norms += clip_norm(&mut self.step.gradient, self.config.max_grad_norm);
            update.steps += 1;
            if !update.norms.is_finite() {
                return Err(LearnError::NotFinite { what: "the policy gradient", iteration: update.iteration });
            }
            self.adam.step(&mut self.params, &self.step.gradient, &update.rates);
            epoch_sums.add(sums);
        }
        let n = epoch_sums.rows.max(1) as f64;
        (update.kl, update.clip_fraction) = (epoch_sums.kl / n, epoch_sums.clipped / n);
        if epoch_sums.drawn > 0.0 {
            let RatioSums { kl, clipped } = epoch_sums.draws;
            update.of_draws = RatioSums { kl: kl / epoch_sums.drawn, clipped: clipped / epoch_sums.drawn };
        }
        update.epochs += 1;
        let far = self.config.target_kl.is_some_and(|limit| update.kl.max(update.of_draws.kl) > 1.5 * limit);
        Ok(!far && update.epochs < self.config.epochs)
    }

    /// What an update has done, after its last epoch.
    pub(super) fn finish(&mut self, update: &Update) -> Result<Metrics, LearnError> {
        let Update { kl, clip_fraction, of_draws, norms, steps, epochs, foresight, .. } = *update;
        let grad_norm = norms / f64::from(steps).max(1.0);
        self.policy.log_std(&self.params, update.progress, &mut self.step.log_std);
        if !self.params.iter().all(|p| p.is_finite()) {
            return Err(LearnError::NotFinite { what: "a parameter", iteration: update.iteration });
        }
        let entropy = gaussian::entropy(&self.step.log_std);
        let names = metric_names(&*self.policy);
        let Foresight { value_loss, explained_variance } = foresight;
        let mut values = vec![kl, entropy, clip_fraction, grad_norm, epochs as f64, value_loss, explained_variance];
        values.extend([of_draws.kl, of_draws.clipped]);
        values.truncate(names.len());
        Ok(Metrics::new(names, values))
    }
}

impl<P: Policy> GradientStep<P> {
    /// The gradient of the loss over the minibatch, left in `gradient`:
    /// -mean[min(ρ·A, clip(ρ, 1±ε)·A)] - c·H (eqs. 7 and 9, without a value term). A draw has such a term and an entropy of its
    /// own, of which each row carries its [share](crate::draws).
    pub(super) fn run(&mut self, policy: &P, params: &[f32], config: &PpoConfig, progress: f64) -> RowSums {
        policy.bind(params, &mut self.tape);
        policy.log_std(params, progress, &mut self.log_std);
        self.log_std_gradient.fill(0.0);
        let (drawn, rows) = (policy.drawn_actions(), self.minibatch.count);
        let mut sums = RowSums { rows, drawn: self.minibatch.draws.count(), ..RowSums::default() };
        for block in self.minibatch.blocks() {
            let rows = self.minibatch.rows(&block);
            let mean = policy.forward(&rows, &mut self.tape);
            let surrogate = Surrogate {
                minibatch: &self.minibatch,
                block,
                mean,
                log_std: &self.log_std,
                drawn,
                clip_ratio: config.clip_ratio as f32,
            };
            let [steps, draws] = surrogate.differentiate(&mut self.cotangent, &mut self.log_std_gradient);
            sums.add(RowSums { kl: steps.kl, clipped: steps.clipped, draws, ..RowSums::default() });
            policy.vjp(&rows, &self.cotangent, &mut self.tape);
        }
        policy.gradient(&mut self.tape, &mut self.gradient);
        if let Some(range) = policy.log_std_params() {
            for (j, (to, from)) in self.gradient[range].iter_mut().zip(&self.log_std_gradient).enumerate() {
                // The entropy of a Gaussian grows by one nat per unit of log-std, and counts once in a row or once in a draw.
                let times = if j < drawn { sums.drawn / rows.max(1) as f64 } else { 1.0 };
                *to = from - (config.entropy_coef * times) as f32;
            }
        }
        sums
    }
}
