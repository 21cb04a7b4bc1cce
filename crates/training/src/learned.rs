//! Where a training stands, whatever trains.

use std::collections::VecDeque;
use std::time::Instant;

use hwasp_algos::{Archive, Exchange, Persist, StateError};
use hwasp_core::{Executor, NoiseSizes};

use crate::assemble::Assembly;
use crate::checkpoint::Checkpoint;
use crate::collect::{Collector, ExperimentText};
use crate::metrics::MetricsRow;
use crate::observer::{Event, Observer, ObserverError};
use crate::returns::{Ended, Returns};

/// Iterations over which the final training return is averaged, as the paper's curves are.
pub const TRAILING: usize = 11;

/// What a training loop runs with.
pub(crate) struct LoopContext<'a> {
    /// The name of the experiment in requests.
    pub(crate) experiment: ExperimentText,
    /// Runs episodes and candidates.
    pub(crate) collector: &'a dyn Collector,
    /// Runs sums over rows.
    pub(crate) executor: &'a dyn Executor,
    pub(crate) observer: &'a mut dyn Observer,
    /// Whether someone wants it to end.
    pub(crate) stopped: &'a (dyn Fn() -> bool + Sync),
    pub(crate) clock: Clock,
    /// Real simulator steps that all of it may take, at most.
    pub(crate) budget: u64,
    /// The learner's metrics that rows tell; NaN where a search has none of them.
    pub(crate) metrics: &'a [&'a str],
    /// The terms of the reward that rows tell.
    pub(crate) terms: &'a [String],
}

impl LoopContext<'_> {
    /// Tells that training begins, or goes on, and starts the clock.
    pub(crate) fn begin(&mut self, assembly: &Assembly, learned: &Learned, resumed: bool) -> Result<(), ObserverError> {
        self.observer.on(Event::Started {
            env_steps: self.budget,
            resumed: resumed.then_some(learned.env_steps),
            learner: self.metrics,
            terms: self.terms,
            totals: &assembly.total_names(),
        })?;
        self.clock = Clock::start(learned.wall_s);
        Ok(())
    }
}

/// The time that a training has taken.
#[derive(Clone, Copy)]
pub(crate) struct Clock {
    began: Instant,
    /// Before it was resumed, s.
    before: f64,
}

impl Clock {
    /// Starts; `before`: what a training took until it was interrupted, s.
    pub(crate) fn start(before: f64) -> Self {
        Self { began: Instant::now(), before }
    }

    /// Seconds.
    pub(crate) fn wall_s(&self) -> f64 {
        self.before + self.began.elapsed().as_secs_f64()
    }
}

/// Where a training stands.
#[derive(Default)]
pub(crate) struct Learned {
    /// What it came to; empty while it goes on.
    pub(crate) params: Vec<f32>,
    pub(crate) iterations: u64,
    pub(crate) env_steps: u64,
    pub(crate) failed_candidates: u64,
    /// How the first of them failed.
    pub(crate) first_failure: Option<String>,
    pub(crate) discarded_episodes: u64,
    /// Iterations in a row in which the physics of most episodes failed.
    pub(crate) faulty_iterations: u64,
    /// Time it took, s.
    pub(crate) wall_s: f64,
    /// Steps that polished, where it came to its end and did.
    pub(crate) polish_steps: Option<u64>,
    /// Mean discounted and undiscounted returns of the last iterations that have some.
    recent: VecDeque<(f64, f64)>,
}

impl Learned {
    /// Counts an iteration whose steps are counted already, and hands its row on; a search has no metrics of a learner, and no noise.
    pub(crate) fn record(
        &mut self,
        Ended { episodes, steps, returns }: Ended,
        (mut learner, noise): (Vec<f64>, NoiseSizes),
        design_totals: Vec<f64>,
        run: &mut LoopContext<'_>,
    ) -> Result<(), ObserverError> {
        self.recent.extend(returns.as_ref().map(|returns| (returns.discounted, returns.undiscounted)));
        let none = Returns { discounted: f64::NAN, undiscounted: f64::NAN, terms: Vec::new() };
        let Returns { discounted, undiscounted, mut terms } = returns.unwrap_or(none);
        terms.resize(run.terms.len(), f64::NAN);
        learner.resize(run.metrics.len(), f64::NAN);
        if self.recent.len() > TRAILING {
            self.recent.pop_front();
        }
        self.wall_s = run.clock.wall_s();
        run.observer.on(Event::Iteration(&MetricsRow {
            iteration: self.iterations,
            env_steps: self.env_steps,
            wall_s: self.wall_s,
            discounted_return: discounted,
            undiscounted_return: undiscounted,
            episodes,
            episode_steps: steps,
            noise,
            learner,
            terms,
            design_totals,
        }))?;
        self.iterations += 1;
        Ok(())
    }

    /// The mean discounted and undiscounted returns of the last [`TRAILING`] iterations that have some; NaN where none has.
    pub(crate) fn trailing(&self) -> (f64, f64) {
        let mean = |pick: fn(&(f64, f64)) -> f64| self.recent.iter().map(pick).sum::<f64>() / self.recent.len() as f64;
        (mean(|r| r.0), mean(|r| r.1))
    }

    /// A checkpoint of this and of all the rest of the training.
    pub(crate) fn checkpoint(&self, archive: Archive) -> Checkpoint {
        let training_return = (!self.recent.is_empty()).then(|| self.trailing().1);
        Checkpoint { iteration: self.iterations, env_steps: self.env_steps, training_return, archive }
    }
}

impl Persist for Learned {
    fn exchange(&mut self, with: &mut Exchange<'_>) -> Result<(), StateError> {
        with.number("iterations", &mut self.iterations)?;
        with.number("env_steps", &mut self.env_steps)?;
        with.number("failed_candidates", &mut self.failed_candidates)?;
        with.text("first_failure", &mut self.first_failure)?;
        with.number("discarded_episodes", &mut self.discarded_episodes)?;
        with.number("faulty_iterations", &mut self.faulty_iterations)?;
        with.number("wall_s", &mut self.wall_s)?;
        let mut recent: Vec<f64> = self.recent.iter().flat_map(|r| [r.0, r.1]).collect();
        with.series("recent", &mut recent)?;
        if recent.len() > 2 * TRAILING || !recent.len().is_multiple_of(2) {
            return Err(with.refuse(
                "recent",
                recent.len() as f64,
                "the length of pairs of returns, 11 of them at most",
            ));
        }
        self.recent = recent.as_chunks::<2>().0.iter().map(|r| (r[0], r[1])).collect();
        Ok(())
    }
}
