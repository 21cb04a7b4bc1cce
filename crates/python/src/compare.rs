//! Comparisons.

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use hwasp_core::{Serial, Threads};
use hwasp_study::{Comparison, Contender, Grid, Watch, Work, run};
use hwasp_training::{Event, TrainError};
use pyo3::prelude::*;

use crate::catalogue::catalogue;
use crate::command;
use crate::environment::Raised;
use crate::error::{self, Wrong};
use crate::experiment::Experiment;
use crate::log;
use crate::training::{attended, sound_threads};

/// Nobody watches; what fails is told by the table.
struct Quiet;

impl Watch for Quiet {
    fn grid(&self, _: &[(String, u64, bool)]) {}
    fn cell(&self, _: usize, _: Event<'_>) {}
    fn failed(&self, cell: usize, error: &TrainError) {
        tracing::warn!("cell {cell} failed: {error}");
    }
}

/// Trains methods against each other into a folder, and writes its tables; returns the table as Markdown.
#[pyfunction]
#[pyo3(signature = (experiment, *, methods, seeds, first_seed, out, threads, threshold))]
#[allow(clippy::too_many_arguments, reason = "the names are Python's keywords")]
pub(crate) fn compare(
    py: Python<'_>,
    experiment: &Experiment,
    methods: Vec<String>,
    seeds: u64,
    first_seed: u64,
    out: PathBuf,
    threads: usize,
    threshold: Option<f64>,
) -> PyResult<String> {
    log::begin();
    let threads = sound_threads(threads)?.get();
    let contenders = methods.iter().map(|text| Contender::parse(text)).collect::<Result<Vec<_>, _>>();
    let contenders = contenders.map_err(Wrong::input)?;
    let last = first_seed.checked_add(seeds).filter(|last| i64::try_from(*last).is_ok());
    let last =
        last.ok_or_else(|| error::input(format!("seeds from {first_seed} on, {seeds} of them, are too large")))?;
    let grid = Grid { layers: experiment.layers().clone(), contenders, seeds: first_seed..last };
    let problem = experiment.layers().clone().with_override("method", "fixed");
    let problem = py.detach(|| hwasp_experiment::resolve(problem, None, &catalogue()));
    let raised = Raised::of(problem.as_ref().map_or("", |spec| spec.task.name()));
    let typed = command::line(py);
    let stop = Arc::new(AtomicBool::new(false));
    let stopped = Arc::clone(&stop);
    let compared = attended(py, Some(&stop), &raised, move || -> Result<String, Wrong> {
        let cells = grid.cells(&out, &catalogue()).map_err(Wrong::input)?;
        let first = cells.first().ok_or_else(|| Wrong::input("there is nothing to compare: name methods and seeds"))?;
        let executor = Threads::new(threads).map_err(Wrong::failed)?;
        let outcome =
            run(&cells, &executor, Work { command_line: &typed, watch: &Quiet, trainer: &Serial, stop: &stopped })
                .map_err(Wrong::input)?;
        let comparison = Comparison::new(&first.experiment(), &outcome, threshold).map_err(Wrong::failed)?;
        comparison.write(&out, &outcome.finished, &first.plot_options()).map_err(Wrong::failed)?;
        if outcome.unfinished() > 0 && !stopped.load(Ordering::Relaxed) {
            let text = format!("{} of {} cells did not finish", outcome.unfinished(), cells.len());
            return Err(Wrong::failed(std::io::Error::other(text)));
        }
        Ok(comparison.markdown())
    });
    Ok(compared??)
}
