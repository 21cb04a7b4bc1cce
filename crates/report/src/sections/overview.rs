//! What was optimised.

use hwasp_experiment::{Experiment, Method};
use hwasp_runs::text::grouped;
use maud::{Markup, html};

use crate::page::Section;
use crate::run::Run;
use crate::words::spaced;

pub(crate) fn section(run: &Run) -> Section {
    let spec = &run.spec;
    let body = html! {
        p { (problem(spec)) }
        p { (method(spec)) }
        p { (controller(spec)) }
        details {
            summary { "The task in numbers" }
            (task(run))
        }
    };
    Section { id: "optimised", title: "What was optimised", body }
}

/// Body, purpose, and what of the body is open.
pub(crate) fn problem(spec: &Experiment) -> String {
    let about = &spec.task.built().words.about;
    if about.is_empty() { format!("The problem is {}.", spec.task.name()) } else { about.clone() }
}

/// How learner, controller and hardware were composed.
fn method(spec: &Experiment) -> String {
    let learner = spec.learner.title();
    match spec.method {
        Method::Hwasp => format!(
            "The law of the mechanism is a part of the policy, and its parameters are trained with the controller's weights by \
             policy gradients ({learner}). This is the method of Chen, He and Ciocarlie, Hardware as Policy (CoRL 2020)."
        ),
        Method::Minimal => format!(
            "The mechanism acts in the simulator, its design is a part of the action, and both are trained by policy gradients \
             ({learner}): HWasP-Minimal of Chen, He and Ciocarlie (CoRL 2020)."
        ),
        Method::Episode => format!(
            "The mechanism acts in the simulator. Its design is drawn once an episode and held, and what an episode returns trains \
             the distribution that it is drawn from, together with the controller, by policy gradients ({learner})."
        ),
        Method::Fixed => {
            format!(
                "The design stays where the experiment begins; policy gradients ({learner}) train the controller alone."
            )
        }
        Method::Cmaes => "CMA-ES searches for design and controller together.".to_owned(),
        Method::Ars => "Augmented random search moves design and controller together.".to_owned(),
        Method::CmaesRl => {
            format!("CMA-ES searches for the design; every candidate trains a controller of its own with {learner}.")
        }
        Method::ArsRl => format!(
            "Augmented random search moves the design; every candidate trains a controller of its own with {learner}."
        ),
    }
}

fn controller(spec: &Experiment) -> String {
    let layers: Vec<String> = spec.controller.hidden.iter().map(ToString::to_string).collect();
    let through = if layers.is_empty() {
        "without hidden layers".to_owned()
    } else {
        format!("through hidden layers of {}", layers.join(" and "))
    };
    let (seen, given) = (spec.task.observations(), spec.task.commands());
    let count = |n: usize, what: &str| format!("{n} {what}{}", if n == 1 { "" } else { "s" });
    format!(
        "The controller maps {} to {} {through}. An episode has {} steps.",
        count(seen, "observation"),
        count(given, "command"),
        grouped(spec.task.horizon as u64)
    )
}

/// The keys of `[task]`.
fn task(run: &Run) -> Markup {
    let table = run.experiment.parse::<toml::Table>().ok();
    let task = table.as_ref().and_then(|table| table.get("task")).and_then(toml::Value::as_table);
    html! {
        table {
            caption { "The keys of " code { "[task]" } " in the experiment" }
            thead { tr { th scope="col" { "key" } th scope="col" { "value" } } }
            tbody {
                @for (key, value) in task.into_iter().flatten() {
                    tr { th scope="row" { (spaced(key)) } td { (told(value)) } }
                }
            }
        }
    }
}

/// A value without the marks of its notation.
fn told(value: &toml::Value) -> String {
    match value {
        toml::Value::String(text) => text.clone(),
        toml::Value::Array(values) => {
            let values: Vec<String> = values.iter().map(told).collect();
            values.join(if values.len() == 2 { " to " } else { ", " })
        }
        other => other.to_string(),
    }
}
