//! `hwasp compare`.

use hwasp_experiment::Catalogue;
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

use hwasp_core::Threads;
use hwasp_study::{self as study, CellResult, CompareError, Comparison, Contender, Grid};

use super::{layers, stop_on_signal, typed};
use crate::args::CompareArgs;
use crate::failure::Failure;
use crate::grid_progress::GridProgress;
use crate::output;

pub(crate) fn run(args: &CompareArgs, catalogue: &Catalogue) -> Result<(), Failure> {
    let contenders = args.methods.iter().map(|text| Contender::parse(text)).collect::<Result<Vec<_>, _>>();
    let contenders = contenders.map_err(Failure::input)?;
    let further: Vec<_> = args.env_steps.map(|steps| ("env-steps", steps.to_string())).into_iter().collect();
    let layers = layers(&args.experiment, &args.set, &further, catalogue)?;
    let name = Path::new(&args.experiment).file_stem().map_or("experiment".into(), |stem| stem.to_string_lossy());
    let folder = args.out.clone().unwrap_or_else(|| PathBuf::from("runs").join(format!("compare-{name}")));
    let grid = Grid { layers, contenders, seeds: 0..args.seeds };
    let experiment =
        run_grid(&grid, catalogue, &folder, args.threads, args.threshold, args.quiet, &*stop_on_signal()?)?.0;
    if !args.quiet {
        output::print(&experiment)?;
    }
    Ok(())
}

/// Runs a grid into a folder and writes its tables and pictures. Returns what to print, and the cells.
pub(super) fn run_grid(
    grid: &Grid,
    catalogue: &Catalogue,
    folder: &Path,
    threads: Option<NonZeroUsize>,
    threshold: Option<f64>,
    quiet: bool,
    stop: &AtomicBool,
) -> Result<(String, Vec<CellResult>), Failure> {
    // Everything that was asked for is checked before the first cell begins.
    let cells = grid.cells(folder, catalogue).map_err(Failure::input)?;
    let first = cells.first().ok_or_else(|| Failure::input("there is nothing to compare"))?;
    let threads = threads.map_or_else(default_threads, NonZeroUsize::get);
    let progress = GridProgress::new(quiet, threads);
    let executor = Threads::new(threads)?;
    let results = study::run(&cells, &executor, &typed(), &progress, stop).map_err(|error| match error {
        CompareError::Other { .. } => Failure::input(error),
        _ => error.into(),
    })?;
    progress.finish();
    let missing = cells.len() - results.len();
    let unfinished = || Failure::from(Unfinished { missing, folder: folder.to_owned() });
    if results.is_empty() {
        return Err(unfinished());
    }
    let comparison = Comparison::new(&first.experiment(), &results, threshold)?;
    comparison.write(folder, &results, &first.plot_options())?;
    if missing > 0 {
        return Err(unfinished());
    }
    let files = "table.md, table.csv, comparison.json, curves.svg, time.svg";
    Ok((format!("{}\n{}: {files}\n", comparison.markdown(), folder.display()), results))
}

/// All that the machine has: cells do not wait for each other.
fn default_threads() -> usize {
    std::thread::available_parallelism().map_or(1, NonZeroUsize::get)
}

/// Cells that did not come to their end.
#[derive(Debug, thiserror::Error)]
#[error("{missing} of the cells did not finish; the same command goes on with them, into {}", folder.display())]
struct Unfinished {
    missing: usize,
    folder: PathBuf,
}
