//! `hwasp replay`.

use hwasp_experiment::Catalogue;
use hwasp_runs::replay;

use super::executor;
use crate::args::ReplayArgs;
use crate::{output, report};
use hwasp_session::Failure;

pub(crate) fn run(args: &ReplayArgs, catalogue: &Catalogue) -> Result<(), Failure> {
    let executor = executor(args.threads)?;
    let replay = replay(&args.file, catalogue, &*executor).map_err(Failure::input)?;
    Ok(output::print(&report::replay(&replay))?)
}
