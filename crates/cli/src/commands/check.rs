//! `hwasp check`.

use super::experiment;
use crate::args::ExperimentArgs;
use crate::failure::Failure;
use crate::{output, report};

pub(crate) fn run(args: &ExperimentArgs) -> Result<(), Failure> {
    let (spec, assembly) = experiment(&args.experiment, &args.settings, &[])?;
    Ok(output::print(&report::experiment(&spec, &assembly))?)
}
