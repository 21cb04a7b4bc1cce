//! `hwasp plot`.

use hwasp_lab::SavedRun;
use hwasp_lab::plot::{curves, write_plot};

use crate::Failure;
use crate::args::PlotArgs;

pub(crate) fn run(args: &PlotArgs) -> Result<(), Failure> {
    let runs = args.runs.iter().map(|path| SavedRun::open(path)).collect::<Result<Vec<_>, _>>()?;
    let all = runs.iter().map(SavedRun::curve).collect::<Result<Vec<_>, _>>()?;
    let mut options = runs[0].plot_options(args.title.clone());
    for run in &runs[1..] {
        let further = run.plot_options(String::new()).panels;
        for panel in further {
            if !options.panels.iter().any(|p| p.column == panel.column) {
                options.panels.push(panel);
            }
        }
    }
    let plot = curves(&all, &options)?;
    for note in &plot.notes {
        eprintln!("note: {note}");
    }
    write_plot(&args.out, &plot)?;
    println!("{}", args.out.display());
    Ok(())
}
