//! The cells of a grid: a run folder each.

use std::path::PathBuf;
use std::sync::atomic::AtomicBool;

use hwasp_core::Serial;
use hwasp_experiment::EXPERIMENT;
use hwasp_plot::{PlotOptions, curves_svg, plot_options};
use hwasp_runs::metrics::MetricsTable;
use hwasp_runs::{Keeping, Provenance, Resumed, RunFolder, SUMMARY, SavedRun, Summary, saved_experiment};
use hwasp_training::{Assembly, Event, Observer, ObserverError, TrainError, train_from};

use crate::error::CompareError;

/// The folder of the cells.
pub(crate) const CELLS: &str = "cells";

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
#[derive(Clone, Debug)]
pub struct CellResult {
    /// The contender.
    pub label: String,
    /// Its figures.
    pub summary: Summary,
    /// Its learning curve.
    pub metrics: MetricsTable,
}

/// Is told how the cells get on, from several threads.
pub trait Watch: Sync {
    /// The grid is known: labels of the cells, real steps of each, and whether it was there already.
    fn grid(&self, cells: &[(String, u64, bool)]);
    /// Something happened in a cell.
    fn cell(&self, cell: usize, event: Event<'_>);
    /// A cell failed; the others go on.
    fn failed(&self, cell: usize, error: &TrainError);
}

impl Cell {
    /// Whether its run is there and done.
    pub(crate) fn is_finished(&self) -> Result<bool, CompareError> {
        if !self.is_begun() {
            return Ok(false);
        }
        if saved_experiment(&self.path, &[], self.assembly.experiment().catalogue())? != *self.assembly.experiment() {
            return Err(CompareError::Other { path: self.path.clone() });
        }
        Ok(self.path.join(SUMMARY).is_file())
    }

    /// Whether there is something to go on from.
    fn is_begun(&self) -> bool {
        self.path.join(EXPERIMENT).is_file()
    }

    pub(crate) fn result(&self) -> Result<CellResult, CompareError> {
        let saved = SavedRun::open(&self.path, self.assembly.experiment().catalogue())?;
        Ok(CellResult { label: self.label.clone(), summary: saved.summary()?, metrics: saved.metrics()? })
    }

    pub(crate) fn train(
        &self,
        index: usize,
        command_line: &[String],
        watch: &dyn Watch,
        stop: &AtomicBool,
    ) -> Result<Option<CellResult>, CompareError> {
        let spec = self.assembly.experiment();
        let (provenance, keeping) = (Provenance::new(command_line.to_vec(), 1, self.seed), Keeping::default());
        let Resumed { mut folder, found } = if self.is_begun() {
            RunFolder::resume(&self.path, spec, provenance, keeping)?
        } else {
            RunFolder::create(&self.path, spec, &provenance, keeping)?.into()
        };
        found.warn();
        let mut told = Told { index, watch };
        let mut observers: Vec<&mut dyn Observer> = vec![&mut folder, &mut told];
        let from = found.checkpoint.as_ref();
        let trained = train_from(from, &self.assembly, &Serial, &mut observers, stop);
        drop(observers);
        match trained {
            Ok(trained) => {
                folder.finish(&self.assembly, &trained, &curves_svg)?;
                // There may be hundreds of cells.
                folder.remove_checkpoints()?;
                self.result().map(Some)
            }
            Err(TrainError::Interrupted { .. }) => {
                folder.settle()?;
                Ok(None)
            }
            Err(error) => {
                watch.failed(index, &error);
                Ok(None)
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
