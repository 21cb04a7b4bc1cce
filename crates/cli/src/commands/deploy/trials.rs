//! `hwasp deploy trials`.

use std::fmt::Write;

use hwasp_deploy::date;
use hwasp_deploy::trials::{Rate, Trial, add, rates, read};
use hwasp_experiment::Catalogue;

use super::super::run_folder;
use crate::args::DeployTrialsArgs;
use crate::output;
use hwasp_session::Failure;

pub(crate) fn run(args: &DeployTrialsArgs, catalogue: &Catalogue) -> Result<(), Failure> {
    let trials = match (args.shape, args.held, &args.run) {
        (Some(shape), Some(held), Some(run)) => {
            let spec = hwasp_runs::saved_experiment(run_folder(run)?, &[], catalogue).map_err(Failure::input)?;
            let size = args.size.unwrap_or_default().map(|mm| 1e-3 * mm);
            let (task, run) = (spec.task.name().to_owned(), run.display().to_string());
            let trial =
                Trial { date: date::now(), task, run, shape: shape.kind(), size, held, note: args.note.clone() };
            add(&args.table, &[trial])
        }
        _ => read(&args.table),
    };
    let trials = trials.map_err(Failure::input)?;
    if trials.is_empty() {
        let hint = "`hwasp deploy run` adds to it, or --shape with --held and --run";
        return Err(Failure::input(format!("{} has no trials yet", args.table.display())).hint(hint));
    }
    Ok(output::print(&table(&rates(&trials)))?)
}

/// Rates, one a line.
pub(super) fn table(rates: &[Rate]) -> String {
    let mut text = "  task       shape      held         share   95 % (Wilson)    paper\n".to_owned();
    for Rate { task, shape, held, trials, interval, paper } in rates {
        let share = 100.0 * *held as f64 / (*trials).max(1) as f64;
        let paper = paper.map_or_else(|| "-".to_owned(), |share| format!("{share:.0} %"));
        let (low, high) = (100.0 * interval.low, 100.0 * interval.high);
        let of = format!("{held} of {trials}");
        let _ = writeln!(
            text,
            "  {task:<10} {:<10} {of:<12} {share:>3.0} %   {low:>3.0} to {high:>3.0} %     {paper:>6}",
            shape.name()
        );
    }
    text
}
