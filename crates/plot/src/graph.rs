//! The law of an experiment as a graph.

use hwasp_diff::GraphStyle;
use hwasp_experiment::Experiment;
use hwasp_training::Assembly;

/// A computational graph in two formats.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Drawing {
    /// Graphviz DOT.
    pub dot: String,
    /// SVG.
    pub svg: String,
}

/// Draws what the policy computes behind the controller's outputs, design parameters and law included, as in the paper's
/// figures of computational graphs.
pub fn drawing(assembly: &Assembly) -> Drawing {
    let policy = &assembly.policy;
    let spec = assembly.experiment();
    let style = GraphStyle { title: format!("{} · {}", spec.name, spec.method.name()), ..GraphStyle::default() };
    Drawing { dot: policy.program().to_dot_with(&style), svg: policy.program().to_svg_with(&style) }
}

/// Draws the law of an experiment by itself, design parameters with their units.
pub fn law_svg(spec: &Experiment) -> String {
    let units = spec.task.groups().into_iter().map(|group| (group.name, group.dimension.si().to_owned()));
    let style = GraphStyle { units: units.collect(), ..GraphStyle::default() };
    spec.task.built().training.law.program().to_svg_with(&style)
}
