//! What pictures of a run say: its curve, axis texts, units and known optima.

use hwasp_core::unit;
use hwasp_runs::{DesignGroupSummary, ExtraFiles, RunError, SavedRun};
use hwasp_training::{Assembly, total_name};

use crate::curve::{Curve, DISCOUNTED, RETURN, XAxis};
use crate::curves::curves;
use crate::options::{PanelText, PlotOptions};

/// The picture of a run's learning curve.
const CURVES: &str = "curves.svg";

/// What a finished run has beside its numbers: `curves.svg`, where there is a row to be drawn. For `RunFolder::finish`.
pub fn curves_svg(saved: &SavedRun) -> ExtraFiles {
    let curve = saved_curve(saved, XAxis::EnvSteps)?;
    if curve.x.is_empty() {
        return Ok(Vec::new());
    }
    let plot = curves(&[curve], &plot_options(saved.assembly(), String::new()))?;
    Ok(vec![(CURVES.to_owned(), plot.svg.into_bytes())])
}

/// The learning curve of a run, labelled with experiment and method.
pub fn saved_curve(saved: &SavedRun, axis: XAxis) -> Result<Curve, RunError> {
    let table = saved.metrics()?;
    let spec = saved.assembly().experiment();
    let label = format!("{} · {}", spec.name, spec.method.name());
    Ok(Curve::from_table(label, &table, axis, spec.train.nominal_steps))
}

/// Axis texts, units and known optima for pictures of such runs.
pub fn plot_options(assembly: &Assembly, title: String) -> PlotOptions {
    let mut panels = return_texts().to_vec();
    for (group, optimum) in assembly.policy.space().groups().iter().zip(&assembly.worlds.optimum) {
        // The curve shows the design as trained; the optimum is of the design as built.
        let optimum = optimum.filter(|_| trains_what_is_built(assembly));
        panels.push(total_text((&group.name, group.count), (group.dimension.si(), group.hi), optimum));
    }
    PlotOptions { title, panels, ..PlotOptions::default() }
}

/// Whether the design as trained is the design to build.
fn trains_what_is_built(assembly: &Assembly) -> bool {
    let space = assembly.policy.space();
    let middle = space.middle();
    assembly.worlds.training.law.as_built(&middle) == middle
}

/// The axis texts of the returns.
fn return_texts() -> [PanelText; 2] {
    [(RETURN, "return"), (DISCOUNTED, "discounted return")].map(|(column, label)| PanelText {
        column: column.into(),
        label: label.into(),
        ..PanelText::default()
    })
}

/// The axis text of the total of a group of parameters, each of which has the SI `unit` and is at most `hi`.
fn total_text((group, count): (&str, usize), (si, hi): (&str, f64), optimum: Option<f64>) -> PanelText {
    let name = group.replace('_', " ");
    let label = if count == 1 { name } else { format!("total {name}") };
    let shown = unit(si).map_or("", |unit| unit.readable(hi * count as f64).symbol);
    PanelText { column: total_name(group, count), label, unit: shown.into(), optimum }
}

/// What [`plot_options`] says, of a saved design: without the engine, too.
pub fn saved_plot_options<'g>(groups: impl IntoIterator<Item = (&'g str, &'g DesignGroupSummary)>) -> PlotOptions {
    let total = |(name, group): (&'g str, &'g DesignGroupSummary)| {
        let optimum = group.optimum.filter(|_| group.as_built == group.values);
        total_text((name, group.values.len()), (&group.unit, group.limits[1]), optimum)
    };
    let panels = return_texts().into_iter().chain(groups.into_iter().map(total)).collect();
    PlotOptions { panels, ..PlotOptions::default() }
}
