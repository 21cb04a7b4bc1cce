//! What a training tells of itself. Nothing inside prints.

use hwasp_core::Batch;

use crate::checkpoint::Checkpoint;
use crate::evaluation::Evaluation;
use crate::metrics::MetricsRow;

/// Something happened.
#[derive(Clone, Copy, Debug)]
pub enum Event<'a> {
    /// Training begins, or goes on.
    Started {
        /// Real simulator steps it may take, at most.
        env_steps: u64,
        /// The steps that were taken before it was interrupted, where it goes on.
        resumed: Option<u64>,
        /// The names of the learner's metrics; none in a search.
        learner: &'a [&'a str],
        /// The names of the reward's terms; none where it has none, or where candidates of a search are trained.
        terms: &'a [String],
        /// The names of the design totals.
        totals: &'a [String],
    },
    /// An iteration is done.
    Iteration(&'a MetricsRow),
    /// All that it takes to go on from here: when an observer found one [due](Observer::due), when training is over, and
    /// when it was asked to stop.
    Checkpoint(&'a Checkpoint),
    /// An iteration failed, and with it the training.
    Failed(&'a FailedIteration<'a>),
    /// The held-out evaluation begins.
    Evaluating,
    /// It is done.
    Evaluated(&'a Evaluation),
}

/// All that it takes to see an iteration fail again.
#[derive(Clone, Copy, Debug)]
pub struct FailedIteration<'a> {
    /// Where training stood before the iteration.
    pub checkpoint: &'a Checkpoint,
    /// What it learned from, where it came so far.
    pub batch: Option<&'a Batch>,
    /// What went wrong.
    pub what: &'a str,
}

/// Is told what happens. An error ends the training.
pub trait Observer: Send {
    /// Takes an event.
    fn on(&mut self, event: Event<'_>) -> Result<(), ObserverError>;

    /// Whether it wants a checkpoint now. To make one costs as much as to copy everything that learns.
    fn due(&self) -> bool {
        false
    }
}

/// What an observer could not do.
#[derive(Debug, thiserror::Error)]
#[error(transparent)]
pub struct ObserverError(#[from] pub Box<dyn std::error::Error + Send + Sync>);

impl Observer for () {
    fn on(&mut self, _: Event<'_>) -> Result<(), ObserverError> {
        Ok(())
    }
}

/// One observer after the other.
impl Observer for Vec<&mut dyn Observer> {
    fn on(&mut self, event: Event<'_>) -> Result<(), ObserverError> {
        self.iter_mut().try_for_each(|observer| observer.on(event))
    }

    fn due(&self) -> bool {
        self.iter().any(|observer| observer.due())
    }
}
