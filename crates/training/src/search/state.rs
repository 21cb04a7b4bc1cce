//! A search between two generations, and within one: candidates that wait, train or are scored.

use std::sync::atomic::Ordering;
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use hwasp_algos::{Archive, Exchange, Persist, Search, StateError, StateFilter};
use hwasp_core::Serial;

use super::Candidates;
use crate::checkpoint::Checkpoint;
use crate::error::TrainError;
use crate::learned::{Clock, Learned, Loop};
use crate::observer::{Event, Observer, ObserverError};

/// How old a candidate's own training may be in a checkpoint that another candidate had made.
const STALE: Duration = Duration::from_secs(1);

/// A search.
pub(super) struct State {
    pub(super) search: Box<dyn Search>,
    pub(super) filter: Option<StateFilter>,
    /// The best candidate so far: its score, and the parameters that acted.
    pub(super) best: Option<(f64, Vec<f32>)>,
    pub(super) learned: Learned,
    /// One for each candidate of the generation at hand; none between generations.
    slots: Vec<Slot>,
}

/// One candidate.
#[derive(Default)]
enum Slot {
    #[default]
    Waiting,
    /// Its own training, as far as it is.
    Training(Archive),
    Scored(Scored),
}

/// One candidate, scored.
#[derive(Default)]
pub(super) struct Scored {
    /// The parameters that acted: of the whole policy.
    pub(super) params: Vec<f32>,
    /// Mean discounted and undiscounted return; none where it failed.
    pub(super) returns: Option<(f64, f64)>,
    /// Steps taken.
    pub(super) env_steps: u64,
    /// Episodes whose physics failed.
    pub(super) discarded_episodes: u64,
    /// What the controller saw, where a filter wants to know.
    pub(super) seen: Vec<f32>,
}

impl State {
    /// From the beginning, or from where a search was interrupted; a policy has so many parameters.
    pub(super) fn new(
        search: Box<dyn Search>,
        filter: Option<StateFilter>,
        parameters: usize,
        from: Option<&Archive>,
    ) -> Result<Self, StateError> {
        let mut state = Self { search, filter, best: None, learned: Learned::default(), slots: Vec::new() };
        if let Some(archive) = from {
            state.load(archive)?;
            state.check_params(parameters)?;
        }
        Ok(state)
    }

    /// Parameters that act are exchanged as they are: candidates that nobody has scored have none.
    fn check_params(&self, wanted: usize) -> Result<(), StateError> {
        let best = self.best.iter().map(|(_, params)| ("best.params".to_owned(), params.len()));
        let scored = self.slots.iter().enumerate().filter_map(|(i, slot)| match slot {
            Slot::Scored(scored) => Some((format!("candidate.{i}.scored.params"), scored.params.len())),
            _ => None,
        });
        match best.chain(scored).find(|(_, found)| *found != wanted) {
            Some((name, found)) => Err(StateError::Length { name, found, wanted }),
            None => Ok(()),
        }
    }

    pub(super) fn checkpoint(&mut self, clock: Clock) -> Result<Checkpoint, StateError> {
        self.learned.wall_s = clock.wall_s();
        let archive = self.save()?;
        Ok(self.learned.checkpoint(archive))
    }
}

impl Persist for State {
    fn exchange(&mut self, with: &mut Exchange<'_>) -> Result<(), StateError> {
        with.part("loop", &mut self.learned)?;
        with.part("search", &mut *self.search)?;
        if let Some(filter) = &mut self.filter {
            with.part("filter", filter)?;
        }
        let (mut score, mut params) = (Vec::new(), Vec::new());
        if let Some((best, of)) = self.best.take() {
            (score, params) = (vec![best], of);
        }
        with.series("best.score", &mut score)?;
        with.series("best.params", &mut params)?;
        self.best = score.first().map(|&score| (score, params));
        let mut kinds: Vec<u64> = self.slots.iter().map(Slot::kind).collect();
        with.series("candidates", &mut kinds)?;
        if with.loads() {
            if !kinds.is_empty() && kinds.len() != self.search.ask().len() {
                return Err(with.refuse("candidates", kinds.len() as f64, "the size of this generation"));
            }
            self.slots = kinds.iter().map(|&kind| Slot::of(kind)).collect();
        }
        for (i, slot) in self.slots.iter_mut().enumerate() {
            with.part(&format!("candidate.{i}"), slot)?;
        }
        Ok(())
    }
}

impl Slot {
    fn kind(&self) -> u64 {
        match self {
            Self::Waiting => 0,
            Self::Training(_) => 1,
            Self::Scored(_) => 2,
        }
    }

    /// A blank one.
    fn of(kind: u64) -> Self {
        match kind {
            0 => Self::Waiting,
            1 => Self::Training(Archive::new()),
            _ => Self::Scored(Scored::default()),
        }
    }
}

impl Persist for Slot {
    fn exchange(&mut self, with: &mut Exchange<'_>) -> Result<(), StateError> {
        match self {
            Self::Waiting => Ok(()),
            Self::Training(archive) => with.archive("training", archive),
            Self::Scored(scored) => with.part("scored", scored),
        }
    }
}

impl Persist for Scored {
    fn exchange(&mut self, with: &mut Exchange<'_>) -> Result<(), StateError> {
        with.series("params", &mut self.params)?;
        let mut returns = self.returns.map_or(Vec::new(), |r| vec![r.0, r.1]);
        with.series("returns", &mut returns)?;
        self.returns = returns.first_chunk().map(|&[discounted, undiscounted]| (discounted, undiscounted));
        with.number("env_steps", &mut self.env_steps)?;
        with.number("discarded_episodes", &mut self.discarded_episodes)?;
        with.series("seen", &mut self.seen)
    }
}

/// The candidates of one generation.
pub(super) struct Generation<'a> {
    pub(super) problem: &'a Candidates<'a>,
    pub(super) candidates: &'a [Vec<f64>],
}

impl Generation<'_> {
    /// Scores all candidates that are not scored yet.
    pub(super) fn score(&self, state: &mut State, run: &mut Loop<'_>) -> Result<Vec<Scored>, TrainError> {
        state.slots.resize_with(self.candidates.len(), Slot::default);
        let generation = state.search.generation();
        let groups: Vec<u64> = (0..self.candidates.len()).map(|i| state.search.group(i)).collect();
        let filter = state.filter.clone();
        let spec = self.problem.assembly.experiment();
        let (stop, clock) = (run.stop, run.clock);
        let desk = Mutex::new(Desk { state, observer: &mut *run.observer, clock });
        let done = run.executor.map(self.candidates.len(), |i| {
            let from = match &lock(&desk).state.slots[i] {
                Slot::Scored(_) => return Ok(()),
                Slot::Training(archive) => Some(archive.clone()),
                Slot::Waiting => None,
            };
            if stop.load(Ordering::Relaxed) {
                return Ok(());
            }
            let params = self.problem.acting(&self.candidates[i], filter.as_ref());
            let scored = if spec.method.trains_inside() {
                let mut observer = Inside { desk: &desk, slot: i, kept: Instant::now() };
                let mut inner = Loop { executor: &Serial, observer: &mut observer, stop, clock };
                self.problem.train_inside(params, generation, &mut inner, from.as_ref())?
            } else {
                let (episodes, group) = (spec.search.episodes as u64, groups[i]);
                self.problem.run(params, generation, group * episodes..(group + 1) * episodes, filter.is_some())
            };
            let mut desk = lock(&desk);
            desk.state.slots[i] = Slot::Scored(scored);
            desk.keep_if_due()
        });
        for result in done {
            match result {
                Ok(()) | Err(TrainError::Interrupted { .. }) => {}
                Err(error) => return Err(error),
            }
        }
        if state.slots.iter().any(|slot| !matches!(slot, Slot::Scored(_))) {
            run.observer.on(Event::Checkpoint(&state.checkpoint(clock)?))?;
            let budget = spec.train.env_steps;
            return Err(TrainError::Interrupted { env_steps: state.learned.env_steps, budget });
        }
        let scored = |slot| if let Slot::Scored(scored) = slot { Some(scored) } else { None };
        Ok(std::mem::take(&mut state.slots).into_iter().filter_map(scored).collect())
    }
}

/// Where the candidates of a generation put what they have.
struct Desk<'a> {
    state: &'a mut State,
    observer: &'a mut dyn Observer,
    clock: Clock,
}

fn lock<'a, 'b>(desk: &'a Mutex<Desk<'b>>) -> MutexGuard<'a, Desk<'b>> {
    desk.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Desk<'_> {
    fn keep_if_due(&mut self) -> Result<(), TrainError> {
        if self.observer.due() {
            let checkpoint = self.state.checkpoint(self.clock)?;
            self.observer.on(Event::Checkpoint(&checkpoint))?;
        }
        Ok(())
    }
}

/// Watches the training of one candidate.
struct Inside<'a, 'b> {
    desk: &'a Mutex<Desk<'b>>,
    slot: usize,
    /// When it was last put onto the desk.
    kept: Instant,
}

impl Observer for Inside<'_, '_> {
    fn on(&mut self, event: Event<'_>) -> Result<(), ObserverError> {
        if let Event::Checkpoint(checkpoint) = event {
            self.kept = Instant::now();
            let mut desk = lock(self.desk);
            desk.state.slots[self.slot] = Slot::Training(checkpoint.archive.clone());
            desk.keep_if_due().map_err(|error| ObserverError(Box::new(error)))?;
        }
        Ok(())
    }

    fn due(&self) -> bool {
        self.kept.elapsed() >= STALE || lock(self.desk).observer.due()
    }
}
