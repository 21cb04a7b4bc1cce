//! `hwasp reproduce`.

use hwasp_experiment::Catalogue;
use std::path::PathBuf;

use hwasp_study::{FIGURES, PaperFigure};

use super::compare::{How, run_grid};
use super::stop_on_signal;
use crate::args::ReproduceArgs;
use crate::output;
use hwasp_session::Failure;

pub(crate) fn run(args: &ReproduceArgs, catalogue: &Catalogue) -> Result<(), Failure> {
    let Some(figure) = PaperFigure::find(&args.figure) else {
        let known: Vec<String> = FIGURES.iter().map(|f| format!("  {:<12} {}", f.name, f.about)).collect();
        let message =
            format!("`{}` is none of the paper's figures that can be reproduced:\n{}", args.figure, known.join("\n"));
        return Err(Failure::input(message));
    };
    let quick = if args.quick { "-quick" } else { "" };
    let folder =
        args.out.clone().unwrap_or_else(|| PathBuf::from("runs").join(format!("reproduce-{}{quick}", figure.name)));
    output::remark(&format!("{}: {}", figure.name, figure.about));
    let stop = stop_on_signal()?;
    let how = How { threads: args.threads, elsewhere: args.server.elsewhere(), quiet: false, stop: &stop };
    let mut failed = None;
    for experiment in figure.experiments {
        let grid = figure.grid(experiment, args.quick, catalogue).map_err(Failure::input)?;
        let folder = folder.join(experiment.replace('/', "-"));
        let ran = run_grid(&grid, catalogue, &folder, None, &how)?;
        output::print(&ran.text)?;
        // Trainings that failed keep nobody from the other experiments.
        failed = failed.or(ran.failed);
        let beside = figure.beside(experiment, &ran.outcome);
        if !beside.is_empty() {
            output::print(&format!("\n{beside}\n"))?;
        }
    }
    failed.map_or(Ok(()), Err)
}
