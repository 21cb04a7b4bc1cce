//! Where a search stands: between two generations, and within one.

use hwasp_algos::{Archive, Exchange, Persist, Search, StateError, StateFilter};

use crate::checkpoint::Checkpoint;
use crate::collect::CandidateFailure;
use crate::learned::{Clock, Learned};
use crate::returns::Returns;

/// A search.
pub(super) struct State {
    pub(super) search: Box<dyn Search>,
    pub(super) filter: Option<StateFilter>,
    /// The best candidate so far: its score, and the parameters that acted.
    pub(super) best: Option<(f64, Vec<f32>)>,
    pub(super) learned: Learned,
    /// One for each candidate of the generation at hand; none between generations.
    pub(super) slots: Vec<Slot>,
}

/// One candidate.
#[derive(Default)]
pub(super) enum Slot {
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
    /// What its episodes came to; none where it failed.
    pub(super) returns: Option<Returns>,
    /// Why it failed, where it did.
    pub(super) failure: Option<CandidateFailure>,
    /// Steps taken.
    pub(super) env_steps: u64,
    /// Episodes whose physics failed.
    pub(super) discarded_episodes: u64,
    /// Mean and deviation of what the controller saw, where a filter wants to know; nothing seen where the candidate failed.
    pub(super) seen: Option<StateFilter>,
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
            Slot::Waiting | Slot::Training(_) => None,
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
        self.best = match score[..] {
            [] => None,
            [score] => Some((score, params)),
            _ => return Err(with.refuse("best.score", score.len() as f64, "the length of one score or none")),
        };
        let mut kinds: Vec<u64> = self.slots.iter().map(Slot::kind).collect();
        with.series("candidates", &mut kinds)?;
        if with.loads() {
            // A last generation may be smaller.
            if kinds.len() > self.search.ask().len() {
                return Err(with.refuse("candidates", kinds.len() as f64, "the size of this generation, at most"));
            }
            let wrong = |kind| with.refuse("candidates", kind as f64, "0 (waits), 1 (trains) or 2 (is scored)");
            let seen = self.filter.as_ref().map(StateFilter::blank);
            let slot = |&kind: &u64| Slot::of(kind, seen.as_ref()).ok_or_else(|| wrong(kind));
            self.slots = kinds.iter().map(slot).collect::<Result<_, _>>()?;
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

    /// A blank one of a kind, which has seen nothing.
    fn of(kind: u64, seen: Option<&StateFilter>) -> Option<Self> {
        match kind {
            0 => Some(Self::Waiting),
            1 => Some(Self::Training(Archive::new())),
            2 => Some(Self::Scored(Scored { seen: seen.cloned(), ..Scored::default() })),
            _ => None,
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

impl Scored {
    /// Why it failed; none where it has returns.
    pub(super) fn failure(&self) -> Option<CandidateFailure> {
        if self.returns.is_some() {
            return None;
        }
        // Checkpoints that were written before failures were kept have none.
        let unknown = || "it failed before the search was resumed, and how was not written down".to_owned();
        let failure = self.failure.clone();
        Some(failure.unwrap_or_else(|| CandidateFailure { cause: unknown(), text: unknown() }))
    }
}

impl Persist for Scored {
    fn exchange(&mut self, with: &mut Exchange<'_>) -> Result<(), StateError> {
        with.series("params", &mut self.params)?;
        let flat = |r: &Returns| [&[r.discounted, r.undiscounted], &*r.terms].concat();
        let mut returns = self.returns.as_ref().map_or(Vec::new(), flat);
        with.series("returns", &mut returns)?;
        self.returns = match returns[..] {
            [] => None,
            [discounted, undiscounted, ref terms @ ..] => {
                Some(Returns { discounted, undiscounted, terms: terms.to_vec() })
            }
            [_] => return Err(with.refuse("returns", 1.0, "the length of a pair of returns, or of none")),
        };
        let (mut cause, mut text) = self.failure.take().map_or((None, None), |f| (Some(f.cause), Some(f.text)));
        with.text("failure.cause", &mut cause)?;
        with.text("failure.text", &mut text)?;
        self.failure = cause.zip(text).map(|(cause, text)| CandidateFailure { cause, text });
        with.number("env_steps", &mut self.env_steps)?;
        with.number("discarded_episodes", &mut self.discarded_episodes)?;
        self.seen.as_mut().map_or(Ok(()), |seen| with.part("seen", seen))
    }
}
