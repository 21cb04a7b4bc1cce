//! Graphviz' language.

use std::fmt::Write as _;

use super::GraphStyle;
use super::graph::{Edge, Graph, Kind};
use super::simplify::reads_many;
use crate::ops::Binary;

pub(super) fn write(graph: &Graph, style: &GraphStyle) -> String {
    let mut text = String::from(
        "digraph law {\n  rankdir=LR; bgcolor=white;\n  \
         node [fontname=\"Helvetica,Arial,sans-serif\", fontsize=12, style=filled, color=\"#4b5563\"];\n  \
         edge [fontname=\"Helvetica,Arial,sans-serif\", fontsize=10, color=\"#6b7280\", arrowsize=0.7];\n",
    );
    if !style.title.is_empty() {
        line(
            &mut text,
            format_args!("  label={}; labelloc=t; fontname=\"Helvetica,Arial,sans-serif\";", quoted(&style.title)),
        );
    }
    for (i, node) in graph.nodes.iter().enumerate() {
        let look = match node.kind {
            Kind::Uniform => "shape=box, style=\"filled,rounded\", fillcolor=\"#dbeafe\", color=\"#2563eb\"",
            Kind::Column => "shape=box, style=\"filled,rounded\", fillcolor=\"#dcfce7\", color=\"#16a34a\"",
            Kind::Constant => "shape=plaintext, style=\"\", fontcolor=\"#9ca3af\"",
            Kind::Output => "shape=box, style=\"filled,rounded,bold\", fillcolor=\"#ffedd5\", color=\"#ea580c\"",
            Kind::Unary(_) | Kind::Binary(_) | Kind::Clamp => "shape=ellipse, fillcolor=white",
        };
        let stacked = if node.members.is_empty() { "" } else { ", peripheries=2" };
        line(&mut text, format_args!("  n{i} [label={}, {look}{stacked}];", quoted(&node.label)));
    }
    for (i, node) in graph.nodes.iter().enumerate() {
        for (position, edge) in node.inputs.iter().enumerate() {
            let mark = mark(edge, graph, i, position);
            let mut looks = Vec::new();
            if !mark.is_empty() {
                looks.push(format!("label={}", quoted(&mark)));
            }
            if reads_many(edge, &graph.nodes) {
                looks.push("penwidth=2".into());
            }
            let looks = if looks.is_empty() { String::new() } else { format!(" [{}]", looks.join(", ")) };
            line(&mut text, format_args!("  n{} -> n{i}{looks};", edge.from));
        }
    }
    text.push_str("}\n");
    text
}

/// What stands beside an edge: a minus, the divisor, the members that are meant.
pub(super) fn mark(edge: &Edge, graph: &Graph, to: usize, position: usize) -> String {
    let node = &graph.nodes[to];
    let mut mark = String::new();
    if edge.minus {
        mark.push('−');
    }
    if let (Kind::Binary(op), 1) = (node.kind, position) {
        mark.push_str(match op {
            Binary::Div => "divisor",
            Binary::Less => "the larger",
            Binary::Gate => "then",
            Binary::Add | Binary::Sub | Binary::Mul | Binary::Min | Binary::Max => "",
        });
    }
    if let [first, .., last] = edge.only[..] {
        let _ = write!(mark, "[{first} … {last}]");
    } else if let [only] = edge.only[..] {
        let _ = write!(mark, "[{only}]");
    }
    mark
}

fn line(text: &mut String, arguments: std::fmt::Arguments<'_>) {
    // Writing to a string cannot fail.
    let _ = writeln!(text, "{arguments}");
}

fn quoted(label: &str) -> String {
    format!("\"{}\"", label.replace('\\', "\\\\").replace('"', "\\\""))
}
