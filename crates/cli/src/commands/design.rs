//! `hwasp design`.

use hwasp_experiment::Catalogue;
use hwasp_settings::nearest;
use hwasp_settings::text::shorten;
use hwasp_workshop::design::{DesignReport, write_closing};
use hwasp_workshop::parts::{Verdict, verdict_of_run};
use serde::Serialize;

use super::{changes, run_folder};
use crate::args::DesignArgs;
use crate::{output, report};
use hwasp_session::Failure;

/// A design and whether it can be built, as programs have it.
#[derive(Serialize)]
struct Told<'a> {
    #[serde(flatten)]
    report: &'a DesignReport,
    #[serde(skip_serializing_if = "Option::is_none")]
    verdict: Option<&'a Verdict>,
}

pub(crate) fn run(args: &DesignArgs, catalogue: &Catalogue) -> Result<(), Failure> {
    let path = &args.run;
    let experiment = path.exists() || path.extension().is_some() || {
        let name = path.to_string_lossy();
        catalogue.presets().iter().any(|preset| preset.name == name)
    };
    if experiment && (!path.is_dir() || !args.at.is_empty()) {
        return changes::run(args, catalogue);
    }
    if !path.exists() {
        let name = path.to_string_lossy();
        let known = || catalogue.presets().into_iter().map(|preset| preset.name);
        let hint = match nearest(&name, known()) {
            Some(near) => format!("did you mean `{near}`?"),
            None => "name a folder that `hwasp train` has written, an experiment of `hwasp list`, or a file that ends in .toml".into(),
        };
        let message = format!("there is neither a run nor an experiment `{}`", shorten(&name, 120));
        return Err(Failure::input(message).hint(&hint));
    }
    let report = DesignReport::open(run_folder(&args.run)?, catalogue).map_err(Failure::input)?;
    let verdict = verdict_of_run(&args.run, catalogue).map_err(Failure::input)?;
    if args.out.is_some() && report.hand.is_none() {
        let task = &report.task;
        return Err(Failure::input(format!(
            "--out names a folder for the closing chart, which a hand has and {task} has not\n  = hint: leave it out"
        )));
    }
    let text = if args.json {
        format!("{}\n", serde_json::to_string_pretty(&Told { report: &report, verdict: verdict.as_ref() })?)
    } else {
        report::design::design(&report, verdict.as_ref())
    };
    output::print(&text)?;
    // Scripts have the chart's points, and get the picture if they ask for it.
    let Some(hand) = report.hand.filter(|_| !args.json || args.out.is_some()) else { return Ok(()) };
    let folder = args.out.as_ref().unwrap_or(&args.run);
    let title = format!("free closing: {} · {} · seed {}", report.experiment, report.method, report.seed);
    write_closing(folder, &hand.closing_plot(&title))?;
    if args.json {
        return Ok(());
    }
    Ok(output::print(&format!("\n  {}: closing.svg, closing.png\n", folder.display()))?)
}
