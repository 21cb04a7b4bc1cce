//! The law of an experiment as a picture.

use hwasp_diff::GraphStyle;

use crate::assemble::Assembly;

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
}
