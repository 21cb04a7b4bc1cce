//! The figures as tables: Markdown for people, CSV for programs.

use std::fmt::Write as _;

use hwasp_runs::text::{self, grouped};
use hwasp_training::STILL;
use hwasp_training::stats::{Interval, LEAST_VALUES};

use crate::comparison::Comparison;
use crate::figures::{Figure, MethodFigures};

/// What there is not.
const NONE: &str = "–";

pub(crate) fn markdown(comparison: &Comparison) -> String {
    let Comparison { experiment, methods, improvement, .. } = comparison;
    let mut text = format!("# {}\n\n", text::markdown(experiment));
    let groups: Vec<&str> =
        methods.first().map_or(vec![], |m| m.design_totals.iter().map(|(g, _)| g.as_str()).collect());
    let threshold = comparison.threshold.map_or(NONE.to_owned(), |threshold| format!("{threshold:.1}"));
    let _ = write!(text, "| method | finished | evaluation | area under curve | steps to {threshold} |");
    // Whether a best total is known, from which the others are off.
    let known = |group: &&str| methods.iter().any(|m| m.design_error.iter().any(|(of, _)| of == group));
    let groups: Vec<(&str, bool)> = groups.into_iter().map(|group| (group, known(&group))).collect();
    for (group, known) in &groups {
        let _ = write!(text, " {} |{}", text::markdown(group), if *known { " error |" } else { "" });
    }
    text.push_str(" steps | smallest piece | time |\n|---|---|---|---|---|");
    text.extend(groups.iter().map(|(_, known)| if *known { "---|---|" } else { "---|" }));
    text.push_str("---|---|---|\n");
    for m in methods {
        text.push_str(&row(m, &groups));
    }
    text.push_str(
        "\nInterquartile means over the seeds that finished, with 95 % bootstrap intervals. *Evaluation*: discounted return of the\n\
         deterministic policy on held-out starts, on the hardware as built. *Area under curve*: mean discounted return of training\n\
         over the budget. *Steps to*: median real steps until the mean of the last 11 iterations reached that return. Design\n\
         totals are as built, lowest to highest seed, SI; *error* is their distance from the known optimum. All steps are real\n\
         simulator steps, those of every candidate and every training inside a search included. A method spends its budget in\n\
         pieces that it takes whole or not at all: episodes, or generations or candidates of a search.\n",
    );
    text.push_str(&few_seeds(methods));
    let missing: Vec<String> =
        methods.iter().flat_map(|m| m.missing.iter().map(|seed| seed_line(&m.label, &seed.to_string()))).collect();
    if !missing.is_empty() {
        let _ = write!(text, "\nSeeds that did not finish, which are in none of the figures:\n\n{}", missing.concat());
    }
    let still: String = methods.iter().filter_map(|m| Some(seed_line(&m.label, &m.unchanged()?))).collect();
    if !still.is_empty() {
        let _ = write!(text, "\nTrainings that changed nothing: {STILL}.\n\n{still}");
    }
    if let Some(others) = comparison.others() {
        let _ = write!(text, "\n{}\n", text::markdown(&others));
    }
    if !improvement.is_empty() {
        text.push_str("\n| method | against | probability of improvement |\n|---|---|---|\n");
        for p in improvement {
            let told = match p.improvement {
                Some(of) => interval(of.probability, of.interval, 2),
                None => NONE.to_owned(),
            };
            let _ = writeln!(text, "| {} | {} | {told} |", text::markdown(&p.method), text::markdown(&p.other));
        }
    }
    text
}

fn row(m: &MethodFigures, groups: &[(&str, bool)]) -> String {
    let seeds = if m.seeds == 1 { "1 seed".to_owned() } else { format!("{} seeds", m.seeds) };
    let figure = |figure: Option<Figure>, decimals: usize| match figure {
        Some(Figure { iqm, interval: None }) => format!("{iqm:.decimals$} ({seeds})"),
        Some(Figure { iqm, interval: Some(found) }) => interval(iqm, Some(found), decimals),
        None => NONE.to_owned(),
    };
    let steps = m.threshold.median_env_steps.map_or(NONE.to_owned(), |steps| format!("{:.2}M", steps / 1e6));
    let mut text = format!(
        "| {} | {} | {} | {} | {steps} ({} of {}) |",
        text::markdown(&m.label),
        m.finished(),
        figure(m.evaluation, 1),
        figure(m.area_under_curve, 1),
        m.threshold.seeds,
        m.seeds
    );
    for (group, known) in groups {
        let error = m.design_error.iter().find(|(g, _)| g == group).map(|(_, f)| *f);
        let totals = m.design_totals.iter().find(|(g, _)| g == group).map_or(&[][..], |(_, t)| t);
        let (low, high) = totals.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), &t| (l.min(t), h.max(t)));
        let totals = match (format!("{low:.4}"), format!("{high:.4}")) {
            _ if low > high => NONE.to_owned(),
            (low, high) if low == high => low,
            (low, high) => format!("{low} to {high}"),
        };
        let _ = write!(text, " {totals} |");
        if *known {
            let _ = write!(text, " {} |", figure(error, 4));
        }
    }
    let failed = match m.failed_candidates {
        0 => String::new(),
        n => format!(", {n} candidates failed"),
    };
    let taken = m.env_steps.map_or(NONE.to_owned(), |steps| grouped(steps.round() as u64));
    let budget = m.budget.map_or(String::new(), |budget| format!(" of {}", grouped(budget)));
    let piece = m.piece.as_ref().map_or(NONE.to_owned(), |p| format!("{}, {}", p.what, grouped(p.env_steps)));
    let time = m.wall_s.map_or(NONE.to_owned(), |wall_s| format!("{wall_s:.1} s"));
    let _ = writeln!(text, " {taken}{budget}{failed} | {piece} | {time} |");
    text
}

/// A line about a seed. Labels are typed, and reasons may come from anywhere.
fn seed_line(label: &str, seed: &str) -> String {
    format!("- {}, {}\n", text::markdown(label), text::markdown(seed))
}

/// What is not known of methods with few seeds, and the seeds themselves.
fn few_seeds(methods: &[MethodFigures]) -> String {
    let few = methods.iter().filter(|m| (1..LEAST_VALUES).contains(&m.seeds));
    let line = |m: &MethodFigures| {
        let values: Vec<String> = m.evaluations.iter().map(|value| format!("{value:.1}")).collect();
        format!("- {}: {}\n", text::markdown(&m.label), values.join(", "))
    };
    let lines: String = few.map(line).collect();
    if lines.is_empty() {
        return lines;
    }
    format!(
        "\nFewer than {LEAST_VALUES} seeds carry neither an interval nor a probability of improvement. Their evaluations:\n\n{lines}"
    )
}

fn interval(value: f64, interval: Option<Interval>, decimals: usize) -> String {
    match interval {
        Some(Interval { low, high }) => format!("{value:.decimals$} [{low:.decimals$}, {high:.decimals$}]"),
        None => format!("{value:.decimals$} (no interval)"),
    }
}

/// One line per method; a field is empty where there is nothing to tell.
pub(crate) fn csv(comparison: &Comparison) -> String {
    let mut text = String::from(
        "method,seeds,evaluation,evaluation_low,evaluation_high,area_under_curve,area_low,area_high,threshold,\
         threshold_seeds,threshold_env_steps,env_steps,wall_s,failed_candidates,asked_seeds,failed_seeds,budget,piece,\
         piece_env_steps,missing\n",
    );
    for m in &comparison.methods {
        let figure = |figure: Option<Figure>| {
            let interval = figure.and_then(|figure| figure.interval);
            [figure.map(|f| f.iqm), interval.map(|i| i.low), interval.map(|i| i.high)].map(told).join(",")
        };
        let missing: Vec<String> = m.missing.iter().map(ToString::to_string).collect();
        let fields = [
            quoted(&m.label),
            m.seeds.to_string(),
            figure(m.evaluation),
            figure(m.area_under_curve),
            told(comparison.threshold),
            m.threshold.seeds.to_string(),
            told(m.threshold.median_env_steps),
            told(m.env_steps),
            told(m.wall_s),
            m.failed_candidates.to_string(),
            told(m.asked()),
            m.asked().map_or(String::new(), |_| m.missing.iter().filter(|seed| seed.failed).count().to_string()),
            told(m.budget),
            m.piece.as_ref().map_or(String::new(), |piece| piece.what.clone()),
            told(m.piece.as_ref().map(|piece| piece.env_steps)),
            quoted(&missing.join("; ")),
        ];
        let _ = writeln!(text, "{}", fields.join(","));
    }
    text
}

fn told(value: Option<impl ToString>) -> String {
    value.map_or(String::new(), |value| value.to_string())
}

/// Labels hold what was typed: quoted, with quotes doubled.
fn quoted(text: &str) -> String {
    format!("\"{}\"", text.replace('"', "\"\""))
}
