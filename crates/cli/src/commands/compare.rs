//! `hwasp compare`.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use hwasp_core::{Executor, Threads};
use hwasp_lab::compare::{CompareError, Comparison, Contender, Grid};
use hwasp_lab::spec;

use super::stop_on_signal;
use crate::args::CompareArgs;
use crate::failure::Failure;
use crate::grid_progress::GridProgress;
use crate::output;

pub(crate) fn run(args: &CompareArgs) -> Result<(), Failure> {
    let contenders = args.methods.iter().map(|text| Contender::parse(text)).collect::<Result<Vec<_>, _>>();
    let contenders = contenders.map_err(Failure::input)?;
    let mut layers = spec::load(&args.experiment).map_err(Failure::input)?;
    for assignment in &args.set {
        layers = layers.with_assignment(assignment);
    }
    if let Some(steps) = args.env_steps {
        layers = layers.with_option(format!("--env-steps {steps}"), "train.env_steps", &steps.to_string());
    }
    let name = Path::new(&args.experiment).file_stem().map_or("experiment".into(), |stem| stem.to_string_lossy());
    let folder = args.out.clone().unwrap_or_else(|| PathBuf::from("runs").join(format!("compare-{name}")));
    let grid = Grid { layers, contenders, seeds: 0..args.seeds };
    // Everything that was asked for is checked before the first cell begins.
    let cells = grid.cells(&folder).map_err(Failure::input)?;

    let stop = Arc::new(AtomicBool::new(false));
    stop_on_signal(&stop)?;
    let threads = args.threads.map_or_else(default_threads, std::num::NonZeroUsize::get);
    let executor: Box<dyn Executor> = Box::new(Threads::new(threads)?);
    let progress = GridProgress::new(args.quiet, threads);
    let typed: Vec<String> = std::env::args_os().map(|arg| arg.to_string_lossy().into_owned()).collect();
    let results = grid.run(&folder, &*executor, &typed, &progress, &stop).map_err(|error| match error {
        CompareError::Other { .. } => Failure::input(error),
        _ => error.into(),
    })?;
    progress.finish();
    let missing = cells.len() - results.len();
    if results.is_empty() {
        return Err(Failure::from(Unfinished { missing, folder }));
    }
    let experiment = cells.first().map_or(String::new(), hwasp_lab::compare::Cell::experiment);
    let comparison = Comparison::new(&experiment, &results, args.threshold)?;
    let options = cells.first().map(hwasp_lab::compare::Cell::plot_options).unwrap_or_default();
    comparison.write(&folder, &results, &options)?;
    if !args.quiet {
        output::print(&comparison.markdown())?;
        output::print(&format!(
            "\n{}: table.md, table.csv, comparison.json, curves.svg, time.svg\n",
            folder.display()
        ))?;
    }
    if missing > 0 { Err(Failure::from(Unfinished { missing, folder })) } else { Ok(()) }
}

/// All that the machine has: cells do not wait for each other.
fn default_threads() -> usize {
    std::thread::available_parallelism().map_or(1, std::num::NonZeroUsize::get)
}

/// Cells that did not come to their end.
#[derive(Debug, thiserror::Error)]
#[error("{missing} of the cells did not finish; the same command goes on with them, into {}", folder.display())]
struct Unfinished {
    missing: usize,
    folder: PathBuf,
}
