//! `hwasp check`.

use hwasp_lab::Assembly;

use super::experiment;
use crate::Failure;
use crate::args::ExperimentArgs;
use crate::report;

pub(crate) fn run(args: &ExperimentArgs) -> Result<(), Failure> {
    let spec = experiment(args, &[])?;
    let assembly = Assembly::new(&spec)?;
    print!("{}", report::experiment(&spec, &assembly));
    Ok(())
}
