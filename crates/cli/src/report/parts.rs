//! Parts and tolerances as text.

use std::fmt::Write;
use std::path::Path;

use hwasp_training::{Change, Evaluation, MeanInterval};
use hwasp_workshop::parts::{ChosenParts, JointDesign, JointParts, PartsList};
use hwasp_workshop::tolerances::{Sensitivities, Side};

use crate::output::shell;

/// Parameters that are printed: the file has all.
const MOST_SHOWN: usize = 24;

/// A parts list: what is chosen, and what that is worth.
pub(crate) fn parts(list: &PartsList) -> String {
    let PartsList { experiment, method, seed, catalogue, .. } = list;
    let mut text = format!(
        "\n{experiment} · {method} · seed {seed}: parts of the catalogue `{}` ({} springs)\n\n  {:<18}{:>20}{:>20}{:>20}   {:<22}{:>8}\n",
        catalogue.name,
        catalogue.springs,
        "joint",
        "pulley radius, mm",
        "rate, N·mm/rad",
        "preload, deg",
        "springs",
        "stress"
    );
    for JointParts { joint, trained, built, spring, .. } in &list.joints {
        let both = |of: fn(&JointDesign) -> f64, decimals: usize| {
            format!("{:.decimals$} → {:.decimals$}", of(trained), of(built))
        };
        let _ = writeln!(
            text,
            "  {:<18}{:>20}{:>20}{:>20}   {:<22}{:>6.0} %",
            joint.replace('_', " "),
            both(|d| 1e3 * d.radius, 3),
            both(|d| 1e3 * d.stiffness, 3),
            both(|d| d.preload.to_degrees(), 1),
            format!("{} × {}", spring.count, spring.part),
            100.0 * spring.stress_share
        );
    }
    let worth = &list.worth;
    let _ = writeln!(text, "\n  {}", heading(&worth.trained));
    text.push_str(&evaluated("as trained", &worth.trained));
    text.push_str(&evaluated("on these parts", &worth.snapped));
    text.push_str(&changed(&worth.snapping));
    if let Some(tuned) = &worth.tuned {
        text.push_str(&evaluated("trained further", &tuned.evaluation));
        text.push_str(&changed(&tuned.change));
    }
    if let Some(verdict) = &list.verdict {
        let _ = writeln!(text, "\n  {}", verdict.to_string().replace('\n', "\n  "));
    }
    text
}

fn heading(evaluation: &Evaluation) -> String {
    let Evaluation { episodes, seed, .. } = evaluation;
    format!("{episodes} held-out starts (seed {seed}), with 95 % intervals; changes episode by episode:")
}

fn evaluated(what: &str, evaluation: &Evaluation) -> String {
    let success = evaluation.success.first().map_or(String::new(), |rate| {
        format!("   success {:>5.1} % [{:.1}, {:.1}]", 100.0 * rate.rate(), 100.0 * rate.low, 100.0 * rate.high)
    });
    format!("  {what:<20} return {}{success}\n", interval(&evaluation.undiscounted_return, 1.0, 1))
}

fn changed(change: &Change) -> String {
    let success =
        change.success.as_ref().map_or(String::new(), |s| format!(", of success {} points", interval(s, 100.0, 1)));
    format!("  {:<20} a change of {}{success}\n", "", interval(&change.undiscounted_return, 1.0, 1))
}

fn interval(figure: &MeanInterval, scale: f64, decimals: usize) -> String {
    format!("{:.decimals$}", figure.scaled(scale))
}

/// Which parts print files are for.
pub(crate) fn printed_for(chosen: &ChosenParts, run: &Path) -> String {
    match &chosen.list {
        Some(list) => format!("what is printed is made for the parts in {}", list.display()),
        None => format!(
            "what is printed is made for springs of the catalogue that comes with the program; `hwasp parts {}` chooses others",
            shell(run)
        ),
    }
}

/// What errors of the parameters do, the costliest first.
pub(crate) fn tolerances(of: &Sensitivities) -> String {
    let Sensitivities { experiment, method, seed, nominal, parameters, .. } = of;
    let mut text = format!("\n{experiment} · {method} · seed {seed}: tolerances\n\n  {}\n", heading(nominal));
    text.push_str(&evaluated("as designed", nominal));
    let widest = parameters.iter().take(MOST_SHOWN).map(|p| p.name.len()).max().unwrap_or(0).max("parameter".len());
    let success = if nominal.success.is_empty() { "" } else { "of success, points" };
    let heading = format!(
        "  {:<widest$}  {:>18}{:>16}{:>20}   {:<30}{success}",
        "parameter", "designed", "error", "simulated", "change of return"
    );
    let _ = writeln!(text, "\n{}", heading.trim_end());
    for parameter in parameters.iter().take(MOST_SHOWN) {
        let designed = parameter.designed();
        for (sign, side) in [("−", &parameter.minus), ("+", &parameter.plus)] {
            let (name, designed) = if sign == "−" { (parameter.name.as_str(), designed.as_str()) } else { ("", "") };
            let error = format!("{sign}{}", parameter.off_by());
            let simulated = parameter.simulated(side);
            let Side { change, .. } = side;
            let success = change.success.as_ref().map_or(String::new(), |s| interval(s, 100.0, 1));
            let line = format!(
                "  {name:<widest$}  {designed:>18}{error:>16}{simulated:>20}   {:<30}{success}",
                interval(&change.undiscounted_return, 1.0, 1)
            );
            let _ = writeln!(text, "{}", line.trim_end());
        }
    }
    if parameters.len() > MOST_SHOWN {
        let _ = writeln!(text, "  … and {} that cost less", parameters.len() - MOST_SHOWN);
    }
    let _ = writeln!(text, "\n  {}", of.verdict());
    text
}
