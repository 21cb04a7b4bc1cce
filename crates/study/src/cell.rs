//! The cells of a grid: a run folder each.

use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use hwasp_experiment::EXPERIMENT;
use hwasp_plot::{PlotOptions, curves_svg, plot_options};
use hwasp_runs::metrics::MetricsTable;
use hwasp_runs::{
    Keeping, Provenance, Resumed, RunError, RunFolder, SUMMARY, SavedRun, Summary, encode, saved_experiment,
};
use hwasp_training::{Assembly, Event, Observer, ObserverError, TrainError, Trainer, moved};

use crate::error::CompareError;
use crate::failure::{Failure, MissingSeed};

/// The folder of the cells.
pub(crate) const CELLS: &str = "cells";
/// How often a cell is looked at that another process trains.
const PAUSE: Duration = Duration::from_millis(300);

/// One training of a grid.
#[derive(Clone)]
pub struct Cell {
    /// The contender.
    pub label: String,
    /// Its seed.
    pub seed: u64,
    /// Its run folder.
    pub path: PathBuf,
    pub(crate) assembly: Assembly,
}

/// A cell that is done.
#[derive(Clone, Debug, PartialEq)]
pub struct CellResult {
    /// The contender.
    pub label: String,
    /// Its figures.
    pub summary: Summary,
    /// Its learning curve.
    pub metrics: MetricsTable,
    /// Whether its training changed no parameter ([`moved`]).
    pub unchanged: bool,
}

/// Is told how the cells get on, from several threads.
pub trait Watch: Sync {
    /// The grid is known: labels of the cells, real steps of each, and whether it was there already.
    fn grid(&self, cells: &[(String, u64, bool)]);
    /// Something happened in a cell.
    fn cell(&self, cell: usize, event: Event<'_>);
    /// A cell failed; the others go on.
    fn failed(&self, cell: usize, error: &TrainError);
    /// A cell failed in an earlier comparison, for this reason, and is not tried again.
    fn failed_before(&self, _cell: usize, _reason: &str) {}
    /// A cell is trained by another process, which calls itself so; its result is waited for.
    fn waiting(&self, _cell: usize, _owner: &str) {}
    /// The other process has brought the cell to its end.
    fn joined(&self, _cell: usize) {}
}

/// How far a cell is.
pub(crate) enum State {
    /// There is something to do.
    Open,
    /// It is done.
    Finished,
    /// It failed, and would again.
    Failed(Failure),
}

/// What became of a cell.
#[derive(Clone, Debug, PartialEq)]
pub enum CellAnswer {
    /// It is done.
    Finished(Box<CellResult>),
    /// It is not.
    Missing(MissingSeed),
    /// Another process is at it, which calls itself so.
    Held(String),
}

/// How a cell is worked on.
#[derive(Clone, Copy)]
pub struct Work<'a> {
    /// The command, for the provenance of its run folder.
    pub command_line: &'a [String],
    /// Is told how it gets on.
    pub watch: &'a dyn Watch,
    /// Who trains.
    pub trainer: &'a dyn Trainer,
    /// Ends the work when it is set.
    pub stop: &'a AtomicBool,
}

impl Work<'_> {
    pub(crate) fn stopped(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }
}

impl Cell {
    /// How far it is.
    ///
    /// # Errors
    /// [`CompareError::Other`] where its folder holds another experiment.
    pub(crate) fn state(&self) -> Result<State, CompareError> {
        if !self.is_begun() {
            return Ok(State::Open);
        }
        if saved_experiment(&self.path, &[], self.assembly.experiment().catalogue())? != *self.assembly.experiment() {
            return Err(CompareError::Other { path: self.path.clone() });
        }
        if self.path.join(SUMMARY).is_file() {
            return Ok(State::Finished);
        }
        Ok(Failure::read(&self.path, &self.experiment_text()?)?.map_or(State::Open, State::Failed))
    }

    /// Its experiment, every setting resolved, as TOML.
    pub fn experiment_text(&self) -> Result<String, RunError> {
        self.assembly.experiment().to_toml().map_err(|error| encode(EXPERIMENT, &error))
    }

    /// Whether there is something to go on from.
    fn is_begun(&self) -> bool {
        self.path.join(EXPERIMENT).is_file()
    }

    pub(crate) fn result(&self) -> Result<CellResult, CompareError> {
        let saved = SavedRun::open(&self.path, self.assembly.experiment().catalogue())?;
        let unchanged = !moved(saved.assembly(), None, &saved.params()?);
        Ok(CellResult { label: self.label.clone(), summary: saved.summary()?, metrics: saved.metrics()?, unchanged })
    }

    /// Why it has no figures where nothing failed.
    pub(crate) fn stopped(&self) -> MissingSeed {
        let how = if self.is_begun() { "the comparison was stopped on the way" } else { "it was not begun" };
        MissingSeed::unfinished(self.seed, how)
    }

    /// Brings it to its end, unless another process is at it. `index` is how `watch` knows it.
    ///
    /// # Errors
    /// Of its folder. A training that fails is an answer.
    pub fn work(&self, index: usize, work: Work<'_>) -> Result<CellAnswer, CompareError> {
        loop {
            match self.state()? {
                State::Finished => return Ok(CellAnswer::Finished(Box::new(self.result()?))),
                State::Failed(failure) => {
                    return Ok(CellAnswer::Missing(MissingSeed::failed(self.seed, &failure.reason)));
                }
                State::Open if work.stopped() => return Ok(CellAnswer::Missing(self.stopped())),
                State::Open => match self.open(work) {
                    Ok(resumed) => return self.train(index, resumed, work),
                    Err(RunError::InUse { owner, .. }) => return Ok(CellAnswer::Held(owner)),
                    // Another process finished it, or began it, between our look and our grasp: look again.
                    Err(RunError::Finished { .. }) => {}
                    Err(RunError::Exists { .. }) if self.is_begun() => {}
                    Err(error) => return Err(error.into()),
                },
            }
        }
    }

    /// Waits for another process to end with it, and takes it over where that gave up.
    pub(crate) fn wait(&self, index: usize, owner: &str, work: Work<'_>) -> Result<CellAnswer, CompareError> {
        work.watch.waiting(index, owner);
        loop {
            std::thread::sleep(PAUSE);
            if work.stopped() {
                return Ok(CellAnswer::Missing(self.stopped()));
            }
            if !matches!(self.state()?, State::Open) {
                work.watch.joined(index);
            }
            match self.work(index, work)? {
                CellAnswer::Held(_) => {}
                worked => return Ok(worked),
            }
        }
    }

    fn open(&self, work: Work<'_>) -> Result<Resumed, RunError> {
        let provenance = Provenance::new(work.command_line.to_vec(), 1, self.seed);
        let (spec, keeping) = (self.assembly.experiment(), Keeping::default());
        if self.is_begun() {
            RunFolder::resume(&self.path, spec, provenance, keeping)
        } else {
            Ok(RunFolder::create(&self.path, spec, &provenance, keeping)?.into())
        }
    }

    fn train(&self, index: usize, resumed: Resumed, work: Work<'_>) -> Result<CellAnswer, CompareError> {
        let Resumed { mut folder, found } = resumed;
        found.warn();
        let mut told = Told { index, watch: work.watch };
        let mut observers: Vec<&mut dyn Observer> = vec![&mut folder, &mut told];
        let from = found.checkpoint.as_ref();
        let trained = work.trainer.train(from, &self.assembly, &mut observers, work.stop);
        drop(observers);
        match trained {
            Ok(trained) => {
                folder.finish(&self.assembly, &trained, &curves_svg)?;
                // There may be hundreds of cells.
                folder.remove_checkpoints()?;
                Ok(CellAnswer::Finished(Box::new(self.result()?)))
            }
            Err(TrainError::Interrupted { .. }) => {
                folder.settle()?;
                Ok(CellAnswer::Missing(self.stopped()))
            }
            Err(error) => {
                work.watch.failed(index, &error);
                let reason = error.to_string();
                Ok(CellAnswer::Missing(match Failure::of(&error, &self.experiment_text()?) {
                    Some(failure) => {
                        failure.write(&self.path)?;
                        MissingSeed::failed(self.seed, &reason)
                    }
                    None => MissingSeed::unfinished(self.seed, &reason),
                }))
            }
        }
    }

    /// The experiment's name.
    pub fn experiment(&self) -> String {
        self.assembly.experiment().name.clone()
    }

    /// Axis texts, units and known optima for pictures of such runs.
    pub fn plot_options(&self) -> PlotOptions {
        plot_options(&self.assembly, String::new())
    }
}

/// Passes a cell's events on.
struct Told<'a> {
    index: usize,
    watch: &'a dyn Watch,
}

impl Observer for Told<'_> {
    fn on(&mut self, event: Event<'_>) -> Result<(), ObserverError> {
        self.watch.cell(self.index, event);
        Ok(())
    }
}
