//! `hwasp plot`.

use hwasp_experiment::Catalogue;
use hwasp_plot::{PlotError, PlotOptions, curves, plot_options, saved_curve, write_plot};

use super::saved_run;
use crate::args::PlotArgs;
use crate::output;
use hwasp_session::Failure;

pub(crate) fn run(args: &PlotArgs, catalogue: &Catalogue) -> Result<(), Failure> {
    let runs = args.runs.iter().map(|path| saved_run(path, &[], catalogue)).collect::<Result<Vec<_>, _>>()?;
    let x_axis = args.axis.axis();
    let all = runs.iter().map(|run| saved_curve(run, x_axis)).collect::<Result<Vec<_>, _>>().map_err(Failure::input)?;
    let mut options =
        PlotOptions { x_axis, theme: args.theme.theme(), ..plot_options(runs[0].assembly(), args.title.clone()) };
    for run in &runs[1..] {
        let further = plot_options(run.assembly(), String::new()).panels;
        for panel in further {
            if !options.panels.iter().any(|p| p.column == panel.column) {
                options.panels.push(panel);
            }
        }
    }
    let plot = curves(&all, &options).map_err(Failure::input)?;
    for note in &plot.notes {
        output::remark(&format!("note: {note}"));
    }
    write_plot(&args.out, &plot).map_err(|error| match error {
        PlotError::Extension { .. } => Failure::input(error),
        _ => error.into(),
    })?;
    Ok(output::print(&format!("{}\n", args.out.display()))?)
}
