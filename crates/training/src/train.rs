//! Trainings: from an assembled experiment to parameters and their evaluation.

use std::sync::atomic::AtomicBool;

use hwasp_algos::{LearnError, SearchError, StateError};
use hwasp_core::{Executor, RolloutError};
use thiserror::Error;

use crate::assemble::{AssembleError, Assembly};
use crate::checkpoint::Checkpoint;
use crate::drawing::total_name;
use crate::evaluate::{EvaluateError, Evaluation, evaluate};
use crate::gradient::{Gradient, gradient};
use crate::learned::{Clock, Loop};
use crate::observer::{Event, Observer, ObserverError};
use crate::search::{best_so_far, search};

/// Why a training ended early.
#[derive(Debug, Error)]
pub enum TrainError {
    /// An episode failed.
    #[error(transparent)]
    Rollout(#[from] RolloutError),
    /// An update failed.
    #[error(transparent)]
    Learn(#[from] LearnError),
    /// The physics of most episodes failed, again and again: what is learned from the rest is worth nothing.
    #[error(
        "the physics of most episodes failed in {iterations} iterations in a row ({failed} of {asked} in the last); {first}"
    )]
    Physics {
        /// How many iterations.
        iterations: u64,
        /// Episodes that failed in the last of them.
        failed: usize,
        /// Episodes asked for in each.
        asked: usize,
        /// The first of those that failed.
        first: RolloutError,
    },
    /// Someone asked it to stop. Its observer has a checkpoint of all that was done.
    #[error("stopped after {env_steps} of {budget} steps")]
    Interrupted {
        /// Real simulator steps taken.
        env_steps: u64,
        /// Those of the whole training.
        budget: u64,
    },
    /// The state of what learns cannot be saved, or a saved one is not of this experiment.
    #[error(transparent)]
    State(#[from] StateError),
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
}

/// Iterations over which the final training return is averaged, as the paper's curves are.
pub const TRAILING: usize = 11;

/// Trains an experiment to the end of its budget.
///
/// # Errors
/// [`TrainError::Interrupted`] where `stop` was set: the iteration at hand was finished, and `observer` was given a
/// checkpoint.
pub fn train(
    assembly: &Assembly,
    executor: &dyn Executor,
    observer: &mut dyn Observer,
    stop: &AtomicBool,
) -> Result<Trained, TrainError> {
    train_from(None, assembly, executor, observer, stop)
}

/// Trains from a checkpoint of the same experiment, where there is one: the result has the bits of a training that was
/// never interrupted, for any number of threads before and after.
pub fn train_from(
    from: Option<&Checkpoint>,
    assembly: &Assembly,
    executor: &dyn Executor,
    observer: &mut dyn Observer,
    stop: &AtomicBool,
) -> Result<Trained, TrainError> {
    let spec = assembly.spec();
    let (totals, resumed) = (assembly.total_names(), from.map(|checkpoint| checkpoint.env_steps));
    observer.on(Event::Started { env_steps: spec.train.env_steps, resumed, totals: &totals })?;
    let mut run = Loop { executor, observer, stop, clock: Clock::start(0.0) };
    let from = from.map(|checkpoint| &checkpoint.archive);
    let learned =
        if spec.method.searches() { search(assembly, &mut run, from)? } else { gradient(assembly, &mut run, from)? };
    let wall_s = run.clock.wall_s();
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
        params: learned.params,
    })
}

impl Assembly {
    /// What a training begins with that goes on with the parameters of another one: a checkpoint before the first iteration.
    ///
    /// # Errors
    /// Where a parameter is no number.
    pub fn beginning(&self, params: Vec<f32>) -> Result<Checkpoint, TrainError> {
        Ok(Gradient::beginning(self, params).checkpoint()?)
    }

    /// The parameters that a training had come to: the learner's, or the best of a search.
    pub fn params_at(&self, checkpoint: &Checkpoint) -> Result<Vec<f32>, TrainError> {
        let archive = &checkpoint.archive;
        if self.spec().method.searches() {
            return best_so_far(self, archive);
        }
        Ok(Gradient::new(self, Some(archive))?.params())
    }

    /// What the totals of the design groups are called in tables and plots: `stiffness_total`, or `gear` for a group of
    /// one.
    pub fn total_names(&self) -> Vec<String> {
        let groups = self.policy.space().groups().iter();
        groups.map(|g| total_name(&g.name, g.count)).collect()
    }
}
