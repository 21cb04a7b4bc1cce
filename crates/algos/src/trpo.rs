//! Trust region policy optimisation (Schulman et al. 2015, "Trust Region Policy Optimization", arXiv:1502.05477). Numbers
//! in brackets are its equations; appendix C is the step.

mod cg;
mod config;
mod fisher;
mod line_search;
mod passes;
#[cfg(test)]
mod tests;

use std::sync::Arc;

use hwasp_core::{Batch, Executor, ParamKind, Policy, Purpose, gaussian, stream};

pub use self::cg::{Solution, conjugate_gradient};
pub use self::config::{FisherRows, TrpoConfig, TrpoSettings};
use self::fisher::Fisher;
use self::line_search::backtrack;
use self::passes::Passes;
use crate::archive::{Exchange, Persist, StateError};
use crate::baseline::{Baseline, InputDims};
use crate::draws::Draws;
use crate::gae::Foresight;
use crate::learner::{LearnError, Learner};
use crate::metrics::Metrics;
use crate::minibatch::Minibatch;

/// Keeps the length of a step finite where nothing curves, as the paper's toolkit has it.
const LEAST_CURVATURE: f64 = 1e-8;

/// What an update of [`Trpo`] tells of a policy that draws a part of the design once an episode.
const DRAW_METRICS: &[&str] = &[
    "kl",
    "entropy",
    "step_fraction",
    "gain",
    "cg_iterations",
    "tried",
    "rejected",
    "value_loss",
    "explained_variance",
    "design_kl",
];
/// The same of other policies, which have no draws to tell of.
const METRICS: &[&str] = DRAW_METRICS.split_at(9).0;

/// What an update of this policy tells.
fn metric_names(policy: &impl Policy) -> &'static [&'static str] {
    if policy.drawn_actions() == 0 { METRICS } else { DRAW_METRICS }
}

/// The learner: a policy's parameters and a baseline.
///
/// An update is one step: minimise -mean(ρ·A) under mean KL(old || new) ≤ `max_kl` (14). Its direction is H⁻¹g with g the
/// gradient of the objective and H the curvature of the divergence, its length √(2·`max_kl`/xᵀHx), shortened until it
/// holds what it promises. What is drawn once an episode counts once an episode in objective, divergence and
/// curvature: each is the sum over steps and draws, divided by the number of steps.
///
/// | metric | meaning |
/// |---|---|
/// | `kl` | KL divergence from the policy that acted, nats: exact, over all rows, after the update |
/// | `entropy` | entropy of the action distribution after the update, nats |
/// | `step_fraction` | share of the full step that was taken; 0 where none was |
/// | `gain` | what the step gained in the surrogate objective, the mean of ρ·A |
/// | `cg_iterations` | iterations of conjugate gradients |
/// | `tried` | steps that the line search tried |
/// | `rejected` | updates so far that took no step |
/// | `value_loss` | mean square of the error of the values that the advantages come from, before they learn: reward², of the rewards that the learner sees |
/// | `explained_variance` | the share of the variance of what they learn that these values account for: 1 at best, 0 for values that know the mean alone |
/// | `design_kl` | KL divergence of what is drawn once an episode, nats; only where something is |
pub struct Trpo<P: Policy> {
    region: TrustRegion<P>,
    baseline: Baseline,
}

/// A policy's parameters and what moves them.
struct TrustRegion<P: Policy> {
    config: TrpoConfig,
    policy: Arc<P>,
    params: Vec<f32>,
    seed: u64,
    /// The unit of each parameter in the equations of a step.
    unit: Vec<f64>,
    /// Updates so far that took no step.
    rejected: u64,
    /// Working memory.
    passes: Passes<P>,
    batch: Minibatch,
    curvature: Minibatch,
    candidate: Vec<f32>,
    gradient: Vec<f64>,
}

impl<P: Policy> Trpo<P> {
    /// Starts from `params`. `seed` names the streams of the curvature's rows and of the baseline.
    pub fn new(settings: &TrpoSettings, policy: Arc<P>, params: Vec<f32>, seed: u64) -> Self {
        let baseline = Baseline::new(&settings.baseline, InputDims::of(&*policy), seed);
        Self { region: TrustRegion::new(settings.trpo.clone(), policy, params, seed), baseline }
    }
}

impl<P: Policy> TrustRegion<P> {
    fn new(config: TrpoConfig, policy: Arc<P>, params: Vec<f32>, seed: u64) -> Self {
        let mut unit = vec![1.0; params.len()];
        for group in policy.groups().iter().filter(|group| group.kind == ParamKind::Design) {
            unit[group.range.clone()].fill(config.design_scale);
        }
        Self {
            config,
            passes: Passes::new(Arc::clone(&policy)),
            batch: Minibatch::default(),
            curvature: Minibatch::default(),
            candidate: params.clone(),
            gradient: vec![0.0; params.len()],
            policy,
            params,
            seed,
            unit,
            rejected: 0,
        }
    }

    /// Gathers the batch, and the rows that its curvature is taken of.
    fn gather(&mut self, batch: &Batch, (advantage, draws): (&[f32], &Draws), iteration: u64) {
        let dims = (self.policy.obs_dim(), self.policy.state_dim(), self.policy.action_dim());
        let all: Vec<u32> = (0..batch.rows() as u32).collect();
        self.batch.gather(batch, advantage, &all, dims);
        self.batch.draws.gather(draws, &all);
        if self.config.fisher_rows.count(all.len()) < all.len() {
            let mut numbers = stream(self.seed, Purpose::Minibatches, iteration, 0);
            let some = self.config.fisher_rows.pick(all.len(), &mut numbers);
            self.curvature.gather(batch, advantage, &some, dims);
            self.curvature.draws.gather(draws, &some);
        }
    }

    /// One step from the gathered batch, left in `candidate`; where none is found that is the present parameters.
    /// The values that the advantages came from have this foresight.
    fn step(
        &mut self,
        executor: &dyn Executor,
        foresight: Foresight,
        progress: f64,
        iteration: u64,
    ) -> Result<Metrics, LearnError> {
        let not_finite = |what| LearnError::NotFinite { what, iteration };
        let rows = self.batch.count;
        let curvature = if self.config.fisher_rows.count(rows) < rows { &self.curvature } else { &self.batch };
        let start = self.passes.gradient(executor, &self.batch, &self.params, progress, &mut self.gradient);
        let norm = self.gradient.iter().map(|g| g * g).sum::<f64>().sqrt();
        if !(start.is_finite() && norm.is_finite()) {
            return Err(not_finite("the policy gradient"));
        }
        let fisher = Fisher::new(&self.passes, curvature, &self.params, progress);
        // In units of the parameters: gradient D·g, curvature D·H·D, and the way back D·x.
        let scaled = |v: &[f64]| v.iter().zip(&self.unit).map(|(v, unit)| v * unit).collect::<Vec<_>>();
        let gradient = scaled(&self.gradient);
        let solution =
            conjugate_gradient(&gradient, self.config.cg_iterations, self.config.cg_tolerance, |v, product| {
                fisher.product(executor, &scaled(v), product);
                for ((to, unit), v) in product.iter_mut().zip(&self.unit).zip(v) {
                    *to = *to * unit + self.config.damping * v;
                }
            });
        // xᵀHx with Hx = g - r.
        let terms = gradient.iter().zip(&solution.residual).zip(&solution.x);
        let curved: f64 = terms.map(|((g, r), x)| x * (g - r)).sum();
        let max_kl = self.config.max_kl_at(progress);
        let length = (2.0 * max_kl / (curved + LEAST_CURVATURE)).sqrt();
        if !length.is_finite() || solution.x.iter().any(|x| !x.is_finite()) {
            return Err(not_finite("the step"));
        }
        let direction = scaled(&solution.x);
        let (params, candidate, passes, batch) = (&self.params, &mut self.candidate, &self.passes, &self.batch);
        let mut design_kl = 0.0;
        let found = backtrack(start, max_kl, &self.config, |fraction| {
            for ((to, from), x) in candidate.iter_mut().zip(params).zip(&direction) {
                *to = (f64::from(*from) - fraction * length * x) as f32;
            }
            let found = passes.evaluate(executor, batch, (params, candidate), progress);
            design_kl = found.draw_kl;
            (found.loss, found.kl)
        });
        if found.fraction == 0.0 {
            self.candidate.copy_from_slice(&self.params);
            self.rejected += 1;
            design_kl = 0.0;
        }
        let mut log_std = vec![0.0; self.policy.action_dim()];
        self.policy.log_std(&self.candidate, progress, &mut log_std);
        let names = metric_names(&*self.policy);
        let values = [
            found.kl,
            gaussian::entropy(&log_std),
            found.fraction,
            start - found.loss,
            solution.iterations as f64,
            found.tried as f64,
            self.rejected as f64,
            foresight.value_loss,
            foresight.explained_variance,
            design_kl,
        ];
        Ok(Metrics::new(names, values[..names.len()].to_vec()))
    }
}

impl<P: Policy> Learner for Trpo<P> {
    fn params(&self) -> &[f32] {
        &self.region.params
    }

    fn metric_names(&self) -> &'static [&'static str] {
        metric_names(&*self.region.policy)
    }

    fn update(
        &mut self,
        executor: &dyn Executor,
        batch: &Batch,
        progress: f64,
        iteration: u64,
    ) -> Result<Metrics, LearnError> {
        let Self { region, baseline } = self;
        let targets = baseline.targets(batch, &region.config.advantages, iteration)?;
        let draws = Draws::new(&*region.policy, batch, &targets, &region.config.advantages);
        let metrics = baseline.fit_beside(executor, (batch, &targets), (progress, iteration), || {
            region.gather(batch, (&targets.advantage, &draws), iteration);
            region.step(executor, targets.foresight, progress, iteration)
        })?;
        region.params.copy_from_slice(&region.candidate);
        Ok(metrics)
    }
}

impl<P: Policy> Persist for Trpo<P> {
    fn exchange(&mut self, with: &mut Exchange<'_>) -> Result<(), StateError> {
        with.vector("params", &mut self.region.params)?;
        with.part("baseline", &mut self.baseline)?;
        with.number("rejected", &mut self.region.rejected)
    }
}
