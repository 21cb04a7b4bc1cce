//! The law of an experiment as a graph.

use hwasp_diff::GraphStyle;
use hwasp_training::spec::Spec;
use hwasp_training::{AssembleError, Assembly, law};

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
    let spec = assembly.spec();
    let style = GraphStyle { title: format!("{} · {}", spec.name, spec.method.name()), ..GraphStyle::default() };
    Drawing { dot: policy.program().to_dot_with(&style), svg: policy.program().to_svg_with(&style) }
}

/// Draws the law of an experiment by itself, design parameters with their units.
pub fn law_svg(spec: &Spec) -> Result<String, AssembleError> {
    let units = spec.task.groups().into_iter().map(|group| (group.name.to_owned(), group.dimension.si().to_owned()));
    let style = GraphStyle { units: units.collect(), ..GraphStyle::default() };
    Ok(law(spec)?.program().to_svg_with(&style))
}
