//! How it was learned.

use hwasp_plot::{Curve, PanelPlot, PanelPlots, XAxis, curve_panels, saved_plot_options};
use hwasp_tasks::hand::names::KINDS as JOINTS;
use maud::{Markup, html};

use crate::figure::{gallery, picture};
use crate::page::Section;
use crate::run::Run;
use crate::words::sentence;

pub(crate) fn section(run: &Run) -> Section {
    let mut curve = Curve::from_table(run.title(), &run.metrics, XAxis::EnvSteps, 0);
    if run.design.hand.is_some() {
        // Radius, stiffness and preload of one joint after the other: a row for each where there are three columns.
        curve.totals.sort_by_key(|(name, _)| JOINTS.iter().position(|joint| name.starts_with(joint)));
    }
    let groups = run.design.groups.iter().map(|group| (group.name.as_str(), &group.group));
    let body = match curve_panels(&[curve], &saved_plot_options(groups)) {
        Ok(plots) => panels(&plots, "curve", "against real simulator steps of training"),
        Err(error) => html! { p { "The learning curve cannot be drawn: " (error) "." } },
    };
    Section { id: "curves", title: "How it was learned", body }
}

/// Pictures of panels; `against` says what is on their horizontal axes.
pub(crate) fn panels(plots: &PanelPlots, id: &str, against: &str) -> Markup {
    let described = |(i, panel): (usize, &PanelPlot)| {
        picture(&panel.svg, &format!("{id}-{i}"), &format!("{} {against}", sentence(&panel.label)), &plots.explanation)
    };
    let pictures: Vec<Markup> = plots.panels.iter().enumerate().map(described).collect();
    let explanation = if plots.explanation.is_empty() { String::new() } else { sentence(&plots.explanation) + "." };
    // The returns have a row to themselves above many numbers of a design.
    let returns = plots.panels.iter().take_while(|panel| panel.label.ends_with("return")).count();
    let (head, others) = pictures.split_at(if pictures.len() > 4 { returns } else { 0 });
    html! {
        @if !head.is_empty() { (gallery(head, "")) }
        (gallery(others, &explanation))
        @if !plots.notes.is_empty() { ul.notes { @for note in &plots.notes { li { (note.to_string()) } } } }
    }
}
