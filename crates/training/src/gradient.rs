//! The loop that follows the policy's gradient: jobs out, a batch in, an update, an event.

use std::ops::Range;

use hwasp_algos::{Archive, Exchange, LearnError, Learner, Metrics, Persist, StateError};
use hwasp_core::{Batch, EpisodeKind, Episodes, Executor, LaneSteps};
use hwasp_experiment::Experiment;

use crate::assemble::{Assembly, Portion};
use crate::checkpoint::Checkpoint;
use crate::collect::{Collector, EpisodesRequest, ExperimentText};
use crate::error::TrainError;
use crate::learned::{Learned, LoopContext};
use crate::observer::{Event, FailedIteration};
use crate::returns::{Ended, Returns, mean_terms};
use crate::running::Running;

/// Iterations in a row in which the physics of most episodes may fail.
const MOST_FAULTY_ITERATIONS: u64 = 3;

/// A training by gradients between two iterations.
pub(crate) struct Gradient<'a> {
    assembly: &'a Assembly,
    learner: Box<dyn Learner>,
    pub(crate) learned: Learned,
    running: Running,
    /// The parameters that act in the next iteration, where they are not the present ones: those from before the last update, of
    /// a learner that keeps experience.
    acting: Option<Vec<f32>>,
    /// What came of the next iteration's episodes, where they were run while the learner learned. It follows from the rest: who
    /// resumes runs them anew.
    ahead: Option<Result<Batch, TrainError>>,
}

/// Where a training stands before an iteration: all that its episodes follow from.
struct Stand {
    /// The parameters that act.
    params: Vec<f32>,
    /// Real simulator steps before it.
    env_steps: u64,
    iteration: u64,
}

impl Persist for Gradient<'_> {
    fn exchange(&mut self, with: &mut Exchange<'_>) -> Result<(), StateError> {
        with.part("loop", &mut self.learned)?;
        with.part("learner", &mut *self.learner)?;
        with.part("running", &mut self.running)?;
        self.assembly.exchange_main(with)?;
        match &mut self.acting {
            Some(acting) => with.vector("acting", acting),
            None => Ok(()),
        }
    }
}

/// Follows the policy's gradient, from the beginning or from where a training was interrupted.
pub(crate) fn gradient(
    assembly: &Assembly,
    run: &mut LoopContext<'_>,
    from: Option<&Archive>,
) -> Result<Learned, TrainError> {
    let state = Gradient::new(assembly, from)?;
    run.begin(assembly, &state.learned, from.is_some())?;
    state.follow(run)
}

impl<'a> Gradient<'a> {
    /// From the beginning, or from where a training was interrupted.
    pub(crate) fn new(assembly: &'a Assembly, from: Option<&Archive>) -> Result<Self, StateError> {
        let mut state = Self::beginning(assembly, assembly.init());
        if let Some(archive) = from {
            state.load(archive)?;
        }
        Ok(state)
    }

    /// From the beginning, with these parameters.
    pub(crate) fn beginning(assembly: &'a Assembly, params: Vec<f32>) -> Self {
        let learner = assembly.learner(params);
        let keeps_experience = assembly.experiment().learner.keeps_experience();
        let acting = keeps_experience.then(|| learner.params().to_vec());
        Self { assembly, learner, learned: Learned::default(), running: Running::new(assembly), acting, ahead: None }
    }

    /// From the beginning, with the parameters of a policy that was trained for so many steps.
    pub(crate) fn further(assembly: &'a Assembly, params: Vec<f32>, env_steps: u64) -> Self {
        let mut state = Self::beginning(assembly, params);
        state.running.go_on(&state.learner.params()[assembly.policy.normalizer_params()], env_steps);
        state
    }

    /// Follows the gradient until the budget is spent.
    pub(crate) fn follow(mut self, run: &mut LoopContext<'_>) -> Result<Learned, TrainError> {
        while self.portion().is_some() {
            if (run.stopped)() {
                run.observer.on(Event::Checkpoint(&self.checkpoint()?))?;
                return Err(TrainError::Interrupted { env_steps: self.learned.env_steps, budget: run.budget });
            }
            self.iterate(run)?;
            if run.observer.due() {
                run.observer.on(Event::Checkpoint(&self.checkpoint()?))?;
            }
        }
        // What is left to do, an evaluation, may be long.
        run.observer.on(Event::Checkpoint(&self.checkpoint()?))?;
        self.learned.params = self.params();
        Ok(self.learned)
    }

    /// The policy's parameters: the learner's, and the statistics so far.
    pub(crate) fn params(&self) -> Vec<f32> {
        let mut params = self.learner.params().to_vec();
        self.running.publish(&mut params[self.assembly.policy.normalizer_params()]);
        params
    }

    pub(crate) fn checkpoint(&mut self) -> Result<Checkpoint, StateError> {
        let archive = self.save()?;
        Ok(self.learned.checkpoint(archive))
    }

    fn iterate(&mut self, run: &mut LoopContext<'_>) -> Result<(), TrainError> {
        let collected = match self.ahead.take() {
            Some(collected) => collected,
            None => collect(self.assembly, run.collector, &run.experiment, &self.stand()),
        };
        let mut batch = collected.or_else(|error| self.fail(None, error, run))?;
        let env_steps = self.learned.env_steps + batch.env_steps();
        let update = if self.acting.is_some() {
            self.learn_beside(&mut batch, env_steps, run)
        } else {
            self.learn(run.executor, &mut batch)
        };
        let update = update.or_else(|error| self.fail(Some(&batch), error, run))?;
        let spec = self.assembly.experiment();
        let progress = spec.train.progress(self.learned.env_steps);
        let noise = self.assembly.policy.noise_sizes(self.learner.params(), progress);
        self.learned.env_steps = env_steps;
        self.learned.discarded_episodes += batch.faults.len() as u64;
        let totals = self.assembly.totals(self.learner.params());
        let ended = ended(&batch, spec.discount());
        Ok(self.learned.record(ended, (update.values().to_vec(), noise), totals, run)?)
    }

    /// Learns, and meanwhile runs the next iteration's episodes, with the parameters from before.
    fn learn_beside(
        &mut self,
        batch: &mut Batch,
        env_steps: u64,
        run: &LoopContext<'_>,
    ) -> Result<Metrics, TrainError> {
        let stand = Stand { params: self.params(), env_steps, iteration: self.learned.iterations + 1 };
        let (assembly, executor, collector, experiment) = (self.assembly, run.executor, run.collector, &run.experiment);
        let (mut update, mut ahead) = (None, None);
        executor.both(
            &mut || {
                ahead = Some(assembly.iterates(env_steps).then(|| collect(assembly, collector, experiment, &stand)));
            },
            &mut || update = Some(self.learn(executor, batch)),
        );
        let (update, ahead) = update.zip(ahead).expect("an executor runs every job");
        let update = update?;
        (self.acting, self.ahead) = (Some(stand.params), ahead);
        Ok(update)
    }

    /// Tells the observer of an iteration that failed, with all that it takes to repeat it: the learner is as it was.
    fn fail<T>(
        &mut self,
        batch: Option<&Batch>,
        error: TrainError,
        run: &mut LoopContext<'_>,
    ) -> Result<T, TrainError> {
        let (checkpoint, what) = (self.checkpoint()?, error.to_string());
        run.observer.on(Event::Failed(&FailedIteration { checkpoint: &checkpoint, batch, what: &what }))?;
        Err(error)
    }

    /// What the iteration at hand takes; none where the budget is spent.
    fn portion(&self) -> Option<Portion> {
        self.assembly.portion(self.learned.env_steps)
    }

    /// Where it stands.
    fn stand(&self) -> Stand {
        Stand {
            params: self.acting.clone().unwrap_or_else(|| self.params()),
            env_steps: self.learned.env_steps,
            iteration: self.learned.iterations,
        }
    }

    /// An error of the learner, or the rewards that it saw where they are the cause: they may be any number, and what is
    /// computed from them not.
    fn blamed(&self, error: LearnError, batch: &Batch) -> TrainError {
        let largest = batch.reward.iter().fold(0.0, |most: f64, reward| most.max(reward.abs()));
        if largest < LARGE_REWARD {
            return error.into();
        }
        let term = largest_term(&self.assembly.worlds.training.env.terms, batch).cloned();
        TrainError::Reward { largest, iteration: self.learned.iterations, term, source: error }
    }

    /// The update of the iteration at hand.
    fn learn(&mut self, executor: &dyn Executor, batch: &mut Batch) -> Result<Metrics, TrainError> {
        let progress = self.assembly.experiment().train.progress(self.learned.env_steps);
        let asked = batch.episodes.len() + batch.faults.len();
        let faulty = 2 * batch.faults.len() > asked;
        let in_a_row = if faulty { self.learned.faulty_iterations + 1 } else { 0 };
        if in_a_row >= MOST_FAULTY_ITERATIONS
            && let Some(first) = batch.faults.first()
        {
            return Err(TrainError::Physics {
                iterations: in_a_row,
                failed: batch.faults.len(),
                asked,
                first: first.clone(),
            });
        }
        let mut running = self.running.clone();
        running.take(batch);
        // The learner's rewards may be others than those of the task, which whoever looks at the batch wants to see.
        let scaled = running.rewards(batch);
        let rewards = scaled.map(|scaled| std::mem::replace(&mut batch.reward, scaled));
        let update = self.learner.update(executor, batch, progress, self.learned.iterations);
        let update = update.map_err(|error| self.blamed(error, batch));
        if let Some(rewards) = rewards {
            batch.reward = rewards;
        }
        let update = update?;
        (self.running, self.learned.faulty_iterations) = (running, in_a_row);
        Ok(update)
    }
}

/// Rewards of which sums and squares leave the range of single precision, or lose in it what tells one step from another.
const LARGE_REWARD: f64 = 1e12;

/// The name of the reward's term that came to the most in the episodes of a batch, whatever its sign; none where there is no
/// other.
fn largest_term<'t>(terms: &'t [String], batch: &Batch) -> Option<&'t String> {
    let size = |i: usize| batch.episodes.iter().map(|episode| episode.terms[i].abs()).fold(0.0, f64::max);
    let sizes = (0..terms.len()).map(|i| (i, size(i)));
    let largest = sizes.max_by(|a, b| a.1.total_cmp(&b.1)).map(|(i, _)| &terms[i]);
    largest.filter(|_| terms.len() > 1)
}

/// The episodes of an iteration. The last one goes on with further episodes, by index, as long as the budget holds a whole one: how
/// many depends on the steps of those before alone, and so on nothing that a resume could change.
fn collect(
    assembly: &Assembly,
    collector: &dyn Collector,
    experiment: &ExperimentText,
    stand: &Stand,
) -> Result<Batch, TrainError> {
    let request = |indices, lanes| request(assembly, experiment, stand, indices, lanes);
    let first = match assembly.portion(stand.env_steps) {
        None => 0,
        Some(Portion::Episodes(episodes)) => episodes,
        Some(Portion::Steps(steps)) => {
            return Ok(collector.rows(&request(0..steps.lanes, Some(steps)))?.sound()?);
        }
    };
    let mut parts = Vec::new();
    let (mut taken, mut asked, mut more) = (stand.env_steps, 0, first);
    while more > 0 {
        let part = collector.rows(&request(asked..asked + more, None))?;
        asked += more;
        taken += part.env_steps();
        more = assembly.further_episodes(taken);
        parts.push(part);
    }
    Ok(Batch::join(parts).sound()?)
}

/// Asks for episodes of an iteration, or for the steps of its lanes.
fn request(
    assembly: &Assembly,
    experiment: &ExperimentText,
    stand: &Stand,
    indices: Range<u64>,
    lanes: Option<LaneSteps>,
) -> EpisodesRequest {
    let Experiment { seed, train, .. } = assembly.experiment();
    EpisodesRequest {
        experiment: experiment.clone(),
        stage: assembly.stage(),
        params: stand.params.clone(),
        episodes: Episodes {
            seed: *seed,
            iteration: stand.iteration,
            indices,
            progress: train.progress(stand.env_steps),
            kind: EpisodeKind::Training,
        },
        steps: Some(train.episode_steps),
        lanes,
    }
}

/// The episodes of a batch that ended by themselves.
fn ended(batch: &Batch, discount: f64) -> Ended {
    let whole = || batch.episodes.iter().filter(|episode| !episode.cut);
    let count = whole().count() as f64;
    let mean = |returns: Vec<f64>| {
        let whole_ones = returns.iter().zip(&batch.episodes).filter(|(_, episode)| !episode.cut);
        whole_ones.map(|(total, _)| total).sum::<f64>() / count
    };
    let returns = (count > 0.0).then(|| Returns {
        discounted: mean(batch.returns(discount)),
        undiscounted: mean(batch.returns(1.0)),
        terms: mean_terms(&whole().map(|episode| &*episode.terms).collect::<Vec<_>>()),
    });
    let steps: usize = whole().map(|episode| episode.rows.len()).sum();
    Ended { episodes: count, steps: steps as f64 / count, returns }
}

/// The iteration that follows a state once more: its batch, where it came so far, and what the update said.
///
/// # Errors
/// Of a state that is not one of this experiment. What fails in the iteration is in the result.
pub(crate) fn repeat_by(
    collector: &dyn Collector,
    experiment: &ExperimentText,
    assembly: &Assembly,
    from: &Archive,
    executor: &dyn Executor,
) -> Result<(Option<Batch>, Result<Metrics, TrainError>), StateError> {
    let mut state = Gradient::new(assembly, Some(from))?;
    Ok(match collect(assembly, collector, experiment, &state.stand()) {
        Ok(mut batch) => {
            let outcome = state.learn(executor, &mut batch);
            (Some(batch), outcome)
        }
        Err(error) => (None, Err(error)),
    })
}
