//! What a training tells of itself. Nothing inside prints.

use crate::evaluate::Evaluation;
use crate::metrics::MetricsRow;

/// Something happened.
#[derive(Clone, Copy, Debug)]
pub enum Event<'a> {
    /// Training begins.
    Started {
        /// Real simulator steps it will take, at least.
        env_steps: u64,
        /// The names of the design totals.
        totals: &'a [String],
    },
    /// An iteration is done.
    Iteration(&'a MetricsRow),
    /// The held-out evaluation begins.
    Evaluating,
    /// It is done.
    Evaluated(&'a Evaluation),
}

/// Is told what happens. An error ends the training.
pub trait Observer {
    /// Takes an event.
    fn on(&mut self, event: Event<'_>) -> Result<(), ObserverError>;
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
}
