//! Comparisons: a grid of methods and seeds under one budget, run in parallel, and what it says.
//!
//! A comparison is a folder. Each cell of the grid is a run folder in it, under `cells/`: a finished one is not run again,
//! an unfinished one is resumed, and one of another experiment is refused.

mod contender;
mod figures;
mod report;
mod reproduce;
mod saved;

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};

use hwasp_core::{Executor, Serial};
use thiserror::Error;

pub use contender::Contender;
pub use figures::{Figure, MethodFigures, Pair, Reached};
pub(crate) use report::COMPARISON;
pub use report::Comparison;
pub use reproduce::{FIGURES, PaperFigure};
pub(crate) use saved::SavedComparison;

use crate::assemble::{AssembleError, Assembly};
use crate::metrics::MetricsTable;
use crate::observer::{Event, Observer, ObserverError};
use crate::plot::{PlotError, PlotOptions};
use crate::run_folder::{EXPERIMENT, Keeping, Provenance, Resumed, RunError, RunFolder, SUMMARY, SavedRun, saved_spec};
use crate::spec::{Layers, SpecErrors, resolve};
use crate::stats::StatsError;
use crate::summary::Summary;
use crate::train::{TrainError, train_from};

/// The folder of the cells.
const CELLS: &str = "cells";

/// Why a comparison cannot be made.
#[derive(Debug, Error)]
pub enum CompareError {
    /// The experiment, for one of the methods.
    #[error(transparent)]
    Spec(#[from] SpecErrors),
    /// The experiment, put together for one of the methods.
    #[error("{label}: {source}")]
    Assemble {
        /// The contender.
        label: String,
        /// What is wrong.
        source: AssembleError,
    },
    /// A contender that is none.
    #[error("`{text}` names no method: {hint}")]
    Contender {
        /// What was written.
        text: String,
        /// What is possible.
        hint: String,
    },
    /// A contender named twice.
    #[error("`{0}` is named twice; name it once, and say with --seeds how often it is to be trained")]
    Twice(String),
    /// A cell that holds a run of another experiment.
    #[error("{path} holds another experiment, or one with other settings; name another folder with --out")]
    Other {
        /// The cell.
        path: PathBuf,
    },
    /// A place where there is something else.
    #[error("{path} is no folder of a comparison, and what is in it is not overwritten; name another one with --out")]
    Taken {
        /// The place.
        path: PathBuf,
    },
    /// A folder or file.
    #[error(transparent)]
    Run(#[from] RunError),
    /// A figure over the seeds.
    #[error(transparent)]
    Stats(#[from] StatsError),
    /// A picture.
    #[error(transparent)]
    Plot(#[from] PlotError),
}

/// What is compared.
#[derive(Clone, Debug)]
pub struct Grid {
    /// The experiment with its settings, before a method is chosen.
    pub layers: Layers,
    /// The methods.
    pub contenders: Vec<Contender>,
    /// The seeds of each.
    pub seeds: std::ops::Range<u64>,
}

/// One training of a grid.
#[derive(Clone)]
pub struct Cell {
    /// The contender.
    pub label: String,
    /// Its seed.
    pub seed: u64,
    /// Its run folder.
    pub path: PathBuf,
    assembly: Assembly,
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

impl Grid {
    /// The cells, contender by contender, every one checked.
    ///
    /// # Errors
    /// [`CompareError::Taken`] where `folder` holds something else, so that nothing is overwritten.
    pub fn cells(&self, folder: &Path) -> Result<Vec<Cell>, CompareError> {
        let is_empty = |mut entries: std::fs::ReadDir| entries.next().is_none();
        if folder.exists() && !folder.join(CELLS).is_dir() && !folder.read_dir().is_ok_and(is_empty) {
            return Err(CompareError::Taken { path: folder.to_owned() });
        }
        let mut cells = Vec::new();
        for (i, contender) in self.contenders.iter().enumerate() {
            if self.contenders[..i].iter().any(|other| other.label == contender.label) {
                return Err(CompareError::Twice(contender.label.clone()));
            }
            for seed in self.seeds.clone() {
                let layers = contender.apply(self.layers.clone()).with_override("seed", &seed.to_string());
                let spec = resolve(layers, Some(contender.method.name()))?;
                let assembly = Assembly::new(&spec)
                    .map_err(|source| CompareError::Assemble { label: contender.label.clone(), source })?;
                let name = format!("{}-seed{seed}", contender.folder_name());
                let path = folder.join(CELLS).join(name);
                cells.push(Cell { label: contender.label.clone(), seed, path, assembly });
            }
        }
        Ok(cells)
    }
}

/// Runs what is not finished yet, cells in parallel, each on one thread, and returns what is. Cells that failed are told to
/// `watch` and missing from the result. When `stop` is set, cells under way are left as they are, to be resumed.
pub fn run(
    cells: &[Cell],
    executor: &dyn Executor,
    command_line: &[String],
    watch: &dyn Watch,
    stop: &AtomicBool,
) -> Result<Vec<CellResult>, CompareError> {
    let finished = cells.iter().map(Cell::is_finished).collect::<Result<Vec<_>, _>>()?;
    let known = cells.iter().zip(&finished).map(|(cell, &finished)| {
        (format!("{} seed {}", cell.label, cell.seed), cell.assembly.spec().train.env_steps, finished)
    });
    watch.grid(&known.collect::<Vec<_>>());
    let results = executor.map(cells.len(), |i| {
        if finished[i] {
            return cells[i].result().map(Some);
        }
        if stop.load(Ordering::Relaxed) {
            return Ok(None);
        }
        cells[i].train(i, command_line, watch, stop)
    });
    results.into_iter().filter_map(Result::transpose).collect()
}

impl Cell {
    /// Whether its run is there and done.
    fn is_finished(&self) -> Result<bool, CompareError> {
        if !self.is_begun() {
            return Ok(false);
        }
        if saved_spec(&self.path, &[])? != *self.assembly.spec() {
            return Err(CompareError::Other { path: self.path.clone() });
        }
        Ok(self.path.join(SUMMARY).is_file())
    }

    /// Whether there is something to go on from.
    fn is_begun(&self) -> bool {
        self.path.join(EXPERIMENT).is_file()
    }

    fn result(&self) -> Result<CellResult, CompareError> {
        let saved = SavedRun::open(&self.path)?;
        Ok(CellResult { label: self.label.clone(), summary: saved.summary()?, metrics: saved.metrics()? })
    }

    fn train(
        &self,
        index: usize,
        command_line: &[String],
        watch: &dyn Watch,
        stop: &AtomicBool,
    ) -> Result<Option<CellResult>, CompareError> {
        let spec = self.assembly.spec();
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
                folder.finish(&self.assembly, &trained)?;
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
        self.assembly.spec().name.clone()
    }

    /// Axis texts, units and known optima for pictures of such runs.
    pub fn plot_options(&self) -> PlotOptions {
        self.assembly.plot_options(String::new())
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
