//! Pictures of runs: a panel for each of the returns and one for each design total and each term of the reward.

use hwasp_runs::metrics::TERM;

use crate::curve::{Curve, DISCOUNTED, RETURN};
use crate::error::{LONGEST_WINDOW, MOST_PANELS, MOST_RUNS, PlotError};
use crate::options::{PanelText, PlotOptions};
use crate::picture::{PanelPlots, Plot};
use crate::series::{self, Note};
use crate::{draw, panel};

/// Draws the runs: panels for return and discounted return, and one for each design total and each term of the
/// reward, one colour per label.
pub fn curves(runs: &[Curve], options: &PlotOptions) -> Result<Plot, PlotError> {
    let Drawn { panels, entries, explanation, notes } = Drawn::new(runs, options)?;
    let page = draw::Page {
        title: &options.title,
        untitled: "learning curves",
        explanation,
        theme: options.theme,
        ..draw::Page::default()
    };
    Ok(Plot { theme: options.theme, svg: draw::picture(&panels, &entries, &page), notes })
}

/// Draws the same panels, each as a small picture of its own without a title; with a legend where there are several labels.
pub fn curve_panels(runs: &[Curve], options: &PlotOptions) -> Result<PanelPlots, PlotError> {
    let Drawn { panels, mut entries, explanation, notes } = Drawn::new(runs, options)?;
    if entries.len() == 1 {
        entries.clear();
    }
    Ok(PanelPlots {
        panels: draw::one_by_one(panels, |_| &entries[..], draw::Page::default().reference),
        explanation,
        notes,
    })
}

/// What is to be drawn.
struct Drawn<'r> {
    panels: Vec<panel::Panel>,
    entries: Vec<draw::Entry<'r>>,
    explanation: String,
    notes: Vec<Note>,
}

impl<'r> Drawn<'r> {
    fn new(runs: &'r [Curve], options: &PlotOptions) -> Result<Self, PlotError> {
        if runs.is_empty() {
            return Err(PlotError::NoRuns);
        }
        if runs.len() > MOST_RUNS {
            return Err(PlotError::Runs(runs.len()));
        }
        if !(1..=LONGEST_WINDOW).contains(&options.window) {
            return Err(PlotError::Window(options.window));
        }
        // Labels and columns in the order in which they are first seen.
        let mut groups: Vec<Vec<&Curve>> = Vec::new();
        let told = runs.iter().any(|run| run.column(RETURN).is_some());
        let mut columns = if told { vec![RETURN, DISCOUNTED] } else { vec![DISCOUNTED] };
        for run in runs {
            match groups.iter_mut().find(|group| group[0].label == run.label) {
                Some(group) => group.push(run),
                None => groups.push(vec![run]),
            }
            for (name, _) in run.columns() {
                if !columns.contains(&name.as_str()) {
                    columns.push(name);
                }
            }
        }
        let mut notes = Vec::new();
        if columns.len() > MOST_PANELS {
            notes.push(Note::Panels { left_out: columns.len() - MOST_PANELS });
            columns.truncate(MOST_PANELS);
        }
        let mut panels = Vec::new();
        for column in columns {
            let shapes = groups.iter().map(|group| series::shape(group, column, options, &mut notes));
            panels.push(panel::Panel::new(
                text_of(column, options),
                options.x_axis.label(),
                shapes.collect::<Result<_, _>>()?,
            ));
        }
        let asked = |label: &str| options.asked.iter().find(|(of, _)| of == label).map(|(_, runs)| *runs);
        let entry = |(place, group): (usize, &Vec<&'r Curve>)| {
            let (label, runs) = (group[0].label.as_str(), group.len());
            draw::Entry { place, label, runs, asked: asked(label).unwrap_or(runs) }
        };
        let missing = options.asked.iter().map(|(label, _)| label.as_str());
        let missing: Vec<&str> = missing.filter(|label| groups.iter().all(|group| group[0].label != *label)).collect();
        let explanation = draw::explanation(&panels, options, &missing);
        Ok(Self { panels, entries: groups.iter().enumerate().map(entry).collect(), explanation, notes })
    }
}

/// The panel's text: as given, or the column's own name without underscores.
fn text_of(column: &str, options: &PlotOptions) -> PanelText {
    let given = options.panels.iter().find(|panel| panel.column == column).cloned();
    let mut text = given.unwrap_or_default();
    if text.label.is_empty() {
        let term = column.strip_prefix(TERM).map(|name| format!("reward: {name}"));
        text.label = term.unwrap_or_else(|| column.to_owned()).replace('_', " ");
    }
    // An optimum that is no number, or dwarfs everything, is no line.
    text.optimum = text.optimum.filter(|value| value.abs() <= series::LARGEST);
    text
}
