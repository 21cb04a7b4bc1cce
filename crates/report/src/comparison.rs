//! The report of a comparison.

use std::path::Path;

use hwasp_experiment::{Catalogue, Experiment};
use hwasp_plot::{Band, Curve, IntervalRow, PlotOptions, XAxis, curve_panels, intervals, saved_plot_options};
use hwasp_runs::text::{ReadableUnit, grouped};
use hwasp_runs::{RunError, saved_experiment, saved_provenance};
use hwasp_study::{CellResult, Comparison, Figure, MethodFigures, Pair, SavedComparison};
use hwasp_training::STILL;
use hwasp_training::stats::{LEAST_VALUES, separation_by_chance};
use maud::{Markup, html};

use crate::figure::{gallery, picture};
use crate::page::{KeyFigure, Page, Section};
use crate::sections::curves::panels;
use crate::sections::overview;
use crate::sections::provenance::{begun, command, origin};
use crate::words::{decimal, decimals, duration, interval_or_none, sentence};

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
        figures: key_figures(comparison).into_iter().chain(typed.as_ref().map(|typed| begun("Begun", typed))).collect(),
        sections,
    })
}

fn methods(comparison: &Comparison) -> String {
    comparison.methods.iter().map(|method| method.label.as_str()).collect::<Vec<_>>().join(",")
}

fn figure(figure: Option<Figure>) -> Markup {
    let Some(Figure { iqm, interval }) = figure else { return html! { "–" } };
    let places = decimals(iqm);
    html! { (decimal(iqm, places)) br; small { (interval_or_none(interval, places)) } }
}

/// A number of reasonable length.
fn number(value: f64) -> String {
    decimal(value, decimals(value))
}

/// Whether all methods had the same budget; old comparisons do not say.
fn one_budget(comparison: &Comparison) -> bool {
    let mut budgets = comparison.methods.iter().map(|method| method.budget);
    let first = budgets.next();
    budgets.all(|budget| Some(budget) == first)
}

fn key_figures(comparison: &Comparison) -> Vec<KeyFigure> {
    let mut figures = Vec::new();
    if let Some((best, evaluation)) = comparison.methods.first().and_then(|best| Some((best, best.evaluation?))) {
        let of = format!("discounted return {}", number(evaluation.iqm));
        figures.push(KeyFigure { label: "Best evaluation".into(), value: best.label.clone(), note: of });
    }
    let methods = comparison.methods.len().to_string();
    let note = if one_budget(comparison) { "under one budget of real steps" } else { "each with a budget of its own" };
    figures.push(KeyFigure { label: "Methods".into(), value: methods, note: note.into() });
    let runs: usize = comparison.methods.iter().map(|method| method.seeds).sum();
    let missing: usize = comparison.methods.iter().map(|method| method.missing.len()).sum();
    let note = match missing {
        0 => "seeds of all methods together".to_owned(),
        _ => format!("seeds of all methods together; {missing} more did not finish"),
    };
    figures.push(KeyFigure { label: "Runs".into(), value: runs.to_string(), note });
    let steps: f64 = comparison.methods.iter().map(|m| m.env_steps.unwrap_or(0.0) * m.seeds as f64).sum();
    let note = "simulator steps of the finished runs, those inside of searches included".to_owned();
    figures.push(KeyFigure { label: "Charged".into(), value: grouped(steps as u64), note });
    figures
}

/// The evaluations, best first, and how sure their order is.
fn winner(comparison: &Comparison) -> Markup {
    let rows: Vec<IntervalRow<'_>> = comparison
        .methods
        .iter()
        .filter_map(|method| {
            let Figure { iqm, interval } = method.evaluation?;
            Some(IntervalRow {
                label: &method.label,
                value: iqm,
                text: number(iqm),
                interval,
                points: &method.evaluations,
            })
        })
        .collect();
    let about = "For each method the interquartile mean of its seeds as a dot, its 95 % bootstrap interval as a bar where there are \
                 seeds enough, each seed as a small dot below. The table of figures has the numbers.";
    let caption = "Discounted return of the deterministic controllers on held-out starts, on the hardware as built. Large dots: \
                   interquartile means over the seeds that finished; bars: 95 % bootstrap intervals, of four seeds and more; small \
                   dots: seeds.";
    let svg = intervals(&rows, "discounted return, evaluated", f64::INFINITY);
    html! {
        p { (verdict(comparison)) }
        @if !rows.is_empty() {
            (gallery(&[picture(&svg, "evaluations", "Evaluation of each method", about)], caption))
        }
        (unfinished(comparison))
        (still(comparison))
        @if !comparison.improvement.is_empty() { (pairs(&comparison.improvement)) }
    }
}

/// Seeds that did not finish, each with its reason.
fn unfinished(comparison: &Comparison) -> Markup {
    let missing = || comparison.methods.iter().filter(|method| !method.missing.is_empty());
    html! {
        @if missing().next().is_some() {
            h3 { "Seeds that did not finish" }
            p { "They are in none of the figures, which are over the other seeds alone." }
            ul.notes {
                @for method in missing() {
                    @for seed in &method.missing { li { (method.label) ", " (seed.to_string()) } }
                }
            }
        }
    }
}

/// Seeds whose training changed nothing.
fn still(comparison: &Comparison) -> Markup {
    let still = || comparison.methods.iter().filter_map(|method| Some((&method.label, method.unchanged()?)));
    html! {
        @if still().next().is_some() {
            h3 { "Trainings that changed nothing" }
            p { (sentence(STILL)) "." }
            ul.notes { @for (method, seeds) in still() { li { (method) ", " (seeds) } } }
        }
    }
}

/// Who is ahead, and whether that is more than chance.
fn verdict(comparison: &Comparison) -> String {
    let methods = &comparison.methods;
    let Some((best, evaluation)) = methods.first().and_then(|best| Some((best, best.evaluation?))) else {
        return "No training finished, so nothing can be said of any method.".to_owned();
    };
    let seeds =
        |method: &MethodFigures| format!("{} seed{}", method.finished(), if method.seeds == 1 { "" } else { "s" });
    let Some((next, second)) = methods.get(1).and_then(|next| Some((next, next.evaluation?))) else {
        let alone = if methods.len() == 1 {
            "nothing else was trained".to_owned()
        } else {
            let others: Vec<&str> = methods[1..].iter().map(|method| method.label.as_str()).collect();
            format!("no seed of {} finished", others.join(", "))
        };
        return format!("{} reaches {} over {}, and {alone}.", best.label, number(evaluation.iqm), seeds(best));
    };
    let begin = format!(
        "{} has the best evaluation, {} over {}, before {} with {} over {}.",
        best.label,
        number(evaluation.iqm),
        seeds(best),
        next.label,
        number(second.iqm),
        seeds(next)
    );
    let pair = comparison.improvement.iter().find(|p| p.method == best.label && p.other == next.label);
    let Some(found) = pair.and_then(|pair| pair.improvement) else {
        return format!(
            "{begin} So few seeds do not tell the two apart: that takes {LEAST_VALUES} finished seeds of each, and better more."
        );
    };
    let share = format!("{:.0} %", 100.0 * found.probability);
    match found.interval {
        Some(interval) if interval.low > 0.5 => format!(
            "{begin} It is the better one in {share} of all pairs of seeds, and the interval of that share lies above one half."
        ),
        Some(_) => format!(
            "{begin} It is the better one in {share} of all pairs of seeds, but the interval of that share reaches down to one \
             half: these seeds do not tell the two apart."
        ),
        None if found.probability >= 1.0 => format!(
            "{begin} All its seeds are better than all of the other; methods that are alike would come apart so in {:.1} % of \
             such comparisons.",
            100.0 * separation_by_chance(best.seeds, next.seeds)
        ),
        None => format!("{begin} The seeds do not tell the two apart."),
    }
}

fn pairs(pairs: &[Pair]) -> Markup {
    html! {
        table.cards {
            caption {
                "Probability of improvement: the share of pairs of seeds in which the first method is better, ties counted half, with \
                 95 % bootstrap intervals; a dash where fewer than four seeds of either finished"
            }
            thead {
                tr { th scope="col" { "method" } th scope="col" { "against" } th.n scope="col" { "probability" }
                    th.n scope="col" { "interval" } }
            }
            tbody {
                @for pair in pairs {
                    tr {
                        th scope="row" { (pair.method) } td data-label="against" { (pair.other) }
                        td.n data-label="probability" {
                            (pair.improvement.map_or("–".to_owned(), |found| decimal(found.probability, 2)))
                        }
                        td.n data-label="interval" {
                            (pair.improvement.map_or("–".to_owned(), |found| interval_or_none(found.interval, 2)))
                        }
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
            "Each method was trained with several seeds under "
            @if one_budget(comparison) { "one budget" } @else { "a budget of its own" }
            " of real simulator steps, and every step that it caused was charged to it, those of all candidates and of trainings \
             inside of a search included. A method spends the budget in pieces that it takes whole or not at all, and never more \
             than it holds."
        }
        p { "The methods: " (methods(comparison).replace(',', ", ")) "." }
        @if let Some(others) = comparison.others() { p { (others) } }
    }
}

fn curves(saved: &SavedComparison) -> Markup {
    if saved.cells.is_empty() {
        return html! { p { "No training finished, so there is no curve to draw." } };
    }
    let design = saved.cells.first().map(|cell| &cell.summary.design);
    let groups = || design.into_iter().flatten().map(|(name, group)| (name.as_str(), group));
    let drawn = |x_axis: XAxis, id: &str, against: &str| {
        let of = |cell: &CellResult| Curve::from_table(&cell.label, &cell.metrics, x_axis, 0).judged();
        let mut runs: Vec<Curve> = saved.cells.iter().map(of).collect();
        if x_axis == XAxis::WallClock {
            for run in &mut runs {
                run.totals.clear();
                run.terms.clear();
            }
        }
        let asked = saved.comparison.asked();
        let options = PlotOptions { x_axis, band: Band::Bootstrap, asked, ..saved_plot_options(groups()) };
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
    let threshold = comparison.threshold.map_or("–".to_owned(), number);
    html! {
        table.cards {
            caption { "Interquartile means over the seeds that finished, with 95 % bootstrap intervals; best evaluation first" }
            thead {
                tr {
                    th scope="col" { "method" } th.n scope="col" { "finished" } th.n scope="col" { "evaluation" }
                    th.n scope="col" { "area under curve" } th.n scope="col" { "steps to " (threshold) }
                    th.n scope="col" { "steps" } th.n scope="col" { "time" }
                }
            }
            tbody { @for method in &comparison.methods { (row(method, &threshold)) } }
        }
        p {
            "Evaluation: discounted return of the deterministic controller on held-out starts, on the hardware as built. Area under \
             curve: mean discounted return of training over the budget. Steps to: median real steps until the mean of the last 11 \
             iterations reached that return. Steps: what a seed took on average of its budget, and below it what the method cannot \
             divide. Intervals are given from four seeds on."
        }
    }
}

fn row(method: &MethodFigures, threshold: &str) -> Markup {
    let million = |steps: f64| format!("{:.2} M", steps / 1e6);
    let reached = method.threshold.median_env_steps.map_or("–".to_owned(), million);
    html! {
        tr {
            th scope="row" { (method.label) }
            td.n data-label="finished" { div { (method.finished()) } }
            td.n data-label="evaluation" { div { (figure(method.evaluation)) } }
            td.n data-label="area under curve" { div { (figure(method.area_under_curve)) } }
            td.n data-label={ "steps to " (threshold) } {
                div { (reached) br; small { (method.threshold.seeds) " of " (method.seeds) } }
            }
            td.n data-label="steps" {
                div {
                    (method.env_steps.map_or("–".to_owned(), |steps| grouped(steps.round() as u64)))
                    @if let Some(budget) = method.budget { " of " (grouped(budget)) }
                    @if let Some(piece) = &method.piece { br; small { (piece.what) ", " (grouped(piece.env_steps)) } }
                    @if method.failed_candidates > 0 { br; small { (grouped(method.failed_candidates)) " candidates failed" } }
                }
            }
            td.n data-label="time" { div { (method.wall_s.map_or("–".to_owned(), duration)) } }
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
                    (what) (name) (with) ", as built"
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
