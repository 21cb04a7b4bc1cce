//! `hwasp eval`.

use hwasp_experiment::Catalogue;
use hwasp_training::{EvaluateError, Evaluation, evaluate_by, evaluate_native_by};
use serde::Serialize;

use super::{saved_run, stand_in};
use crate::args::EvalArgs;
use crate::{output, report};
use hwasp_session::Crew;
use hwasp_session::Failure;

/// The figures for scripts, and the values of `--set` that they are for.
#[derive(Serialize)]
struct Judged<'a> {
    #[serde(flatten)]
    evaluation: &'a Evaluation,
    #[serde(skip_serializing_if = "<[String]>::is_empty")]
    under: &'a [String],
}

pub(crate) fn run(args: &EvalArgs, catalogue: &Catalogue) -> Result<(), Failure> {
    let saved = saved_run(&args.run, &args.set, catalogue)?;
    let params = saved.params().map_err(Failure::input)?;
    let asked = args.held_out.asked(&saved.assembly().experiment().train);
    let crew = Crew::new(args.held_out.threads, args.server.elsewhere().as_ref(), &[], catalogue)?;
    let collector = crew.collector(saved.assembly(), None)?;
    let nearer = stand_in(&args.nearer, saved.assembly())?;
    let evaluation = if nearer.is_some() {
        evaluate_native_by(&*collector, saved.assembly(), &params, asked)
    } else {
        evaluate_by(&*collector, saved.assembly(), &params, asked)
    };
    crew.finish();
    let evaluation = evaluation.map_err(|error| match error {
        EvaluateError::Assemble(error) => Failure::input(error),
        error => error.into(),
    })?;
    if args.per_shape && evaluation.success.is_empty() {
        let task = saved.assembly().experiment().task.name();
        output::remark(&format!("note: {task} knows no success here, and so no rates of it"));
    }
    let text = if args.json {
        let judged = Judged { evaluation: &evaluation, under: &args.set };
        format!("{}\n", serde_json::to_string_pretty(&judged)?)
    } else {
        report::under(&args.set) + &report::evaluation(&evaluation, args.per_shape, nearer)
    };
    Ok(output::print(&text)?)
}
