//! `hwasp graph`.

use hwasp_experiment::Catalogue;
use hwasp_plot::drawing;

use super::{experiment, write_out};
use crate::args::GraphArgs;
use crate::output;
use hwasp_session::Failure;

pub(crate) fn run(args: &GraphArgs, catalogue: &Catalogue) -> Result<(), Failure> {
    let (_, assembly) = experiment(&args.experiment.experiment, &args.experiment.settings, &[], catalogue)?;
    let drawing = drawing(&assembly);
    let Some(path) = &args.out else {
        return Ok(output::print(&drawing.dot)?);
    };
    let extension = path.extension().and_then(|e| e.to_str()).map(str::to_ascii_lowercase);
    let text = match extension.as_deref() {
        Some("svg") => drawing.svg,
        Some("dot" | "gv") => drawing.dot,
        _ => {
            let text = "names no format to draw in: end it in .svg, or in .dot or .gv for Graphviz";
            return Err(Failure::input(format!("`{}` {text}", path.display())));
        }
    };
    write_out(path, &text)?;
    Ok(output::print(&format!("{}\n", path.display()))?)
}
