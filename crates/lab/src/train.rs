//! The training loop: jobs out, batches in, an update, an event.

use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use hwasp_algos::{LearnError, Learner};
use hwasp_core::{EpisodeKind, Episodes, Executor, RolloutError, Sampler};
use thiserror::Error;

use crate::assemble::Assembly;
use crate::evaluate::{EvaluateError, Evaluation, evaluate};
use crate::metrics::MetricsRow;
use crate::observer::{Event, Observer, ObserverError};

/// Why a training ended early.
#[derive(Debug, Error)]
pub enum TrainError {
    /// An episode failed.
    #[error(transparent)]
    Rollout(#[from] RolloutError),
    /// An update failed.
    #[error(transparent)]
    Learn(#[from] LearnError),
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
    /// Iterations done.
    pub iterations: u64,
    /// Real simulator steps taken in training.
    pub env_steps: u64,
    /// Time the training took, s, the evaluation apart.
    pub wall_s: f64,
    /// The mean discounted return of the training episodes over the last [`TRAILING`] iterations.
    pub training_discounted_return: f64,
    /// The same, undiscounted.
    pub training_return: f64,
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
    let mut learner = assembly.learner(assembly.init());
    let sampler =
        Sampler::new(assembly.policy.clone(), assembly.problem.training.make.clone(), Some(spec.train.episode_steps));
    let totals = assembly.total_names();
    observer.on(Event::Started { env_steps: spec.train.env_steps, totals: &totals })?;
    let began = Instant::now();
    let (mut iteration, mut env_steps) = (0, 0);
    let mut recent: Vec<(f64, f64)> = Vec::new();
    while env_steps < spec.train.env_steps && !stop.load(Ordering::Relaxed) {
        let progress = env_steps as f64 / spec.train.env_steps as f64;
        let batch = sampler.collect(
            executor,
            learner.params(),
            &Episodes {
                seed: spec.seed,
                iteration,
                indices: 0..spec.train.episodes_per_iteration as u64,
                progress,
                kind: EpisodeKind::Training,
            },
        )?;
        env_steps += batch.rows() as u64;
        let mean = |returns: Vec<f64>| returns.iter().sum::<f64>() / returns.len().max(1) as f64;
        let returns = (mean(batch.returns(spec.ppo.discount)), mean(batch.returns(1.0)));
        let update = learner.update(&batch, progress, iteration)?;
        let design = assembly.policy.design(learner.params());
        recent.push(returns);
        if recent.len() > TRAILING {
            recent.remove(0);
        }
        observer.on(Event::Iteration(&MetricsRow {
            iteration,
            env_steps,
            wall_s: began.elapsed().as_secs_f64(),
            discounted_return: returns.0,
            undiscounted_return: returns.1,
            kl: update.kl,
            entropy: update.entropy,
            design_totals: assembly.policy.space().totals(&design),
        }))?;
        iteration += 1;
    }
    let wall_s = began.elapsed().as_secs_f64();
    observer.on(Event::Evaluating)?;
    let asked = (spec.train.evaluation_episodes as u64, spec.train.evaluation_seed);
    let evaluation = evaluate(assembly, learner.params(), asked, executor)?;
    observer.on(Event::Evaluated(&evaluation))?;
    let trailing = |pick: fn(&(f64, f64)) -> f64| recent.iter().map(pick).sum::<f64>() / recent.len().max(1) as f64;
    Ok(Trained {
        params: learner.params().to_vec(),
        iterations: iteration,
        env_steps,
        wall_s,
        training_discounted_return: trailing(|r| r.0),
        training_return: trailing(|r| r.1),
        evaluation,
        stopped: env_steps < spec.train.env_steps,
    })
}

impl Assembly {
    /// What the totals of the design groups are called in tables and plots: `stiffness_total`, or `gear` for a group of
    /// one.
    pub fn total_names(&self) -> Vec<String> {
        let groups = self.policy.space().groups().iter();
        groups.map(|g| if g.count == 1 { g.name.clone() } else { format!("{}_total", g.name) }).collect()
    }
}
