//! The design that was found, between its limits.

use hwasp_plot::bars;
use hwasp_runs::text::ReadableUnit;
use hwasp_workshop::design::{Grade, GroupReport, HandReport, Judgement};
use hwasp_workshop::parts::JointParts;
use maud::{Markup, html};

use crate::figure::{gallery, picture};
use crate::page::Section;
use crate::run::Run;
use crate::words::{decimal, sentence, spaced};

/// The most parameters of a group that are shown one by one; `design.toml` has all.
const MOST_BARS: usize = 1000;

pub(crate) fn section(run: &Run) -> Section {
    let groups = &run.design.groups;
    let body = html! {
        @match &run.design.hand {
            Some(hand) => {
                (transmission(run, hand))
                details { summary { "Each number between its limits" } (table(groups)) }
            }
            None if groups.is_empty() => p { "Nothing is designed: the experiment has no design parameters." },
            None => (table(groups)),
        }
        @if let Some(judgement) = &run.design.judged { (judged(judgement)) }
        @for group in groups.iter().filter(|group| (2..=MOST_BARS).contains(&group.position.len())) { (each(group)) }
    };
    Section { id: "design", title: "The design", body }
}

/// What a block comes to: good, tight or bad, with the limit.
pub(crate) fn judged(judgement: &Judgement) -> Markup {
    let class = match judgement.grade {
        Grade::Good => "success",
        Grade::Tight => "doubt",
        Grade::Bad => "failure",
    };
    html! { p.judged { span class=(class) { (sentence(judgement.grade.name())) } ": " (judgement.told) "." } }
}

/// Every group with its unit and its limits.
fn table(groups: &[GroupReport]) -> Markup {
    let differs = groups.iter().any(|group| group.group.as_built != group.group.values);
    html! {
        table.cards {
            caption { "What to build. The bar shows where a value lies between its limits." }
            thead {
                tr {
                    th scope="col" { "parameter" } th.n scope="col" { "value" } th scope="col" { "limits" }
                    th scope="col" { "between them" }
                }
            }
            tbody { @for group in groups { (row(group)) } }
        }
        @if differs {
            p {
                "What is built differs from what was trained, as the law says: an interface that is rigid in reality is soft in \
                 training, or springs are built as strong as it takes to hold the hand open."
            }
        }
    }
}

fn row(report: &GroupReport) -> Markup {
    let (group, shown) = (&report.group, ReadableUnit::of(&report.group));
    let count = group.values.len();
    let [lo, hi] = group.limits.map(|limit| limit * count as f64);
    let position = if hi > lo { ((group.total - lo) / (hi - lo)).clamp(0.0, 1.0) } else { 0.0 };
    html! {
        tr {
            th scope="row" {
                (report.name)
                @if count > 1 { ", total of " (count) }
            }
            td.n data-label="value" {
                div {
                    (shown.with_unit(group.total_as_built))
                    @if group.as_built != group.values { br; small { "trained as " (shown.with_unit(group.total)) } }
                    @if let Some(best) = group.optimum { br; small { "best known " (shown.with_unit(best)) } }
                }
            }
            td data-label="limits" { (shown.short(lo)) " to " (shown.with_unit(hi)) }
            td data-label="between them" { (meter(position)) }
        }
    }
}

/// A position between limits as a bar with its number.
fn meter(position: f64) -> Markup {
    let percent = format!("{:.0} %", 100.0 * position);
    html! {
        span.meter {
            svg viewBox="0 0 100 10" preserveAspectRatio="none" aria-hidden="true" focusable="false" {
                rect.track width="100" height="10" {}
                rect.level width=(format!("{:.1}", 100.0 * position)) height="10" {}
            }
            (percent)
        }
    }
}

/// The values of a group of many.
fn each(report: &GroupReport) -> Markup {
    let shown = ReadableUnit::of(&report.group);
    let values: Vec<f64> = report.group.as_built.iter().map(|value| value / shown.to_si).collect();
    let name = &report.name;
    let label = format!("{name}, each of {} ({})", values.len(), shown.unit);
    let (least, most) = values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), &v| (l.min(v), h.max(v)));
    let about = format!("{} values from {} to {} {}.", values.len(), decimal(least, 4), decimal(most, 4), shown.unit);
    let chart = picture(&bars(&values, &label), &format!("each-{}", report.name), &sentence(&label), &about);
    html! {
        (gallery(&[chart], ""))
        details {
            summary { "The values" }
            p { @for (i, value) in values.iter().enumerate() { @if i > 0 { ", " } (decimal(*value, 4)) } " " (shown.unit) }
        }
    }
}

/// The twelve numbers of a hand by joint, with their parts where there is a list of them.
fn transmission(run: &Run, hand: &HandReport) -> Markup {
    let limits = |i: usize, per_si: f64| {
        let [lo, hi] = run.design.groups.get(4 * i).map_or([0.0; 2], |group| group.group.limits);
        format!("{} to {}", per_si * lo, per_si * hi)
    };
    let parts = run.parts.as_ref().map_or(&[][..], |list| &list.joints);
    let part = |joint: &str| parts.iter().find(|part| part.joint == joint);
    let columns = [("pulley radius", "mm", 1e3), ("spring stiffness", "N·mm/rad", 1e3), ("preload", "rad", 1.0)];
    html! {
        table.cards[!parts.is_empty()] {
            caption { "The transmission as trained, joint by joint, and the limits within which it was sought" }
            thead {
                tr {
                    th scope="col" { "joint" }
                    @for (name, unit, _) in columns { th.n scope="col" { (name) ", " (unit) } }
                    @if !parts.is_empty() { th scope="col" { "parts" } }
                }
            }
            tbody {
                @for joint in &hand.joints {
                    tr {
                        th scope="row" { (spaced(joint.joint)) }
                        @for ((name, unit, per_si), value) in columns.into_iter().zip(joint.design) {
                            td.n data-label={ (name) ", " (unit) } { (decimal(per_si * value, 2)) }
                        }
                        @if !parts.is_empty() {
                            td data-label="parts" { @if let Some(part) = part(joint.joint) { div { (made_of(part)) } } }
                        }
                    }
                }
                tr.aside {
                    th scope="row" { "limits" }
                    @for (i, (name, unit, per_si)) in columns.into_iter().enumerate() {
                        td.n data-label={ (name) ", " (unit) } { (limits(i, per_si)) }
                    }
                    @if !parts.is_empty() { td data-label="parts" { "–" } }
                }
            }
        }
        (beside(hand))
    }
}

/// The parts of a joint in a few words.
fn made_of(part: &JointParts) -> Markup {
    let (spring, pulley) = (&part.spring, &part.pulley);
    html! {
        (spring.count) " × " code { (spring.part) } ", hole " (spring.hole)
        br; small { "groove ⌀ " (decimal(2e3 * pulley.groove_radius, 2)) " mm" }
    }
}

/// The same beside the paper's two hands.
fn beside(hand: &HandReport) -> Markup {
    let rows = [("radius, mm", 1e3), ("stiffness, N·mm/rad", 1e3), ("preload, rad", 1.0)];
    html! {
        details {
            summary { "Beside the paper’s hands" }
            div.scroll tabindex="0" role="region" aria-label="The table; scroll to see all of it" {
                table {
                    caption { "This hand and those of the paper (table 2): HWasP and HWasP-Minimal" }
                    thead {
                        tr {
                            th scope="col" { "quantity" } th scope="col" { "hand" }
                            @for joint in &hand.joints { th.n scope="col" { (spaced(joint.joint)) } }
                        }
                    }
                    @for (i, (name, per_si)) in rows.into_iter().enumerate() {
                        tbody {
                            tr {
                                th scope="rowgroup" rowspan="3" { (name) }
                                th scope="row" { "this one" }
                                @for joint in &hand.joints { td.n { (decimal(per_si * joint.design[i], 2)) } }
                            }
                            tr {
                                th scope="row" { "HWasP" }
                                @for joint in &hand.joints { td.n { (decimal(per_si * joint.paper_hwasp[i], 1)) } }
                            }
                            tr {
                                th scope="row" { "Minimal" }
                                @for joint in &hand.joints { td.n { (decimal(per_si * joint.paper_minimal[i], 1)) } }
                            }
                        }
                    }
                }
            }
        }
    }
}
