//! The training loop: jobs out, batches in, an update, an event.

use std::collections::VecDeque;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use hwasp_algos::{LearnError, SearchError, UpdateMetrics};
use hwasp_core::{Batch, EpisodeKind, Episodes, Executor, RolloutError, Sampler};
use thiserror::Error;

use crate::assemble::{AssembleError, Assembly};
use crate::evaluate::{EvaluateError, Evaluation, evaluate};
use crate::metrics::MetricsRow;
use crate::observer::{Event, Observer, ObserverError};
use crate::search::search;

/// Why a training ended early.
#[derive(Debug, Error)]
pub enum TrainError {
    /// An episode failed.
    #[error(transparent)]
    Rollout(#[from] RolloutError),
    /// An update failed.
    #[error(transparent)]
    Learn(#[from] LearnError),
    /// A search could not go on.
    #[error(transparent)]
    Search(#[from] SearchError),
    /// A candidate's own training cannot be put together.
    #[error(transparent)]
    Assemble(#[from] AssembleError),
    /// The evaluation failed.
    #[error(transparent)]
    Evaluate(#[from] EvaluateError),
    /// Someone who watched could not go on, the run folder for one.
    #[error(transparent)]
    Observer(#[from] ObserverError),
}

/// What a training gave.
#[derive(Clone, Debug)]
pub struct Trained {
    /// The policy's parameters.
    pub params: Vec<f32>,
    /// Iterations done; generations of a search.
    pub iterations: u64,
    /// Real simulator steps taken in training, those of every candidate and every training inside included.
    pub env_steps: u64,
    /// Time the training took, s, the evaluation apart.
    pub wall_s: f64,
    /// The mean discounted return of the training episodes over the last [`TRAILING`] iterations.
    pub training_discounted_return: f64,
    /// The same, undiscounted.
    pub training_return: f64,
    /// Candidates of a search that failed and ranked last; none where the method does not search.
    pub failed_candidates: Option<u64>,
    /// Episodes whose physics failed; their steps are charged, and nothing was learned from them.
    pub discarded_episodes: u64,
    /// The final design on held-out starts.
    pub evaluation: Evaluation,
    /// Whether it was stopped before its time.
    pub stopped: bool,
}

/// Iterations over which the final training return is averaged, as the paper's curves are.
pub const TRAILING: usize = 11;

/// Trains an experiment to the end of its budget, or until `stop` is set: then the iteration at hand is finished and what
/// there is gets evaluated.
pub fn train(
    assembly: &Assembly,
    executor: &dyn Executor,
    observer: &mut dyn Observer,
    stop: &AtomicBool,
) -> Result<Trained, TrainError> {
    let spec = assembly.spec();
    let totals = assembly.total_names();
    observer.on(Event::Started { env_steps: spec.train.env_steps, totals: &totals })?;
    let mut run = Loop { executor, observer, stop, began: Instant::now() };
    let learned = if spec.method.searches() { search(assembly, &mut run)? } else { gradient(assembly, &mut run)? };
    let wall_s = run.began.elapsed().as_secs_f64();
    observer.on(Event::Evaluating)?;
    let asked = (spec.train.evaluation_episodes as u64, spec.train.evaluation_seed);
    let evaluation = evaluate(assembly, &learned.params, asked, executor)?;
    observer.on(Event::Evaluated(&evaluation))?;
    let (training_discounted_return, training_return) = learned.trailing();
    Ok(Trained {
        iterations: learned.iterations,
        env_steps: learned.env_steps,
        wall_s,
        training_discounted_return,
        training_return,
        failed_candidates: spec.method.searches().then_some(learned.failed_candidates),
        discarded_episodes: learned.discarded_episodes,
        evaluation,
        stopped: stop.load(Ordering::Relaxed) && learned.env_steps < spec.train.env_steps,
        params: learned.params,
    })
}

/// What a training loop runs with.
pub(crate) struct Loop<'a> {
    pub(crate) executor: &'a dyn Executor,
    pub(crate) observer: &'a mut dyn Observer,
    pub(crate) stop: &'a AtomicBool,
    pub(crate) began: Instant,
}

/// Where a training stands.
#[derive(Default)]
pub(crate) struct Learned {
    pub(crate) params: Vec<f32>,
    pub(crate) iterations: u64,
    pub(crate) env_steps: u64,
    pub(crate) failed_candidates: u64,
    pub(crate) discarded_episodes: u64,
    /// Mean discounted and undiscounted returns of the last iterations.
    recent: VecDeque<(f64, f64)>,
}

impl Learned {
    /// Counts an iteration whose steps are counted already, and tells of it; a search has no update.
    pub(crate) fn tell(
        &mut self,
        returns: (f64, f64),
        update: Option<UpdateMetrics>,
        design_totals: Vec<f64>,
        run: &mut Loop<'_>,
    ) -> Result<(), ObserverError> {
        self.recent.push_back(returns);
        if self.recent.len() > TRAILING {
            self.recent.pop_front();
        }
        run.observer.on(Event::Iteration(&MetricsRow {
            iteration: self.iterations,
            env_steps: self.env_steps,
            wall_s: run.began.elapsed().as_secs_f64(),
            discounted_return: returns.0,
            undiscounted_return: returns.1,
            kl: update.map_or(f64::NAN, |u| u.kl),
            entropy: update.map_or(f64::NAN, |u| u.entropy),
            step_fraction: update.map_or(f64::NAN, |u| u.trust_region.map_or(1.0, |r| r.step_fraction)),
            design_totals,
        }))?;
        self.iterations += 1;
        Ok(())
    }

    /// The mean discounted and undiscounted returns of the last [`TRAILING`] iterations.
    pub(crate) fn trailing(&self) -> (f64, f64) {
        let mean =
            |pick: fn(&(f64, f64)) -> f64| self.recent.iter().map(pick).sum::<f64>() / self.recent.len().max(1) as f64;
        (mean(|r| r.0), mean(|r| r.1))
    }
}

/// Follows the policy's gradient.
pub(crate) fn gradient(assembly: &Assembly, run: &mut Loop<'_>) -> Result<Learned, TrainError> {
    let spec = assembly.spec();
    let mut learner = assembly.learner(assembly.init());
    let sampler =
        Sampler::new(assembly.policy.clone(), assembly.problem.training.make.clone(), Some(spec.train.episode_steps));
    let mut learned = Learned::default();
    while learned.env_steps < spec.train.env_steps && !run.stop.load(Ordering::Relaxed) {
        let progress = learned.env_steps as f64 / spec.train.env_steps as f64;
        let iteration = learned.iterations;
        let asked = Episodes {
            seed: spec.seed,
            iteration,
            indices: 0..spec.train.episodes_per_iteration as u64,
            progress,
            kind: EpisodeKind::Training,
        };
        let batch = sampler.collect(run.executor, learner.params(), &asked)?;
        learned.env_steps += batch.env_steps();
        learned.discarded_episodes += batch.faults.len() as u64;
        let update = learner.update(run.executor, &batch, progress, iteration)?;
        let totals = assembly.policy.space().totals(&assembly.policy.design(learner.params()));
        learned.tell(mean_returns(&batch, spec.discount()), Some(update), totals, run)?;
    }
    learned.params = learner.params().to_vec();
    Ok(learned)
}

/// The mean discounted and undiscounted returns of a batch's episodes.
pub(crate) fn mean_returns(batch: &Batch, discount: f64) -> (f64, f64) {
    let mean = |returns: Vec<f64>| returns.iter().sum::<f64>() / returns.len().max(1) as f64;
    (mean(batch.returns(discount)), mean(batch.returns(1.0)))
}

impl Assembly {
    /// What the totals of the design groups are called in tables and plots: `stiffness_total`, or `gear` for a group of
    /// one.
    pub fn total_names(&self) -> Vec<String> {
        let groups = self.policy.space().groups().iter();
        groups.map(|g| if g.count == 1 { g.name.clone() } else { format!("{}_total", g.name) }).collect()
    }
}
