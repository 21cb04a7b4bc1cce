//! What pictures of an experiment say: its law as a graph, and the texts of its curves.

use hwasp_core::unit;
use hwasp_diff::GraphStyle;

use crate::assemble::Assembly;
use crate::plot::{PanelText, PlotOptions, RETURN};

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
        let mut panels =
            vec![PanelText { column: RETURN.into(), label: "discounted return".into(), ..PanelText::default() }];
        let groups = self.policy.space().groups();
        for ((column, group), optimum) in self.total_names().into_iter().zip(groups).zip(&self.problem.optimum) {
            let name = group.name.replace('_', " ");
            let label = if group.count == 1 { name } else { format!("total {name}") };
            let most = group.hi * group.count as f64;
            let shown = unit(group.dimension.si()).map_or("", |unit| unit.readable(most).symbol);
            // The curve shows the design as trained; the optimum is of the design as built.
            let same = self.trains_what_is_built();
            let optimum = optimum.filter(|_| same);
            panels.push(PanelText { column, label, unit: shown.into(), optimum });
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
