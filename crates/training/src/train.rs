//! Trainings: from an assembled experiment to parameters and their evaluation.

use std::sync::atomic::{AtomicBool, Ordering};

use hwasp_algos::{Archive, Metrics};
use hwasp_core::{Batch, Executor, bits};
use serde::{Deserialize, Serialize};

use crate::assemble::Assembly;
use crate::checkpoint::Checkpoint;
use crate::collect::{Collector, ExperimentText};
use crate::error::TrainError;
use crate::evaluate::evaluate_by;
use crate::evaluation::Evaluation;
use crate::gradient::{Gradient, repeat_by};
use crate::learned::{Clock, LoopContext};
use crate::observer::{Event, Observer};
use crate::polish::{learn, params_at};
use crate::worker::LocalCollector;

/// What a training gave.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Trained {
    /// The policy's parameters.
    #[serde(with = "bits")]
    pub params: Vec<f32>,
    /// Iterations done; generations of a search.
    pub iterations: u64,
    /// Real simulator steps taken in training, those of every candidate and every training inside included.
    pub env_steps: u64,
    /// Time the training took, s, the evaluation apart.
    pub wall_s: f64,
    /// The mean discounted return of the training episodes over the last [`TRAILING`](crate::TRAILING) iterations in which some
    /// came to their end; NaN where none ever did.
    #[serde(with = "bits")]
    pub training_discounted_return: f64,
    /// The same, undiscounted.
    #[serde(with = "bits")]
    pub training_return: f64,
    /// Candidates of a search that failed and ranked last; none where the method does not search.
    pub failed_candidates: Option<u64>,
    /// How the first of them failed: episode, step and cause.
    pub first_failure: Option<String>,
    /// Episodes whose physics failed; their steps are charged, and nothing was learned from them.
    pub discarded_episodes: u64,
    /// Steps that polished the controller, of those above; none where the experiment asks for no polish.
    pub polish_steps: Option<u64>,
    /// The final design on held-out starts.
    pub evaluation: Evaluation,
}

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
    train_by(&LocalCollector::new(assembly, executor)?, from, assembly, executor, observer, stop)
}

/// The same, with episodes and candidates that `collector` gives: the bits do not depend on who answers.
pub fn train_by(
    collector: &dyn Collector,
    from: Option<&Checkpoint>,
    assembly: &Assembly,
    executor: &dyn Executor,
    observer: &mut dyn Observer,
    stop: &AtomicBool,
) -> Result<Trained, TrainError> {
    let spec = assembly.experiment();
    let stopped = || stop.load(Ordering::Relaxed);
    let mut run = LoopContext {
        experiment: ExperimentText::of(spec)?,
        collector,
        executor,
        observer: &mut *observer,
        stopped: &stopped,
        clock: Clock::start(0.0),
        budget: spec.train.env_steps,
        metrics: if spec.method.searches() && !assembly.polishes() { &[] } else { assembly.metric_names() },
        // Of a candidate's training only the returns come back.
        terms: if spec.method.trains_inside() { &[] } else { &assembly.worlds.training.env.terms },
    };
    let learned = learn(assembly, &mut run, from.map(|checkpoint| &checkpoint.archive))?;
    let wall_s = run.clock.wall_s();
    observer.on(Event::Evaluating)?;
    let asked = (spec.train.evaluation_episodes as u64, spec.train.evaluation_seed);
    let evaluation = evaluate_by(collector, assembly, &learned.params, asked)?;
    observer.on(Event::Evaluated(&evaluation))?;
    let (training_discounted_return, training_return) = learned.trailing();
    Ok(Trained {
        iterations: learned.iterations,
        env_steps: learned.env_steps,
        wall_s,
        training_discounted_return,
        training_return,
        failed_candidates: spec.method.searches().then_some(learned.failed_candidates),
        first_failure: learned.first_failure,
        discarded_episodes: learned.discarded_episodes,
        polish_steps: learned.polish_steps,
        evaluation,
        params: learned.params,
    })
}

/// What a training begins with that goes on with the parameters of another one: a checkpoint before the first iteration. Of
/// so many simulator steps are the statistics of observations among the parameters, if there are any.
///
/// # Errors
/// Where a parameter is no number.
pub fn beginning(assembly: &Assembly, params: Vec<f32>, env_steps: u64) -> Result<Checkpoint, TrainError> {
    Ok(Gradient::further(assembly, params, env_steps).checkpoint()?)
}

/// What is to be said of trainings that have not [`moved`].
pub const STILL: &str = "every update was rejected, too small to be seen in the parameters, or left out while the learner warmed up; look \
                         at its columns in metrics.csv, and at its settings";

/// Whether a training changed any parameter by more than rounding does. `from`: the checkpoint that it was given; it counts where
/// it is before the first iteration, as that of a training that goes on with the parameters of [another one](beginning).
pub fn moved(assembly: &Assembly, from: Option<&Checkpoint>, params: &[f32]) -> bool {
    const LEAST: f32 = 1e-6;
    let given = from.filter(|checkpoint| checkpoint.iteration == 0);
    let first = given.and_then(|checkpoint| params_at(assembly, checkpoint).ok()).unwrap_or_else(|| assembly.init());
    first.iter().zip(params).any(|(from, to)| (to - from).abs() > LEAST * from.abs().max(1.0))
}

/// The iteration that follows a state of a [stage](crate::stage_at) once more: its batch, where it came so far, and what the update said.
///
/// # Errors
/// Of a state that is not one of this experiment. What fails in the iteration is in the result.
pub fn repeat(
    assembly: &Assembly,
    from: &Archive,
    executor: &dyn Executor,
) -> Result<(Option<Batch>, Result<Metrics, TrainError>), TrainError> {
    let (collector, experiment) =
        (LocalCollector::new(assembly, executor)?, ExperimentText::of(assembly.experiment())?);
    Ok(repeat_by(&collector, &experiment, assembly, from, executor)?)
}
