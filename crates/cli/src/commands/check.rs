//! `hwasp check`.

use super::experiment;
use crate::args::ExperimentArgs;
use crate::failure::Failure;
use crate::{output, report};
use hwasp_experiment::Catalogue;

pub(crate) fn run(args: &ExperimentArgs, catalogue: &Catalogue) -> Result<(), Failure> {
    let (spec, assembly) = experiment(&args.experiment, &args.settings, &[], catalogue)?;
    Ok(output::print(&report::experiment(&spec, &assembly))?)
}
