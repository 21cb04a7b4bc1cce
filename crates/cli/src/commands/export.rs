//! `hwasp export`.

use hwasp_experiment::Catalogue;
use hwasp_export::{ExportError, Kind, Source, export};

use super::run_folder;
use crate::args::ExportArgs;
use crate::{output, report};
use hwasp_session::Failure;

pub(crate) fn run(args: &ExportArgs, catalogue: &Catalogue) -> Result<(), Failure> {
    let source = Source::open(run_folder(&args.run)?, catalogue).map_err(Failure::input)?;
    let out = args.out.clone().unwrap_or_else(|| args.run.join("export"));
    let (mut kinds, mut left_out) = (args.kinds.asked(), Vec::new());
    if kinds.is_empty() {
        (kinds, left_out) = Kind::ALL.into_iter().partition(|kind| kind.is_of(source.spec()));
    }
    let exported = export(&source, &kinds, args.samples, &out);
    let files = exported.map_err(|error| match error {
        ExportError::Run(error) => Failure::input(error),
        ExportError::Write(error) => error.into(),
        ExportError::Rollout(error) => error.into(),
        error => Failure::input(error),
    })?;
    if let Some(chosen) = source.printed_for() {
        output::remark(&report::parts::printed_for(chosen, &args.run));
        if let Some(verdict) = source.verdict() {
            output::remark(&verdict.to_string());
        }
    }
    Ok(output::print(&report::exported(source.spec(), &out, &files, &left_out))?)
}
