//! `hwasp check`.

use hwasp_core::{EnvFault, MADE_FROM};
use hwasp_experiment::{Catalogue, Experiment};
use hwasp_runs::RunFolder;
use hwasp_training::{Assembly, Trial};

use super::experiment;
use crate::args::ExperimentArgs;
use crate::{output, report};
use hwasp_session::Failure;

pub(crate) fn run(args: &ExperimentArgs, catalogue: &Catalogue) -> Result<(), Failure> {
    let (spec, assembly) = experiment(&args.experiment, &args.settings, &[], catalogue)?;
    Ok(output::print(&checked(&spec, &assembly)?)?)
}

/// What is in an experiment, and what its world did when it was tried with random commands and designs.
///
/// # Errors
/// Of a world in which nothing could be learned.
pub fn checked(spec: &Experiment, assembly: &Assembly) -> Result<String, Failure> {
    RunFolder::check_names(spec).map_err(Failure::input)?;
    let trial = Trial::of(&assembly.worlds.training);
    if let (failed, Some(first)) = &trial.failed
        && *failed == trial.episodes
    {
        let message =
            format!("each of {failed} episodes with random commands and designs failed, the first at {first}");
        return Err(Failure::input(message).hint("nothing can be learned so: mend what the message names"));
    }
    match &trial.broken {
        // Training throws such episodes away.
        None | Some(EnvFault::Faulted { .. }) => {}
        // Start, observation and reward of a model may follow the design; the report warns of it.
        Some(EnvFault::Differs { cause, .. }) if *cause == MADE_FROM => {}
        Some(fault) => {
            let hint = "training would be wrong without a word: mend what the message names";
            return Err(Failure::input(format!("the environment breaks a promise: {fault}")).hint(hint));
        }
    }
    Ok(report::check::experiment(spec, assembly, &trial))
}
