//! The learner: replay, critics, policy and their targets.

use std::sync::{Arc, Mutex, PoisonError};

use hwasp_algos::{Adam, AdamConfig, Exchange, LearnError, Learner, Metrics, Persist, StateError, group_rates};
use hwasp_core::{Batch, Executor, Policy, Purpose, Stream, share_left, stream};

use crate::config::ReplayConfig;
use crate::critic::{Critics, follow};
use crate::replay::{Dims, Replay};
use crate::rule::Rule;
use crate::sample::{Sample, View};
use crate::scaling::Scaling;
use crate::watch::Watch;
use crate::worker::{Step, Worker};

/// Rows of a gradient step that are a job of their own.
const ROWS_PER_JOB: usize = 128;

/// A learner that lives on old experience, with the mechanism in the policy: the critics judge what the mechanism does to the
/// world, and their gradient reaches the design through its law. What is in the replay stays true whatever the design becomes.
///
/// | metric | meaning |
/// |---|---|
/// | `td_error` | root mean square of the first critic's errors over the update, in units of the return |
/// | `value` | mean value of the policy's actions in the states of the replay |
/// | `updates` | gradient steps of the critics in this iteration |
/// | `replay_steps` | steps in the replay |
/// | `command_entropy` | of SAC: mean entropy of a step's commands, in nats of densities over [-1, 1] |
/// | `temperature` | of SAC: what a nat is worth, in units of the return |
#[allow(private_bounds)] // what tells one from another is nobody else's
pub struct OffPolicy<P: Policy, R: Rule<P>> {
    pub(crate) policy: Arc<P>,
    pub(crate) seed: u64,
    /// Times the learning rate, of design parameters.
    pub(crate) design_lr_scale: f64,
    view: View,
    pub(crate) limits: Vec<Option<(f32, f32)>>,
    pub(crate) learned: Learned<R>,
    pub(crate) replay: Replay,
    /// Working memory.
    pub(crate) sample: Sample,
    workers: Vec<Mutex<Worker<P>>>,
    gradient: Vec<f32>,
    critic_gradient: Vec<f32>,
}

/// All that gradient steps change.
#[derive(Clone, Debug)]
pub(crate) struct Learned<R> {
    rule: R,
    pub(crate) params: Vec<f32>,
    /// Those of the policy's slow copy; none where there is no such copy.
    slow: Vec<f32>,
    adam: Adam,
    critics: Critics,
    scaling: Scaling,
    pub(crate) watch: Watch,
    /// Gradient steps that the steps of the simulator have earned and that were not taken.
    owed: f64,
    /// Gradient steps of the critics so far.
    pub(crate) updates: u64,
}

impl<R: Persist> Persist for Learned<R> {
    fn exchange(&mut self, with: &mut Exchange<'_>) -> Result<(), StateError> {
        with.vector("params", &mut self.params)?;
        with.vector("target", &mut self.slow)?;
        with.part("adam", &mut self.adam)?;
        with.part("critics", &mut self.critics)?;
        with.part("scaling", &mut self.scaling)?;
        with.part("rule", &mut self.rule)?;
        with.part("watch", &mut self.watch)?;
        with.number("owed", &mut self.owed)?;
        with.number("updates", &mut self.updates)
    }
}

/// Sums over the gradient steps of an update.
#[derive(Clone, Copy, Debug, Default)]
struct Sums {
    squares: f64,
    values: f64,
    log_probs: f64,
    steps: u64,
    policy_steps: u64,
}

/// What schedules say of one update.
struct Rates {
    policy: Vec<f32>,
    critic: Vec<f32>,
    /// The share of all schedules that is done.
    progress: f64,
}

#[allow(private_bounds)]
impl<P: Policy, R: Rule<P>> OffPolicy<P, R> {
    /// Starts from `params`. `seed` names the streams of critics and replay; design parameters learn `design_lr_scale` times as
    /// fast as the controller.
    pub fn new(rule: R, policy: Arc<P>, params: Vec<f32>, seed: u64, design_lr_scale: f64) -> Self {
        let dims = Dims::of(&*policy);
        let settings = rule.replay();
        let view = View::new(dims, settings.privileged, settings.context);
        let critics = Critics::new(view.width(), &settings.critic_hidden, settings.critic_layer_norm, seed);
        let scaling = Scaling::new(dims);
        let rows = settings.batch_rows;
        let part = |at: usize| at..(at + ROWS_PER_JOB).min(rows);
        let worker = |at| Mutex::new(Worker::new::<R>(part(at), &*policy, &critics, view));
        Self {
            workers: (0..rows).step_by(ROWS_PER_JOB).map(worker).collect(),
            sample: Sample::new(dims, rows, R::drawn(&policy), rule.smoothing(&scaling, 0.0).len()),
            gradient: vec![0.0; params.len()],
            critic_gradient: vec![0.0; critics.network.param_count()],
            replay: Replay::new(dims, settings.replay_frames),
            limits: policy.action_limits(),
            learned: Learned {
                rule,
                slow: if R::SLOW_POLICY { params.clone() } else { Vec::new() },
                adam: Adam::new(AdamConfig::default(), params.len()),
                params,
                critics,
                scaling,
                watch: Watch::default(),
                owed: 0.0,
                updates: 0,
            },
            policy,
            seed,
            design_lr_scale,
            view,
        }
    }

    pub(crate) fn settings(&self) -> &ReplayConfig {
        self.learned.rule.replay()
    }

    fn rates(&self, progress: f64) -> Rates {
        let settings = self.settings();
        let decay = share_left(settings.learning_rate_final, progress);
        let (policy, count) = (settings.learning_rate * decay, self.learned.params.len());
        let still = progress < settings.design_start || settings.design_search > 0;
        let design = if still { 0.0 } else { self.design_lr_scale };
        let critic = (settings.critic_learning_rate * decay) as f32;
        let mut policy = group_rates(self.policy.groups(), count, policy, design, 0.0);
        if settings.design_returns > 0 {
            self.policy.drawn_params().into_iter().for_each(|u| policy[u] = 0.0);
        }
        Rates { policy, critic: vec![critic; self.critic_gradient.len()], progress }
    }

    /// All gradient steps that are owed.
    fn learn(&mut self, executor: &dyn Executor, rates: &Rates, iteration: u64) -> Result<Sums, LearnError> {
        let not_finite = |what| LearnError::NotFinite { what, iteration };
        if !self.learned.scaling.taken {
            let policy = (&*self.policy, &self.learned.params[..]);
            self.learned.scaling = Scaling::of(&self.replay, policy, self.settings());
        }
        let smoothing = self.learned.rule.smoothing(&self.learned.scaling, rates.progress);
        let mut chance = stream(self.seed, Purpose::Replay, iteration, 0);
        let mut sums = Sums::default();
        while self.learned.owed >= 1.0 {
            self.learned.owed -= 1.0;
            self.step(executor, rates, &smoothing, &mut chance, &mut sums);
            if !sums.squares.is_finite() {
                return Err(not_finite("a critic's error"));
            }
        }
        let learned = &self.learned;
        if !learned.params.iter().all(|p| p.is_finite()) {
            return Err(not_finite("a parameter"));
        }
        if !learned.critics.each.iter().flat_map(|critic| &critic.params).all(|p| p.is_finite()) {
            return Err(not_finite("a parameter of a critic"));
        }
        Ok(sums)
    }

    /// A gradient step of the critics and, where it is its turn, of the policy; targets follow it (Fujimoto et al. 2018,
    /// algorithm 1).
    fn step(
        &mut self,
        executor: &dyn Executor,
        rates: &Rates,
        smoothing: &[(f32, f32)],
        chance: &mut Stream,
        sums: &mut Sums,
    ) {
        let settings = self.learned.rule.replay();
        let (rows, tau, delay) = (settings.batch_rows, settings.polyak, settings.policy_delay as u64);
        let value = self.learned.scaling.value;
        self.sample.draw(&self.replay, (settings.n_step, settings.discount), value, chance);
        let learned = &self.learned;
        let next = if R::SLOW_POLICY { &learned.slow } else { &learned.params };
        self.sample.show_design(&*self.policy, &learned.params, next);
        self.run(executor, smoothing, Worker::judge);
        self.descend_critics(&rates.critic);
        sums.squares += self.sum(|worker| worker.squares) / rows as f64;
        sums.steps += 1;
        self.learned.updates += 1;
        if self.learned.updates.is_multiple_of(delay) {
            self.run(executor, smoothing, Worker::improve);
            self.descend_policy(&rates.policy);
            sums.values += self.sum(|worker| worker.values) / rows as f64;
            let log_prob = self.sum(|worker| worker.log_probs) / rows as f64;
            sums.log_probs += log_prob;
            sums.policy_steps += 1;
            let learned = &mut self.learned;
            learned.rule.settle(log_prob, rates.progress);
            follow(&mut learned.slow, &learned.params, tau);
            for critic in &mut learned.critics.each {
                follow(&mut critic.target, &critic.params, tau);
            }
        }
    }

    /// Every worker does this once, on any thread.
    pub(crate) fn run(
        &self,
        executor: &dyn Executor,
        smoothing: &[(f32, f32)],
        act: impl Fn(&mut Worker<P>, &Step<'_, P, R>) + Sync,
    ) {
        let step = Step {
            rule: &self.learned.rule,
            policy: &*self.policy,
            params: &self.learned.params,
            slow: &self.learned.slow,
            critics: &self.learned.critics,
            version: self.learned.updates,
            sample: &self.sample,
            scaling: &self.learned.scaling,
            view: self.view,
            limits: &self.limits,
            rows: self.settings().batch_rows,
            smoothing,
        };
        executor.for_each(self.workers.len(), &|i| {
            act(&mut self.workers[i].lock().unwrap_or_else(PoisonError::into_inner), &step);
        });
    }

    /// The workers' parameters are not those at hand any more.
    fn forget(&mut self) {
        for worker in &mut self.workers {
            worker.get_mut().unwrap_or_else(PoisonError::into_inner).forget();
        }
    }

    /// A sum over the workers, in their order.
    pub(crate) fn sum(&mut self, of: impl Fn(&Worker<P>) -> f64) -> f64 {
        self.workers.iter_mut().map(|worker| of(worker.get_mut().unwrap_or_else(PoisonError::into_inner))).sum()
    }

    fn descend_critics(&mut self, rates: &[f32]) {
        let Learned { critics, .. } = &mut self.learned;
        for (i, critic) in critics.each.iter_mut().enumerate() {
            self.critic_gradient.fill(0.0);
            for worker in &mut self.workers {
                let worker = worker.get_mut().unwrap_or_else(PoisonError::into_inner);
                critics.network.gradient(&worker.critics[i], &mut self.critic_gradient);
            }
            critic.adam.step(&mut critic.params, &self.critic_gradient, rates);
        }
    }

    fn descend_policy(&mut self, rates: &[f32]) {
        let mut workers =
            self.workers.iter_mut().map(|worker| worker.get_mut().unwrap_or_else(PoisonError::into_inner));
        let Some(first) = workers.next() else { return };
        for other in workers {
            first.add_policy(&self.policy, other);
        }
        first.policy_gradient(&self.policy, &mut self.gradient);
        self.learned.adam.step(&mut self.learned.params, &self.gradient, rates);
    }
}

impl<P: Policy, R: Rule<P>> Learner for OffPolicy<P, R> {
    fn params(&self) -> &[f32] {
        &self.learned.params
    }

    fn metric_names(&self) -> &'static [&'static str] {
        R::METRICS
    }

    fn update(
        &mut self,
        executor: &dyn Executor,
        batch: &Batch,
        progress: f64,
        iteration: u64,
    ) -> Result<Metrics, LearnError> {
        let before = self.learned.clone();
        let undo = self.replay.push(batch, &self.limits);
        let mut sums = Sums::default();
        if self.learned.updates > 0 || self.replay.steps() >= self.settings().warmup_steps {
            self.learned.owed += batch.rows() as f64 * self.settings().updates_per_step;
            let rates = self.rates(progress);
            match self.learn(executor, &rates, iteration) {
                Ok(done) => sums = done,
                Err(error) => {
                    self.learned = before;
                    self.replay.take_back(&undo);
                    self.forget();
                    return Err(error);
                }
            }
        }
        self.attend_design(executor, batch, progress, iteration);
        let (center, scale) = self.learned.scaling.value;
        let mean = |sum: f64, count: u64| sum / count.max(1) as f64;
        let td_error = scale * mean(sums.squares, sums.steps).sqrt();
        let value = center + scale * mean(sums.values, sums.policy_steps);
        let mut told = vec![td_error, value, sums.steps as f64, self.replay.steps() as f64];
        told.extend(self.learned.rule.tell(mean(sums.log_probs, sums.policy_steps), scale));
        Ok(Metrics::new(R::METRICS, told))
    }
}

impl<P: Policy, R: Rule<P>> Persist for OffPolicy<P, R> {
    fn exchange(&mut self, with: &mut Exchange<'_>) -> Result<(), StateError> {
        if with.loads() {
            self.forget();
        }
        with.part("learned", &mut self.learned)?;
        with.part("replay", &mut self.replay)
    }
}
