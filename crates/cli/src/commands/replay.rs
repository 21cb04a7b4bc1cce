//! `hwasp replay`.

use hwasp_lab::{ReplayError, RunError, replay};

use super::executor;
use crate::args::ReplayArgs;
use crate::failure::Failure;
use crate::{output, report};

pub(crate) fn run(args: &ReplayArgs) -> Result<(), Failure> {
    let executor = executor(args.threads)?;
    let replay = replay(&args.file, &*executor).map_err(|error| match error {
        ReplayError::Run(error @ RunError::Io { .. }) => Failure::input(error),
        other => Failure::input(other),
    })?;
    Ok(output::print(&report::replay(&replay))?)
}
