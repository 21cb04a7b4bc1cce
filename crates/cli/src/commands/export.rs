//! `hwasp export`.

use hwasp_lab::export::{ExportError, Source, export};

use super::run_folder;
use crate::args::ExportArgs;
use crate::failure::Failure;
use crate::{output, report};

pub(crate) fn run(args: &ExportArgs) -> Result<(), Failure> {
    let source = Source::open(run_folder(&args.run)?).map_err(Failure::input)?;
    let out = args.out.clone().unwrap_or_else(|| args.run.join("export"));
    let files = export(&source, &args.kinds.kinds(), args.samples, &out).map_err(|error| match error {
        ExportError::Run(error) => Failure::input(error),
        ExportError::Write(error) => error.into(),
        ExportError::Rollout(error) => error.into(),
        error => Failure::input(error),
    })?;
    Ok(output::print(&report::exported(source.spec(), &out, &files))?)
}
