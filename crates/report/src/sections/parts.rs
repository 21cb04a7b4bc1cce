//! The parts that the design is built of, and what rounding to them costs.

use hwasp_plot::{IntervalRow, intervals};
use hwasp_runs::text::grouped;
use hwasp_training::{Change, Evaluation, MeanInterval};
use hwasp_workshop::parts::{JointParts, PartsList, SpringPart, Verdict};
use maud::{Markup, html};

use super::outcome::rate_row;
use super::provenance::not_yet;
use crate::figure::{gallery, picture};
use crate::page::Section;
use crate::run::Run;
use crate::words::{change, decimal, mean_interval, percent, rate_interval, spaced};

pub(crate) fn section(run: &Run) -> Section {
    let (line, then) =
        (format!("hwasp parts {}", run.typed_path()), "springs, pulleys, and what rounding to them costs");
    let body = run
        .parts
        .as_ref()
        .map_or_else(|| not_yet("parts", &line, then), |list| html! { (springs(list)) (worth(list)) });
    let body = html! { @if let Some(verdict) = &run.verdict { (told(verdict)) } (body) };
    Section { id: "parts", title: "Parts to buy and make", body }
}

/// Whether the hand can be built, and why.
fn told(verdict: &Verdict) -> Markup {
    html! {
        p { strong { @if verdict.buildable { "Buildable" } @else { "Not buildable" } } "." }
        ul {
            @for finding in &verdict.findings {
                li { strong { (finding.what) @if !finding.good { ", not good" } } ": " (finding.told) }
            }
        }
    }
}

fn springs(list: &PartsList) -> Markup {
    let mm = |metres: f64| decimal(1e3 * metres, 2);
    let torque = |joint: &JointParts| decimal(1e3 * joint.torque_error, 2);
    html! {
        p {
            "Springs are from the catalogue " code { (list.catalogue.name) } " of " (grouped(list.catalogue.springs as u64))
            "; pulleys are turned for a line of " (mm(list.workshop.line)) " mm."
        }
        table.cards {
            caption { "The parts of each kind of joint, and how near they come to what was trained" }
            thead {
                tr {
                    th scope="col" { "joint" } th scope="col" { "springs" } th.n scope="col" { "groove ⌀, mm" }
                    th.n scope="col" { "stiffness, N·mm/rad" } th.n scope="col" { "preload, rad" }
                    th.n scope="col" { "torque off by, N·mm" }
                }
            }
            tbody {
                @for joint in &list.joints {
                    tr {
                        th scope="row" { (joint.joints) " × " (spaced(&joint.joint)) }
                        td data-label="springs" { div { (spring(&joint.spring)) } }
                        td.n data-label="groove ⌀, mm" { (mm(2.0 * joint.pulley.groove_radius)) }
                        td.n data-label="stiffness, N·mm/rad" {
                            div { (decimal(1e3 * joint.built.stiffness, 2)) br; small { "for " (decimal(1e3 * joint.trained.stiffness, 2)) } }
                        }
                        td.n data-label="preload, rad" {
                            div { (decimal(joint.built.preload, 2)) br; small { "for " (decimal(joint.trained.preload, 2)) } }
                        }
                        td.n data-label="torque off by, N·mm" { (torque(joint)) }
                    }
                }
            }
        }
    }
}

fn spring(spring: &SpringPart) -> Markup {
    html! {
        (spring.count) " × " code { (spring.part) }
        br; small {
            "wire " (decimal(1e3 * spring.wire, 2)) " mm, " (decimal(spring.turns, 2)) " turns, hole " (spring.hole) ", stress "
            (percent(spring.stress_share))
        }
    }
}

/// Before and after rounding to parts, and after training on them.
fn worth(list: &PartsList) -> Markup {
    let worth = &list.worth;
    let mut stages: Vec<(&str, &Evaluation, Option<&Change>)> =
        vec![("as trained", &worth.trained, None), ("on these parts", &worth.snapped, Some(&worth.snapping))];
    if let Some(tuned) = &worth.tuned {
        stages.push(("tuned on them", &tuned.evaluation, Some(&tuned.change)));
    }
    let success = |evaluation: &Evaluation| evaluation.success.first().cloned();
    let rows: Vec<IntervalRow<'_>> =
        stages.iter().filter_map(|(label, evaluation, _)| Some(rate_row(label, evaluation.success.first()?))).collect();
    let (title, about) = ("Success before and after rounding to parts", "The table below has the numbers.");
    let points = |figure: &MeanInterval| format!("{} points", change(100.0 * figure.mean, 1));
    html! {
        div.part.whole {
        h3 { "What the parts are worth" }
        p {
            "On the same " (grouped(worth.trained.episodes)) " held-out episodes throughout."
            @if let Some(tuned) = &worth.tuned {
                " The controller was trained further on the parts, for " (grouped(tuned.env_steps)) " steps."
            }
        }
        div.beside {
            @if !rows.is_empty() { (gallery(&[picture(&intervals(&rows, "success (%)", 100.0), "worth", title, about)], "")) }
            table.cards {
                caption { "Success and return with 95 % intervals; changes are against the trained design, episode by episode" }
                thead {
                    tr {
                        th scope="col" { "controller and design" } th.n scope="col" { "success" } th.n scope="col" { "return" }
                        th.n scope="col" { "change of return" }
                    }
                }
                tbody {
                    @for (label, evaluation, step) in &stages {
                        tr {
                            th scope="row" { (label) }
                            td.n data-label="success" {
                                div {
                                    @if let Some(rate) = success(evaluation) {
                                        (percent(rate.rate())) br; small { (rate_interval(&rate)) }
                                    }
                                    @if let Some(success) = step.and_then(|step| step.success.as_ref()) {
                                        br; small { (points(success)) }
                                    }
                                }
                            }
                            td.n data-label="return" { (decimal(evaluation.undiscounted_return.mean, 1)) }
                            td.n data-label="change of return" {
                                @match step {
                                    Some(Change { undiscounted_return: figure, .. }) => {
                                        div { (change(figure.mean, 1)) br; small { (mean_interval(figure, 1)) } }
                                    }
                                    None => "–",
                                }
                            }
                        }
                    }
                }
            }
        }
        }
    }
}
