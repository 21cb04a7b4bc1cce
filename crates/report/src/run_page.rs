//! The report of one run, section by section.

use hwasp_runs::text::{ReadableUnit, grouped};
use hwasp_runs::{RunError, Summary};

use crate::episode;
use crate::page::{KeyFigure, Page};
use crate::run::Run;
use crate::sections::provenance::begun;
use crate::sections::{curves, design, files, hand, law, outcome, overview, parts, provenance, tolerances, verdict};
use crate::trials::Played;
use crate::words::{decimal, duration, mean_interval, percent, rate_interval};

/// The report.
pub(crate) fn page(run: &Run) -> Result<Page, RunError> {
    let played = Played::new(run)?;
    let trials = played.as_ref().ok().map(|played| &played.trials);
    let mut sections = vec![verdict::section(run, trials), overview::section(run, trials)];
    sections.extend([episode::section(run, &played), outcome::section(run, trials)]);
    sections.extend([curves::section(run), design::section(run)]);
    if let Some(hand) = &run.design.hand {
        sections.extend([hand::section(run, hand, played.as_ref().ok()), parts::section(run)]);
    }
    sections.extend((!run.design.groups.is_empty()).then(|| tolerances::section(run)));
    // A world may have no law: its design is in the model.
    sections.extend((!run.spec.task.built().training.env.effort.is_empty()).then(|| law::section(run)));
    sections.extend([provenance::section(run), files::section(run)]);
    let (kind, lead) = ("Run", run.spec.description.clone());
    Ok(Page { title: run.title(), kind, lead, figures: key_figures(run), sections })
}

fn key_figures(run: &Run) -> Vec<KeyFigure> {
    let Summary { evaluation, env_steps, wall_s, .. } = &run.summary;
    let figure = |label: &str, value: String, note: String| KeyFigure { label: label.into(), value, note };
    let mut figures = Vec::new();
    if let Some(all) = evaluation.success.first() {
        let of = format!("{} of {}; 95 % interval {}", all.successes, all.episodes, rate_interval(all));
        figures.push(figure("Success", percent(all.rate()), of));
    }
    for group in run.design.groups.iter().filter(|group| group.group.optimum.is_some()) {
        let shown = ReadableUnit::of(&group.group);
        let best = group.group.optimum.map_or(String::new(), |best| format!("best known {}", shown.with_unit(best)));
        let label = if group.position.len() == 1 { String::new() } else { "Total ".to_owned() };
        let label = label + &group.name;
        figures.push(figure(&label, shown.with_unit(group.group.total_as_built), best));
    }
    for (label, of) in
        [("Return", &evaluation.undiscounted_return), ("Discounted return", &evaluation.discounted_return)]
    {
        let named = if of.interval.is_some() { "95 % interval " } else { "" };
        figures.push(figure(label, decimal(of.mean, 1), format!("{named}{}", mean_interval(of, 1))));
    }
    let parameters: usize = run.design.groups.iter().map(|group| group.position.len()).sum();
    let of = if parameters == 1 { "number of the body" } else { "numbers of the body" };
    figures.push(figure("Designed", parameters.to_string(), of.into()));
    figures.push(figure("Simulator steps", grouped(*env_steps), format!("in {}", duration(*wall_s))));
    figures.extend(run.provenance.as_ref().map(|provenance| begun("Trained", provenance)));
    figures
}
