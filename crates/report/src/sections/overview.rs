//! What was optimised.

use hwasp_runs::text::grouped;
use hwasp_training::spec::{Algorithm, Method, Problem, Spec};
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
pub(crate) fn problem(spec: &Spec) -> String {
    match &spec.task.problem {
        Problem::Stiffness(p) => format!(
            "Two masses hang under {} parallel springs, and a motor pulls. The lower mass has to be brought to a height and held \
             there with as little motor as possible. The stiffness of each spring is the design.",
            p.base.segments
        ),
        Problem::BarLength(p) => format!(
            "Two masses hang under a spring, a bar of {} segments between them, and a motor pulls. The lower mass has to be \
             brought to a height and held there with as little motor as possible. The length of each segment is the design.",
            p.base.segments
        ),
        Problem::Reach(_) => {
            "A motor moves a point on a rail through a gear, and the point has to reach a goal. The ratio of the \
             gear is the design."
                .to_owned()
        }
        Problem::Pendulum => {
            "A motor too weak to lift a pendulum in one go has to swing it up and hold it there. The ratio of \
             the gear behind the motor is the design."
                .to_owned()
        }
        Problem::Own(_) => format!("The problem is {}, which is not one that comes with hwasp.", spec.task.name()),
        Problem::ZGrasp(_) | Problem::SpatialGrasp(_) => {
            let motion = match &spec.task.problem {
                Problem::ZGrasp(_) => "up and down",
                _ => "in space",
            };
            format!(
                "One motor winds three tendons, which close a thumb and two fingers of two links each against springs in the \
                 joints; the palm moves {motion}. The hand has to come down to an object, grasp it and lift it. Pulley radius, \
                 spring stiffness and spring preload at four kinds of joints are the design; the two fingers share theirs."
            )
        }
    }
}

/// How learner, controller and hardware were composed.
fn method(spec: &Spec) -> String {
    let learner = match spec.learner.algorithm {
        Algorithm::Ppo => "PPO",
        Algorithm::Trpo => "TRPO",
    };
    match spec.method {
        Method::Hwasp => format!(
            "The law of the mechanism is a part of the policy, and its parameters are trained with the controller's weights by \
             policy gradients ({learner}). This is the method of Chen, He and Ciocarlie, Hardware as Policy (CoRL 2020)."
        ),
        Method::Minimal => format!(
            "The mechanism acts in the simulator, its design is a part of the action, and both are trained by policy gradients \
             ({learner}): HWasP-Minimal of Chen, He and Ciocarlie (CoRL 2020)."
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

fn controller(spec: &Spec) -> String {
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
