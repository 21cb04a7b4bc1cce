//! What was optimised.

use hwasp_core::split_quantity;
use hwasp_experiment::{Experiment, Method};
use hwasp_plot::views;
use hwasp_runs::text::grouped;
use hwasp_settings::written;
use maud::{Markup, html};

use crate::figure::{picture, wide};
use crate::page::Section;
use crate::run::Run;
use crate::trials::Trials;

pub(crate) fn section(run: &Run, trials: Option<&Trials>) -> Section {
    let spec = &run.spec;
    let body = html! {
        p { (problem(spec)) }
        p { (method(spec)) }
        p { (controller(spec)) }
        @if let Some(svg) = trials.and_then(|trials| views(trials.start.as_ref()?)) { (drawn(&svg)) }
        details {
            summary { "The task in numbers" }
            (task(run))
        }
    };
    Section { id: "optimised", title: "What was optimised", body }
}

/// The mechanism from three sides.
fn drawn(svg: &str) -> Markup {
    let about = "Outlines from the front, from the right and from above, with the measures of all that is no ground.";
    let svg = picture(svg, "views", "The mechanism at the start of an episode, from three sides", about);
    wide(&svg, "Three views; scroll to see all of it", "The start of the first held-out episode, to one scale.")
}

/// Body, purpose, and what of the body is open.
pub(crate) fn problem(spec: &Experiment) -> String {
    let about = &spec.task.built().words.about;
    if about.is_empty() { format!("The problem is {}.", spec.task.name()) } else { about.clone() }
}

/// How learner, controller and hardware were composed, and what becomes of parameters that the model is made from.
fn method(spec: &Experiment) -> String {
    let shaped = &spec.task.built().training.env.shaped_by;
    let groups = spec.task.groups();
    let in_policy = matches!(spec.method, Method::Hwasp | Method::Minimal);
    if !in_policy || shaped.is_empty() {
        return composed(spec, spec.method);
    }
    if groups.iter().all(|group| shaped.contains(&group.name)) {
        return composed(spec, Method::Episode);
    }
    format!(
        "{} What the model is made from ({}) is drawn once an episode and held, and what an episode returns trains the distribution \
         that it is drawn from.",
        composed(spec, spec.method),
        shaped.join(", ")
    )
}

fn composed(spec: &Experiment, method: Method) -> String {
    let learner = spec.learner.title();
    if spec.task.groups().is_empty() && !method.searches() {
        return format!("Nothing is designed: policy gradients ({learner}) train the controller alone.");
    }
    match method {
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
        Method::BoRl => format!(
            "Bayesian optimisation chooses designs by a model of their scores; every candidate trains a controller of its own with \
             {learner}."
        ),
        Method::RandomRl => {
            format!("Designs are drawn at random; every candidate trains a controller of its own with {learner}.")
        }
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
    let usual = defaults(&run.spec);
    // A word or a flag that nobody has asked for tells nothing; what a robot in MJCF has of a `base` is in its model.
    let tells = |key: &String, value: &toml::Value| match value {
        toml::Value::String(text) if text.is_empty() => false,
        toml::Value::String(_) | toml::Value::Boolean(_) => usual.get(key) != Some(value),
        _ => true,
    };
    html! {
        table.keys {
            caption { "The keys of " code { "[task]" } " in the experiment" }
            thead { tr { th scope="col" { "key" } th scope="col" { "value" } } }
            tbody {
                @for (key, value) in task.into_iter().flatten() {
                    @if tells(key, value) { tr { th scope="row" { (key) } td { (told(value)) } } }
                }
            }
        }
    }
}

/// The settings of a problem of which nobody has said anything.
fn defaults(spec: &Experiment) -> toml::Table {
    let problem = spec.catalogue().problems().iter().find(|problem| problem.name() == spec.task.name());
    let keys = problem.map(|problem| written(&mut *problem.defaults())).unwrap_or_default();
    toml::Table::try_from(&keys).unwrap_or_default()
}

/// A value without the marks of its notation; tables in lines.
fn told(value: &toml::Value) -> Markup {
    match value {
        toml::Value::Table(table) => html! {
            @for (i, (key, value)) in table.iter().enumerate() { @if i > 0 { br; } (key) " = " (plain(value)) }
        },
        value => html! { (plain(value)) },
    }
}

/// The same in a line.
fn plain(value: &toml::Value) -> String {
    match value {
        toml::Value::String(text) => text.clone(),
        // Two quantities are limits; two of anything else are a list.
        toml::Value::Array(values) => match &values[..] {
            [low, high] if is_quantity(low) && is_quantity(high) => format!("{} to {}", plain(low), plain(high)),
            values => values.iter().map(plain).collect::<Vec<_>>().join(", "),
        },
        toml::Value::Table(table) => {
            table.iter().map(|(key, value)| format!("{key} {}", plain(value))).collect::<Vec<_>>().join("; ")
        }
        other => other.to_string(),
    }
}

/// Whether a value is a number, with a unit or without.
fn is_quantity(value: &toml::Value) -> bool {
    match value {
        toml::Value::Integer(_) | toml::Value::Float(_) => true,
        toml::Value::String(text) => {
            let (number, unit) = split_quantity(text);
            number.parse::<f64>().is_ok() && !unit.contains(|c: char| " ([".contains(c))
        }
        _ => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A list of two formulas was told as a range.
    #[test]
    fn limits_are_ranges_and_lists_are_lists() {
        let told = |text: &str| told(&text.parse::<toml::Table>().unwrap()["x"]).into_string();
        assert_eq!(told("x = [1, 2.5]"), "1 to 2.5");
        assert_eq!(told("x = [\"-8 N*m\", \"8 N*m\"]"), "-8 N*m to 8 N*m");
        assert_eq!(told("x = [\"joint.*.pos[1:]\", \"2 * qvel\"]"), "joint.*.pos[1:], 2 * qvel");
        assert_eq!(told("x = [\"box\", \"sphere\"]"), "box, sphere");
        assert_eq!(
            told("x = { a = { limits = [0, \"3 m\"], sets = [\"b = a\"] }, c = \"d < 1\" }"),
            "a = limits 0 to 3 m; sets b = a<br>c = d &lt; 1"
        );
    }
}
