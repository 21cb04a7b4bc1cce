//! `hwasp compare`.

use hwasp_experiment::{Catalogue, resolve};
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};

use hwasp_core::Threads;
use hwasp_runs::RunError;
use hwasp_study::{self as study, Cell, CompareError, Comparison, Contender, Grid, Outcome, Work};
use hwasp_training::STILL;

use super::{layers, stop_on_signal, typed};
use crate::args::CompareArgs;
use crate::grid_progress::GridProgress;
use crate::output;
use hwasp_session::Failure;
use hwasp_session::place;
use hwasp_session::{Crew, Elsewhere};

/// Cells that wait for workers at once, at most.
const MOST_AT_ONCE: usize = 512;
/// What is compared where nobody says what.
const METHODS: &str = "hwasp,minimal,cmaes,ars,cmaes-rl,ars-rl,bo-rl,random-rl,fixed";
/// The same where nothing is designed: the other methods would train the same, or have nothing to search.
const UNDESIGNED: &str = "fixed,cmaes,ars";

pub(crate) fn run(args: &CompareArgs, catalogue: &Catalogue) -> Result<(), Failure> {
    let asked = args.methods.iter().map(|text| Contender::parse_list(text)).collect::<Result<Vec<_>, _>>();
    let mut contenders = asked.map_err(Failure::input)?.concat();
    let further: Vec<_> = args.env_steps.map(|steps| ("env-steps", steps.to_string())).into_iter().collect();
    let layers = layers(&args.experiment, &args.set, &further, catalogue)?;
    if contenders.is_empty() {
        let experiment = resolve(layers.clone(), None, catalogue).map_err(Failure::input)?;
        let all = if experiment.task.groups().is_empty() { UNDESIGNED } else { METHODS };
        contenders = Contender::parse_list(all).map_err(Failure::input)?;
    }
    let name = Path::new(&args.experiment).file_stem().map_or("experiment".into(), |stem| stem.to_string_lossy());
    let folder = args.out.clone().unwrap_or_else(|| PathBuf::from("runs").join(format!("compare-{name}")));
    let grid = Grid { layers, contenders, seeds: args.first_seed..args.first_seed + args.seeds };
    let stop = stop_on_signal()?;
    let how = How { threads: args.threads, elsewhere: args.server.elsewhere(), quiet: args.quiet, stop: &stop };
    let ran = run_grid(&grid, catalogue, &folder, args.threshold, &how)?;
    if !args.quiet {
        output::print(&ran.text)?;
    }
    ran.failed.map_or(Ok(()), Err)
}

/// How a grid is run.
pub(super) struct How<'a> {
    /// Cells at once on this machine; all that it has where nobody says.
    pub(super) threads: Option<NonZeroUsize>,
    /// Workers that train them instead.
    pub(super) elsewhere: Option<Elsewhere>,
    /// Whether nothing but errors is told.
    pub(super) quiet: bool,
    /// Ends it.
    pub(super) stop: &'a AtomicBool,
}

/// A grid that came to its end.
pub(super) struct Ran {
    /// What to print.
    pub(super) text: String,
    /// What became of the cells.
    pub(super) outcome: Outcome,
    /// Why the program ends with a failure all the same: trainings failed.
    pub(super) failed: Option<Failure>,
}

/// Runs a grid into a folder and writes its tables and pictures.
///
/// # Errors
/// Where it was stopped, or something could not be written; not where trainings failed.
pub(super) fn run_grid(
    grid: &Grid,
    catalogue: &Catalogue,
    folder: &Path,
    threshold: Option<f64>,
    how: &How<'_>,
) -> Result<Ran, Failure> {
    let (quiet, stop) = (how.quiet, how.stop);
    // Everything that was asked for is checked before the first cell begins.
    let cells = grid.cells(folder, catalogue).map_err(Failure::input)?;
    let first = cells.first().ok_or_else(|| Failure::input("there is nothing to compare"))?;
    let crew = Crew::new(NonZeroUsize::MIN, how.elsewhere.as_ref(), &names(&cells, folder)?, catalogue)?;
    // Workers may come at any time: all cells wait for them at once.
    let all = if crew.is_elsewhere() { cells.len().min(MOST_AT_ONCE) } else { default_threads() };
    let threads = how.threads.filter(|_| !crew.is_elsewhere()).map_or(all, NonZeroUsize::get);
    let progress = GridProgress::new(quiet, threads);
    let executor = Threads::new(threads)?;
    let work = Work { command_line: &typed(), watch: &progress, trainer: crew.trainer(), stop };
    let ran = study::run(&cells, &executor, work);
    if stop.load(Ordering::Relaxed) || ran.is_err() {
        crew.stop();
    }
    let outcome = ran.map_err(|error| match error {
        CompareError::Other { .. } | CompareError::Run(RunError::Edited { .. }) => Failure::input(error),
        _ => error.into(),
    })?;
    progress.finish();
    if outcome.unfinished() == 0 {
        crew.finish();
    }
    let comparison = Comparison::new(&first.experiment(), &outcome, threshold)?;
    if let Err(unwritten) = comparison.write(folder, &outcome.finished, &first.plot_options()) {
        // What was found is told even if a disk is full by now.
        if !quiet {
            output::print(&format!("{}\n", comparison.markdown()))?;
        }
        return Err(unwritten.into());
    }
    for (method, seeds) in comparison.methods.iter().filter_map(|method| Some((&method.label, method.unchanged()?))) {
        tracing::warn!("{method}, {seeds}: the training changed nothing: {STILL}");
    }
    if let (Some(others), false) = (comparison.others(), quiet) {
        output::remark(&others);
    }
    if outcome.unfinished() > 0 {
        let unfinished = Unfinished { missing: outcome.unfinished(), cells: cells.len(), folder: folder.to_owned() };
        return Err(if stop.load(Ordering::Relaxed) { Failure::interrupted(unfinished) } else { unfinished.into() });
    }
    let pictures = if outcome.finished.is_empty() { "" } else { ", curves.svg, time.svg" };
    let text =
        format!("{}\n{}: table.md, table.csv, comparison.json{pictures}\n", comparison.markdown(), folder.display());
    let failed = outcome.missing.iter().find(|cell| cell.seed.failed).map(|first| {
        let failed = FailedCells { failed: outcome.failed(), cells: cells.len(), folder: folder.to_owned() };
        let cell = cells.iter().find(|cell| cell.label == first.label && cell.seed == first.seed.seed);
        let cell = cell.map_or_else(|| folder.to_owned(), |cell| cell.path.clone());
        Failure::from(failed).hint(&format!(
            "the same command does not repeat them, they would fail again; take other settings and another folder, or remove a \
             cell's folder, {} for one, to train it anew",
            cell.display()
        ))
    });
    Ok(Ran { text, outcome, failed })
}

/// What workers know a comparison by: its folder, and what is trained in it.
fn names(cells: &[Cell], folder: &Path) -> Result<Vec<String>, Failure> {
    let texts = cells.iter().map(Cell::experiment_text).collect::<Result<Vec<_>, _>>()?;
    Ok([vec![place(folder)?], texts].concat())
}

/// All that the machine has: cells do not wait for each other.
fn default_threads() -> usize {
    std::thread::available_parallelism().map_or(1, NonZeroUsize::get)
}

/// Cells that did not come to their end, and can.
#[derive(Debug, thiserror::Error)]
#[error("{missing} of {cells} cells did not finish; the same command goes on with them, into {}", folder.display())]
struct Unfinished {
    missing: usize,
    cells: usize,
    folder: PathBuf,
}

/// Cells whose training failed.
#[derive(Debug, thiserror::Error)]
#[error("{failed} of {cells} trainings failed; {} says why", folder.join("table.md").display())]
struct FailedCells {
    failed: usize,
    cells: usize,
    folder: PathBuf,
}
