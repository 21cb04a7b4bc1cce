//! What pictures of an experiment say: its law as a graph, and the texts of its curves.

use hwasp_core::unit;
use hwasp_diff::GraphStyle;

use crate::assemble::{AssembleError, Assembly, law};
use crate::plot::{PanelText, PlotOptions, RETURN};
use crate::spec::Spec;
use crate::summary::DesignGroupSummary;

/// A computational graph in two formats.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Drawing {
    /// Graphviz DOT.
    pub dot: String,
    /// SVG.
    pub svg: String,
}

impl Assembly {
    /// Draws what the policy computes behind the controller's outputs, design parameters and law included, as in the
    /// paper's figures of computational graphs.
    pub fn drawing(&self) -> Drawing {
        let policy = &self.policy;
        let spec = self.spec();
        let style = GraphStyle { title: format!("{} · {}", spec.name, spec.method.name()), ..GraphStyle::default() };
        Drawing { dot: policy.program().to_dot_with(&style), svg: policy.program().to_svg_with(&style) }
    }

    /// Axis texts, units and known optima for pictures of such runs.
    pub fn plot_options(&self, title: String) -> PlotOptions {
        let mut panels = vec![return_text()];
        for (group, optimum) in self.policy.space().groups().iter().zip(&self.problem.optimum) {
            // The curve shows the design as trained; the optimum is of the design as built.
            let optimum = optimum.filter(|_| self.trains_what_is_built());
            panels.push(total_text((&group.name, group.count), (group.dimension.si(), group.hi), optimum));
        }
        PlotOptions { title, panels, ..PlotOptions::default() }
    }

    /// Whether the design as trained is the design to build.
    fn trains_what_is_built(&self) -> bool {
        let space = self.policy.space();
        let middle: Vec<f64> = (0..space.len()).map(|i| 0.5 * (space.bounds(i).0 + space.bounds(i).1)).collect();
        self.problem.training.law.as_built(&middle) == middle
    }
}

/// The axis text of the return.
fn return_text() -> PanelText {
    PanelText { column: RETURN.into(), label: "discounted return".into(), ..PanelText::default() }
}

/// The column of a group's total; a group of one is its own.
pub(crate) fn total_name(group: &str, count: usize) -> String {
    if count == 1 { group.to_owned() } else { format!("{group}_total") }
}

/// The axis text of the total of a group of parameters, each of which has the SI `unit` and is at most `hi`.
fn total_text((group, count): (&str, usize), (si, hi): (&str, f64), optimum: Option<f64>) -> PanelText {
    let name = group.replace('_', " ");
    let label = if count == 1 { name } else { format!("total {name}") };
    let shown = unit(si).map_or("", |unit| unit.readable(hi * count as f64).symbol);
    PanelText { column: total_name(group, count), label, unit: shown.into(), optimum }
}

/// What [`Assembly::plot_options`] says, of a saved design: without the engine, too.
pub(crate) fn saved_plot_options<'g>(
    groups: impl IntoIterator<Item = (&'g str, &'g DesignGroupSummary)>,
) -> PlotOptions {
    let total = |(name, group): (&'g str, &'g DesignGroupSummary)| {
        let optimum = group.optimum.filter(|_| group.as_built == group.values);
        total_text((name, group.values.len()), (&group.unit, group.limits[1]), optimum)
    };
    let panels = std::iter::once(return_text()).chain(groups.into_iter().map(total)).collect();
    PlotOptions { panels, ..PlotOptions::default() }
}

/// Draws the law of an experiment by itself, design parameters with their units.
pub(crate) fn law_svg(spec: &Spec) -> Result<String, AssembleError> {
    let units = spec.task.groups().into_iter().map(|group| (group.name.to_owned(), group.dimension.si().to_owned()));
    let style = GraphStyle { units: units.collect(), ..GraphStyle::default() };
    Ok(law(spec)?.program().to_svg_with(&style))
}
