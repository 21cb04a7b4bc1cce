//! `hwasp eval`.

use hwasp_experiment::Catalogue;
use hwasp_training::{EvaluateError, evaluate, evaluate_native};

use super::{executor, saved_run};
use crate::args::EvalArgs;
use crate::failure::Failure;
use crate::{output, report};

pub(crate) fn run(args: &EvalArgs, catalogue: &Catalogue) -> Result<(), Failure> {
    let saved = saved_run(&args.run, &args.set, catalogue)?;
    let params = saved.params().map_err(Failure::input)?;
    let asked = args.held_out.asked(&saved.assembly().experiment().train);
    let executor = executor(args.held_out.threads)?;
    let evaluation = if args.native_tendons {
        evaluate_native(saved.assembly(), &params, asked, &*executor)
    } else {
        evaluate(saved.assembly(), &params, asked, &*executor)
    };
    let evaluation = evaluation.map_err(|error| match error {
        EvaluateError::Assemble(error) => Failure::input(error),
        error => error.into(),
    })?;
    if args.per_shape && evaluation.success.is_empty() {
        let task = saved.assembly().experiment().task.name();
        output::remark(&format!("note: {task} knows neither success nor shapes"));
    }
    let text = if args.json {
        format!("{}\n", serde_json::to_string_pretty(&evaluation)?)
    } else {
        report::evaluation(&evaluation, args.per_shape)
    };
    Ok(output::print(&text)?)
}
