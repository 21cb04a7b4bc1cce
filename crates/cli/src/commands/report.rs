//! `hwasp report`.

use std::path::Path;

use hwasp_experiment::Catalogue;
use hwasp_report::report_in;

use super::{run_folder, write_out};
use crate::args::ReportArgs;
use crate::output;
use hwasp_session::Failure;

pub(crate) fn run(args: &ReportArgs, catalogue: &Catalogue) -> Result<(), Failure> {
    let folder = run_folder(&args.folder)?;
    let out = args.out.clone().unwrap_or_else(|| folder.join("report.html"));
    // A page under another name would be shown as text.
    let extension = out.extension().and_then(|e| e.to_str()).map(str::to_ascii_lowercase);
    if !matches!(extension.as_deref(), Some("html" | "htm")) {
        let text = "names no page: end it in .html";
        return Err(Failure::input(format!("`{}` {text}", out.display())));
    }
    let beside = out.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let html = report_in(beside, folder, catalogue).map_err(Failure::input)?;
    write_out(&out, &html)?;
    Ok(output::print(&format!("{}\n", out.display()))?)
}
