//! Who trains whole experiments: the calling thread, or somebody elsewhere.

use std::sync::atomic::AtomicBool;

use hwasp_core::Serial;

use crate::assemble::Assembly;
use crate::checkpoint::Checkpoint;
use crate::collect::ExperimentText;
use crate::error::TrainError;
use crate::observer::Observer;
use crate::train::{Trained, train_from};
use crate::worker::Worker;

/// Whole trainings, for whoever asks: those of a comparison.
pub trait Trainer: Sync {
    /// Trains from the beginning or from a checkpoint, as [`train_from`] does on one thread: the result has the same
    /// bits whoever trains.
    ///
    /// # Errors
    /// As those of [`train`](crate::train).
    fn train(
        &self,
        from: Option<&Checkpoint>,
        assembly: &Assembly,
        observer: &mut dyn Observer,
        stop: &AtomicBool,
    ) -> Result<Trained, TrainError>;
}

/// The calling thread trains.
impl Trainer for Serial {
    fn train(
        &self,
        from: Option<&Checkpoint>,
        assembly: &Assembly,
        observer: &mut dyn Observer,
        stop: &AtomicBool,
    ) -> Result<Trained, TrainError> {
        train_from(from, assembly, self, observer, stop)
    }
}

impl Worker {
    /// Trains an experiment on one thread, as [`train_from`] does.
    ///
    /// # Errors
    /// [`TrainError::Assemble`] where the experiment cannot be set up here; otherwise as those of [`train`](crate::train).
    pub fn train(
        &self,
        experiment: &ExperimentText,
        from: Option<&Checkpoint>,
        observer: &mut dyn Observer,
        stop: &AtomicBool,
    ) -> Result<Trained, TrainError> {
        let prepared = self.prepared(experiment)?;
        train_from(from, &prepared.assembly, &Serial, observer, stop)
    }
}
