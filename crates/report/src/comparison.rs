//! The report of a comparison.

use std::path::Path;

use hwasp_experiment::{Catalogue, Experiment};
use hwasp_plot::{Band, Curve, IntervalRow, PlotOptions, XAxis, curve_panels, intervals, saved_plot_options};
use hwasp_runs::text::{ReadableUnit, grouped};
use hwasp_runs::{RunError, saved_experiment, saved_provenance};
use hwasp_study::{CellResult, Comparison, Figure, MethodFigures, Pair, SavedComparison};
use maud::{Markup, html};

use crate::figure::{gallery, picture};
use crate::page::{KeyFigure, Page, Section};
use crate::sections::curves::panels;
use crate::sections::overview;
use crate::sections::provenance::{command, origin};
use crate::words::{decimal, decimals, duration, interval, spaced};

/// Reads a comparison and lays out its report.
pub(super) fn page(folder: &Path, catalogue: &Catalogue) -> Result<Page, RunError> {
    let saved = SavedComparison::open(folder)?;
    let spec = saved_experiment(&saved.first, &[], catalogue)?;
    let typed = saved_provenance(&saved.first)?;
    let comparison = &saved.comparison;
    let origin = html! {
        p { "The same command again finds everything done; into another folder it trains all of it anew, to the same numbers." }
        @match &typed {
            Some(provenance) => (origin(provenance)),
            None => {
                p { "The runs have no " code { "provenance.json" } ", which says by what command they were made. It is of the form" }
                (command(&format!("hwasp compare EXPERIMENT --methods {}", methods(comparison))))
            }
        }
        p {
            "Every run is in " code { "cells/" } " with its experiment, every setting resolved. "
            code { "hwasp report" } " on one of these folders makes the report of that run."
        }
    };
    let section = |id, title, body| Section { id, title, body };
    let sections = vec![
        section("winner", "Who wins", winner(comparison)),
        section("compared", "What was compared", compared(&spec, comparison)),
        section("curves", "How they learned", curves(&saved)),
        section("table", "The figures", table(comparison)),
        section("designs", "The designs", designs(&saved)),
        section("provenance", "Where it came from", origin),
    ];
    Ok(Page {
        title: comparison.experiment.clone(),
        kind: "Comparison",
        lead: spec.description.clone(),
        figures: key_figures(comparison),
        sections,
    })
}

fn methods(comparison: &Comparison) -> String {
    comparison.methods.iter().map(|method| method.label.as_str()).collect::<Vec<_>>().join(",")
}

fn figure(figure: &Figure) -> Markup {
    let Figure { iqm, low, high } = *figure;
    let places = decimals(iqm);
    html! { (decimal(iqm, places)) br; small { (interval(low, high, places)) } }
}

fn key_figures(comparison: &Comparison) -> Vec<KeyFigure> {
    let mut figures = Vec::new();
    if let Some(best) = comparison.methods.first() {
        let of = format!("discounted return {}", decimal(best.evaluation.iqm, decimals(best.evaluation.iqm)));
        figures.push(KeyFigure { label: "Best evaluation".into(), value: best.label.clone(), note: of });
    }
    let methods = comparison.methods.len().to_string();
    figures.push(KeyFigure { label: "Methods".into(), value: methods, note: "under one budget of real steps".into() });
    let runs: usize = comparison.methods.iter().map(|method| method.seeds).sum();
    let note = "seeds of all methods together".to_owned();
    figures.push(KeyFigure { label: "Runs".into(), value: runs.to_string(), note });
    let steps: f64 = comparison.methods.iter().map(|m| m.env_steps * m.seeds as f64).sum();
    let note = "simulator steps, those inside of searches included".to_owned();
    figures.push(KeyFigure { label: "Charged".into(), value: grouped(steps as u64), note });
    figures
}

/// The evaluations, best first, and how sure their order is.
fn winner(comparison: &Comparison) -> Markup {
    let rows: Vec<IntervalRow<'_>> = comparison
        .methods
        .iter()
        .map(|method| IntervalRow {
            label: &method.label,
            value: method.evaluation.iqm,
            text: decimal(method.evaluation.iqm, decimals(method.evaluation.iqm)),
            low: method.evaluation.low,
            high: method.evaluation.high,
            points: &method.evaluations,
        })
        .collect();
    let about = "For each method the interquartile mean of its seeds as a dot, its 95 % bootstrap interval as a bar, each seed as a \
                 small dot below. The table of figures has the numbers.";
    let caption = "Discounted return of the deterministic controllers on held-out starts, on the hardware as built. Large dots: \
                   interquartile means over seeds; bars: 95 % bootstrap intervals; small dots: seeds.";
    let svg = intervals(&rows, "discounted return, evaluated", f64::INFINITY);
    html! {
        p { (verdict(comparison)) }
        (gallery(&[picture(&svg, "evaluations", "Evaluation of each method", about)], caption))
        @if !comparison.improvement.is_empty() { (pairs(&comparison.improvement)) }
    }
}

/// Who is ahead, and whether that is more than chance.
fn verdict(comparison: &Comparison) -> String {
    let Some(best) = comparison.methods.first() else { return String::new() };
    let (iqm, seeds) = (decimal(best.evaluation.iqm, decimals(best.evaluation.iqm)), best.seeds);
    let Some(next) = comparison.methods.get(1) else {
        return format!("{} reaches {iqm} over {seeds} seeds, and nothing else was trained.", best.label);
    };
    let begin = format!(
        "{} has the best evaluation, {iqm} over {seeds} seeds, before {} with {}.",
        best.label,
        next.label,
        decimal(next.evaluation.iqm, decimals(next.evaluation.iqm))
    );
    let pair = comparison.improvement.iter().find(|p| p.method == best.label && p.other == next.label);
    let Some(pair) = pair else { return begin };
    let share = format!("{:.0} %", 100.0 * pair.probability);
    let sure = if pair.low > 0.5 {
        "and the interval of that share lies above one half"
    } else {
        "but the interval of that share reaches down to one half: these seeds do not tell the two apart"
    };
    format!("{begin} It is the better one in {share} of all pairs of seeds, {sure}.")
}

fn pairs(pairs: &[Pair]) -> Markup {
    html! {
        table.cards {
            caption {
                "Probability of improvement: the share of pairs of seeds in which the first method is better, ties counted half, with \
                 95 % bootstrap intervals"
            }
            thead {
                tr { th scope="col" { "method" } th scope="col" { "against" } th.n scope="col" { "probability" }
                    th.n scope="col" { "interval" } }
            }
            tbody {
                @for pair in pairs {
                    tr {
                        th scope="row" { (pair.method) } td data-label="against" { (pair.other) }
                        td.n data-label="probability" { (decimal(pair.probability, 2)) }
                        td.n data-label="interval" { (interval(pair.low, pair.high, 2)) }
                    }
                }
            }
        }
    }
}

fn compared(spec: &Experiment, comparison: &Comparison) -> Markup {
    html! {
        p { (overview::problem(spec)) }
        p {
            "Each method was trained with several seeds under one budget of real simulator steps, and every step that it caused was \
             charged to it, those of all candidates and of trainings inside of a search included."
        }
        p { "The methods: " (methods(comparison).replace(',', ", ")) "." }
    }
}

fn curves(saved: &SavedComparison) -> Markup {
    let design = saved.cells.first().map(|cell| &cell.summary.design);
    let groups = || design.into_iter().flatten().map(|(name, group)| (name.as_str(), group));
    let drawn = |x_axis: XAxis, id: &str, against: &str| {
        let of = |cell: &CellResult| Curve::from_table(&cell.label, &cell.metrics, x_axis, 0);
        let mut runs: Vec<Curve> = saved.cells.iter().map(of).collect();
        if x_axis == XAxis::WallClock {
            for run in &mut runs {
                run.totals.clear();
            }
        }
        let options = PlotOptions { x_axis, band: Band::Bootstrap, ..saved_plot_options(groups()) };
        match curve_panels(&runs, &options) {
            Ok(mut plots) => {
                // Times at which the runs of one label end are never the same.
                if x_axis == XAxis::WallClock {
                    plots.notes.clear();
                }
                panels(&plots, id, against)
            }
            Err(error) => html! { p { "The curves cannot be drawn: " (error) "." } },
        }
    };
    html! {
        (drawn(XAxis::EnvSteps, "curve", "against real simulator steps"))
        h3 { "Against time" }
        (drawn(XAxis::WallClock, "time", "against time"))
    }
}

fn table(comparison: &Comparison) -> Markup {
    let threshold = decimal(comparison.threshold, decimals(comparison.threshold));
    html! {
        table.cards {
            caption { "Interquartile means over seeds, with 95 % bootstrap intervals; best evaluation first" }
            thead {
                tr {
                    th scope="col" { "method" } th.n scope="col" { "seeds" } th.n scope="col" { "evaluation" }
                    th.n scope="col" { "area under curve" } th.n scope="col" { "steps to " (threshold) }
                    th.n scope="col" { "steps" } th.n scope="col" { "time" }
                }
            }
            tbody { @for method in &comparison.methods { (row(method, &threshold)) } }
        }
        p {
            "Evaluation: discounted return of the deterministic controller on held-out starts, on the hardware as built. Area under \
             curve: mean discounted return of training over the budget. Steps to: median real steps until the mean of the last 11 \
             iterations reached that return."
        }
    }
}

fn row(method: &MethodFigures, threshold: &str) -> Markup {
    let million = |steps: f64| format!("{:.2} M", steps / 1e6);
    let reached = method.threshold.median_env_steps.map_or("–".to_owned(), million);
    html! {
        tr {
            th scope="row" { (method.label) }
            td.n data-label="seeds" { div { (method.seeds) } }
            td.n data-label="evaluation" { div { (figure(&method.evaluation)) } }
            td.n data-label="area under curve" { div { (figure(&method.area_under_curve)) } }
            td.n data-label={ "steps to " (threshold) } {
                div { (reached) br; small { (method.threshold.seeds) " of " (method.seeds) } }
            }
            td.n data-label="steps" {
                div {
                    (million(method.env_steps))
                    @if method.failed_candidates > 0 { br; small { (grouped(method.failed_candidates)) " candidates failed" } }
                }
            }
            td.n data-label="time" { div { (duration(method.wall_s)) } }
        }
    }
}

/// Design totals as built, seed by seed.
fn designs(saved: &SavedComparison) -> Markup {
    let comparison = &saved.comparison;
    let design = saved.cells.first().map(|cell| &cell.summary.design);
    html! {
        @for (name, group) in design.into_iter().flatten() {
            @let shown = ReadableUnit::of(group);
            @let what = if group.values.len() == 1 { "" } else { "total " };
            @let with = if shown.unit.is_empty() { String::new() } else { format!(", {}", shown.unit) };
            table {
                caption {
                    (what) (spaced(name)) (with) ", as built"
                    @if let Some(best) = group.optimum { "; best known " (shown.with_unit(best)) }
                }
                thead {
                    tr { th scope="col" { "method" } th.n scope="col" { "lowest seed" } th.n scope="col" { "highest seed" }
                        @if group.optimum.is_some() { th.n scope="col" { "error" } } }
                }
                tbody {
                    @for method in &comparison.methods { (totals(method, name, &shown, group.optimum.is_some())) }
                }
            }
        }
    }
}

fn totals(method: &MethodFigures, group: &str, shown: &ReadableUnit, optimum: bool) -> Markup {
    let totals = method.design_totals.iter().find(|(name, _)| name == group).map_or(&[][..], |(_, totals)| totals);
    let (low, high) = totals.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), &t| (l.min(t), h.max(t)));
    let error = method.design_error.iter().find(|(name, _)| name == group);
    let told = |value: f64| if value.is_finite() { shown.short(value) } else { "–".to_owned() };
    html! {
        tr {
            th scope="row" { (method.label) }
            td.n { (told(low)) } td.n { (told(high)) }
            @if optimum { td.n { @match error { Some((_, error)) => (told(error.iqm)), None => "–" } } }
        }
    }
}
