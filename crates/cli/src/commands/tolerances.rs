//! `hwasp tolerances`.

use hwasp_experiment::Catalogue;
use hwasp_training::EvaluateError;
use hwasp_workshop::tolerances::{PICTURES, TOLERANCES, errors_of, tolerances};
use hwasp_workshop::writable;

use super::saved_run;
use crate::args::TolerancesArgs;
use crate::progress::Counter;
use crate::{output, report};
use hwasp_session::Crew;
use hwasp_session::Failure;

pub(crate) fn run(args: &TolerancesArgs, catalogue: &Catalogue) -> Result<(), Failure> {
    let saved = saved_run(&args.run, &[], catalogue)?;
    let (assembly, params) = (saved.assembly(), saved.params().map_err(Failure::input)?);
    if assembly.policy.space().names().is_empty() {
        let error =
            Failure::input(format!("nothing of {} is designed: no parameter can be off", assembly.experiment().name));
        return Err(error.hint("[task.design] of an experiment says what is designed"));
    }
    let errors = errors_of(assembly, &params, &args.error).map_err(Failure::input)?;
    let asked = args.held_out.asked(&assembly.experiment().train);
    let folder = args.out.clone().unwrap_or_else(|| args.run.join("build"));
    // What cannot be written is known before the work begins.
    writable(&folder)?;
    let crew = Crew::new(args.held_out.threads, args.server.elsewhere().as_ref(), &[], catalogue)?;
    let collector = crew.collector(assembly, None)?;
    let mut counter = Counter::new("designs simulated");
    let found = tolerances(assembly, &params, &errors, asked, &*collector, &mut |done, all| counter.tell(done, all));
    counter.finish();
    crew.finish();
    let found = found.map_err(|error| match error {
        EvaluateError::Assemble(error) => Failure::input(error),
        error => error.into(),
    })?;
    // What was found is told even if a disk is full by now.
    output::print(&report::parts::tolerances(&found))?;
    found.write(&folder)?;
    Ok(output::print(&format!("\n  {}: {TOLERANCES}, {}\n", folder.display(), PICTURES.join(", ")))?)
}
