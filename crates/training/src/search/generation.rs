//! The candidates of one generation: they wait, train or are scored, several at once.

use std::ops::Range;
use std::sync::{Mutex, MutexGuard};
use std::time::{Duration, Instant};

use hwasp_algos::{Archive, StateFilter};
use hwasp_core::{Episode, EpisodeKind, EpisodeResult, Episodes, Purpose, RolloutError, all_failed, stream};
use rand::RngExt;

use super::space::SearchSpace;
use super::state::{Scored, Slot, State};
use crate::collect::{
    CandidateAnswer, CandidateFailure, CandidateRequest, CollectError, Collector, EpisodeAnswer, EpisodesRequest,
    ExperimentText, Stage, Watch,
};
use crate::error::TrainError;
use crate::learned::{Clock, LoopContext};
use crate::observer::{Event, Observer};
use crate::returns::{Returns, mean_terms};

/// How old a candidate's own training may be in a checkpoint that another candidate had made.
const STALE: Duration = Duration::from_secs(1);
/// Episodes of a candidate whose rows are held at once: as many as a worker steps side by side.
const HELD: u64 = 32;
/// Why no lock is poisoned.
const UNPOISONED: &str = "a search does not go on after a panic in one of its candidates";

/// The candidates of one generation.
pub(super) struct Generation<'a> {
    pub(super) space: &'a SearchSpace<'a>,
    pub(super) candidates: &'a [Vec<f64>],
}

impl Generation<'_> {
    /// Scores all candidates that are not scored yet.
    pub(super) fn score(&self, state: &mut State, run: &mut LoopContext<'_>) -> Result<Vec<Scored>, TrainError> {
        state.slots.resize_with(self.candidates.len(), Slot::default);
        let generation = state.search.generation();
        let groups: Vec<u64> = (0..self.candidates.len()).map(|i| state.search.group(i)).collect();
        let filter = state.filter.clone();
        let spec = self.space.assembly.experiment();
        // All candidates of a generation see the same world: as it is at its beginning.
        let progress = spec.train.progress(state.learned.env_steps);
        let seen = filter.as_ref().map(StateFilter::blank);
        let scoring = Scoring { space: self.space, experiment: &run.experiment, progress, seen: seen.as_ref() };
        let (stopped, clock, collector) = (run.stopped, run.clock, run.collector);
        let shared = Mutex::new(Shared { state, observer: &mut *run.observer, clock, error: None });
        collector.each(self.candidates.len(), &|i, collector| {
            let from = match &lock(&shared).state.slots[i] {
                Slot::Scored(_) => return,
                Slot::Training(archive) => Some(archive.clone()),
                Slot::Waiting => None,
            };
            if stopped() || lock(&shared).error.is_some() {
                return;
            }
            let params = self.space.acting(&self.candidates[i], filter.as_ref());
            let scored = if spec.method.trains_inside() {
                let watch = CandidateWatch { shared: &shared, slot: i, stopped, kept: Mutex::new(Instant::now()) };
                scoring.train_inside(collector, params, generation, from, &watch)
            } else {
                let (episodes, group) = (spec.search.episodes as u64, groups[i]);
                scoring.score(collector, params, generation, group * episodes..(group + 1) * episodes)
            };
            lock(&shared).take(i, scored);
        });
        let Shared { state, observer, error, .. } = shared.into_inner().expect(UNPOISONED);
        if let Some(error) = error {
            return Err(error);
        }
        if let Some(open) = state.slots.iter().position(|slot| !matches!(slot, Slot::Scored(_))) {
            let count = self.candidates.len();
            assert!(stopped(), "candidate {open} of {count} was not scored, and nobody asked the search to stop");
            observer.on(Event::Checkpoint(&state.checkpoint(clock)?))?;
            return Err(TrainError::Interrupted { env_steps: state.learned.env_steps, budget: run.budget });
        }
        let scored = |slot| match slot {
            Slot::Scored(scored) => scored,
            Slot::Waiting | Slot::Training(_) => unreachable!("all candidates were just seen to be scored"),
        };
        Ok(std::mem::take(&mut state.slots).into_iter().map(scored).collect())
    }
}

/// How candidates are scored.
pub(super) struct Scoring<'a> {
    pub(super) space: &'a SearchSpace<'a>,
    pub(super) experiment: &'a ExperimentText,
    /// The share of all schedules that is done.
    pub(super) progress: f64,
    /// One that has seen nothing, where a filter wants to know what the controller sees.
    pub(super) seen: Option<&'a StateFilter>,
}

impl Scoring<'_> {
    /// Runs episodes. One that fails fails its candidate, which is charged all of its steps.
    pub(super) fn score(
        &self,
        collector: &dyn Collector,
        params: Vec<f32>,
        iteration: u64,
        indices: Range<u64>,
    ) -> Result<Scored, TrainError> {
        let spec = self.space.assembly.experiment();
        let kind = if spec.search.noise { EpisodeKind::Training } else { EpisodeKind::Deterministic };
        let charged = (indices.end - indices.start) * spec.train.episode_steps as u64;
        let episodes = Episodes { seed: spec.seed, iteration, indices, progress: self.progress, kind };
        let (experiment, steps) = (self.experiment.clone(), Some(spec.train.episode_steps));
        let request = EpisodesRequest { experiment, stage: Stage::Training, params, episodes, steps, lanes: None };
        let mut seen = self.seen.cloned();
        let results = match &mut seen {
            Some(seen) => looked_through(collector, &request, spec.discount(), seen),
            None => collector.results(&request),
        };
        let sound = |results: Vec<EpisodeAnswer>| match all_failed(&results) {
            Some(first) => Err(first.into()),
            None => Ok(of_results(&results)),
        };
        let scored = match results.and_then(sound) {
            Ok(scored) => scored,
            Err(CollectError::Rollout(error)) => {
                let failure = Some(CandidateFailure::episode(&error));
                Scored { failure, env_steps: charged, ..Scored::default() }
            }
            Err(error) => return Err(error.into()),
        };
        // What a candidate saw that failed is not what controllers see.
        let seen = if scored.returns.is_some() { seen } else { self.seen.cloned() };
        Ok(Scored { params: request.params, seen, ..scored })
    }

    /// Trains a controller of its own for a candidate's design. All candidates of a generation begin with the same weights
    /// and see the same random numbers.
    fn train_inside(
        &self,
        collector: &dyn Collector,
        mut params: Vec<f32>,
        generation: u64,
        from: Option<Archive>,
        watch: &dyn Watch,
    ) -> Result<Scored, TrainError> {
        let spec = self.space.assembly.experiment();
        // TOML holds no seed beyond 2^63.
        let seed = stream(spec.seed, Purpose::InnerSeed, generation, 0).random::<u64>() >> 1;
        let (design, env_steps) = (self.space.assembly.policy.design(&params), spec.search.inner_env_steps);
        let request = CandidateRequest { experiment: self.experiment.clone(), design, seed, env_steps, from };
        match collector.candidate(&request, watch)? {
            CandidateAnswer::Trained { controller, returns, env_steps, discarded_episodes } => {
                params[..controller.len()].copy_from_slice(&controller);
                let (discounted, undiscounted) = returns;
                let returns = Some(Returns { discounted, undiscounted, terms: Vec::new() });
                Ok(Scored { params, returns, env_steps, discarded_episodes, ..Scored::default() })
            }
            CandidateAnswer::Failed(failure) => {
                Ok(Scored { params, failure: Some(failure), env_steps, ..Scored::default() })
            }
        }
    }
}

/// What episodes come to, and statistics of what the controller sees in them. Their rows are looked through a few episodes at a
/// time and then forgotten, one episode after the other by index: neither memory nor bits depend on how many are held at once.
fn looked_through(
    collector: &dyn Collector,
    request: &EpisodesRequest,
    discount: f64,
    seen: &mut StateFilter,
) -> Result<Vec<EpisodeAnswer>, CollectError> {
    let Range { start, end } = request.episodes.indices;
    let mut results = Vec::with_capacity((end - start) as usize);
    for part in request.split((end - start).div_ceil(HELD) as usize) {
        let batch = collector.rows(&part)?;
        let (discounted, undiscounted) = (batch.returns(discount), batch.returns(1.0));
        let width = batch.obs.len() / batch.rows().max(1);
        for (k, Episode { rows, end, outcome, terms, .. }) in batch.episodes.into_iter().enumerate() {
            seen.update(&batch.obs[rows.start * width..rows.end * width]);
            results.push(Ok(EpisodeResult {
                discounted_return: discounted[k],
                undiscounted_return: undiscounted[k],
                steps: rows.len(),
                end,
                // Rows do not tell it, and no score asks.
                ended_by: None,
                outcome,
                terms,
            }));
        }
        results.extend(batch.faults.into_iter().map(Err));
    }
    Ok(results)
}

/// What episodes come to, of which at least one is sound.
fn of_results(results: &[EpisodeAnswer]) -> Scored {
    let faults: Vec<&RolloutError> = results.iter().filter_map(|result| result.as_ref().err()).collect();
    let steps = |result: &EpisodeAnswer| match result {
        Ok(episode) => episode.steps as u64,
        Err(fault) => fault.env_steps(),
    };
    let mean = |pick: fn(&EpisodeResult) -> f64| results.iter().flatten().map(pick).sum::<f64>() / results.len() as f64;
    let returns = || Returns {
        discounted: mean(|e| e.discounted_return),
        undiscounted: mean(|e| e.undiscounted_return),
        terms: mean_terms(&results.iter().flatten().map(|e| &*e.terms).collect::<Vec<_>>()),
    };
    Scored {
        returns: faults.is_empty().then(returns),
        failure: faults.first().map(|fault| CandidateFailure::episode(fault)),
        env_steps: results.iter().map(steps).sum(),
        discarded_episodes: faults.len() as u64,
        ..Scored::default()
    }
}

/// What the candidates of a generation share.
struct Shared<'a> {
    state: &'a mut State,
    observer: &'a mut dyn Observer,
    clock: Clock,
    /// What ended the search, if something did.
    error: Option<TrainError>,
}

fn lock<'a, 'b>(shared: &'a Mutex<Shared<'b>>) -> MutexGuard<'a, Shared<'b>> {
    shared.lock().expect(UNPOISONED)
}

impl Shared<'_> {
    /// Takes what a candidate came to.
    fn take(&mut self, slot: usize, scored: Result<Scored, TrainError>) {
        match scored {
            Ok(scored) => {
                self.state.slots[slot] = Slot::Scored(scored);
                self.keep_if_due();
            }
            // Its state is in its slot.
            Err(TrainError::Collect(CollectError::Interrupted)) => {}
            Err(error) => {
                self.error.get_or_insert(error);
            }
        }
    }

    fn keep_if_due(&mut self) {
        if self.observer.due() {
            let kept = self.state.checkpoint(self.clock).map_err(TrainError::from);
            let kept = kept.and_then(|checkpoint| Ok(self.observer.on(Event::Checkpoint(&checkpoint))?));
            if let Err(error) = kept {
                self.error.get_or_insert(error);
            }
        }
    }
}

/// Watches the training of one candidate.
struct CandidateWatch<'a, 'b> {
    shared: &'a Mutex<Shared<'b>>,
    slot: usize,
    stopped: &'a (dyn Fn() -> bool + Sync),
    /// When its state was last kept.
    kept: Mutex<Instant>,
}

impl Watch for CandidateWatch<'_, '_> {
    fn stopped(&self) -> bool {
        (self.stopped)() || lock(self.shared).error.is_some()
    }

    fn due(&self) -> bool {
        self.kept.lock().expect(UNPOISONED).elapsed() >= STALE || lock(self.shared).observer.due()
    }

    fn keep(&self, state: &Archive) {
        *self.kept.lock().expect(UNPOISONED) = Instant::now();
        let mut shared = lock(self.shared);
        shared.state.slots[self.slot] = Slot::Training(state.clone());
        shared.keep_if_due();
    }
}
