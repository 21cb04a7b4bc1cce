//! Drawings of a traced law as a computational graph, in Graphviz' language or as SVG.
//!
//! Inputs named as a group (`stiffness[0]`, `stiffness[1]`, …) are one node; operations done alike on each member are one
//! node too; sums over a group are one Σ.

mod dot;
mod graph;
mod layout;
mod names;
mod simplify;
mod svg;

use graph::Graph;

use crate::Program;

/// What a drawing says beside the graph itself.
///
/// | name | default | purpose |
/// |---|---|---|
/// | `title` | empty | a line above the graph |
/// | `units` | empty | (name, unit) pairs; the name of a group is given without brackets |
/// | `uniform_legend` | "design parameter" | what the uniform inputs are |
/// | `column_legend` | "input per row" | what the input columns are |
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct GraphStyle {
    /// A line above the graph; none if empty.
    pub title: String,
    /// Pairs of an input's or output's name (a group's without brackets) and its unit.
    pub units: Vec<(String, String)>,
    /// What the uniform inputs are, for the legend.
    pub uniform_legend: String,
    /// What the input columns are, for the legend.
    pub column_legend: String,
}

impl Default for GraphStyle {
    fn default() -> Self {
        Self {
            title: String::new(),
            units: Vec::new(),
            uniform_legend: "design parameter".into(),
            column_legend: "input per row".into(),
        }
    }
}

impl Program {
    /// The law as a graph in Graphviz' language.
    pub fn to_dot(&self) -> String {
        self.to_dot_with(&GraphStyle::default())
    }

    /// The law as a graph in Graphviz' language, with title and units.
    pub fn to_dot_with(&self, style: &GraphStyle) -> String {
        dot::write(&Graph::of(self, style), style)
    }

    /// The law as a picture of its own: an SVG document with a light background, inputs on the left.
    pub fn to_svg(&self) -> String {
        self.to_svg_with(&GraphStyle::default())
    }

    /// The law as an SVG document, with title and units.
    pub fn to_svg_with(&self, style: &GraphStyle) -> String {
        svg::write(&Graph::of(self, style), style)
    }
}
