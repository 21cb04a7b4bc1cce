//! Long chains of one operation become one node, as a person would draw them.

use super::graph::{Edge, Graph, Kind, Node};
use super::names::number;
use crate::ops::{Binary, Unary};

/// Merges chains of sums, products, minima and maxima, recognises clamps, and drops what is no longer used.
pub(super) fn simplify(graph: Graph) -> Graph {
    let mut nodes = graph.nodes;
    clamps(&mut nodes);
    let uses = uses(&nodes);
    // Where a sum with one term only has been replaced by the term.
    let mut alias: Vec<usize> = (0..nodes.len()).collect();
    for i in 0..nodes.len() {
        for edge in &mut nodes[i].inputs {
            edge.from = alias[edge.from];
        }
        let Kind::Binary(op) = nodes[i].kind else {
            continue;
        };
        let op = if op == Binary::Sub { Binary::Add } else { op };
        if matches!(op, Binary::Div | Binary::Less | Binary::Gate) {
            continue;
        }
        let terms = merged(terms(&nodes, &uses, i, op), &nodes);
        if let [Edge { from, only, minus: false }] = &terms[..]
            && only.is_empty()
            && nodes[*from].members.len() == nodes[i].members.len()
        {
            alias[i] = *from;
            continue;
        }
        let reduces = terms.iter().any(|edge| reads_many(edge, &nodes) && nodes[i].members.is_empty());
        nodes[i].label = match op {
            Binary::Add if reduces => "Σ".into(),
            Binary::Mul if reduces => "Π".into(),
            op => super::names::binary(op).into(),
        };
        nodes[i].kind = Kind::Binary(op);
        nodes[i].inputs = terms;
    }
    compact(nodes)
}

/// Whether an edge carries several members of a group.
pub(super) fn reads_many(edge: &Edge, nodes: &[Node]) -> bool {
    if edge.only.is_empty() { nodes[edge.from].members.len() > 1 } else { edge.only.len() > 1 }
}

/// How many operations read each node; members read one by one count once each.
fn uses(nodes: &[Node]) -> Vec<usize> {
    let mut uses = vec![0; nodes.len()];
    for edge in nodes.iter().flat_map(|node| &node.inputs) {
        uses[edge.from] += 1;
    }
    uses
}

/// `min(max(x, lo), hi)` as one node.
fn clamps(nodes: &mut [Node]) {
    let uses = uses(nodes);
    for i in 0..nodes.len() {
        let (Kind::Binary(Binary::Min), [value, hi]) = (nodes[i].kind, &nodes[i].inputs[..]) else {
            continue;
        };
        let inner = &nodes[value.from];
        let (Kind::Binary(Binary::Max), [x, lo]) = (inner.kind, &inner.inputs[..]) else {
            continue;
        };
        let limit = |edge: &Edge| match &nodes[edge.from].values[..] {
            [first, rest @ ..] if rest.iter().all(|value| value == first) => Some(*first),
            _ => None,
        };
        if let (Some(lo), Some(hi), 1) = (limit(lo), limit(hi), uses[value.from])
            && inner.members == nodes[i].members
        {
            let x = x.clone();
            nodes[i].label = format!("clamp {} … {}", number(lo), number(hi));
            nodes[i].kind = Kind::Clamp;
            nodes[i].inputs = vec![x];
        }
    }
}

/// The operands of node `i`, where an operand that only this node reads and that is the same operation on as many members
/// is replaced by its own operands.
fn terms(nodes: &[Node], uses: &[usize], i: usize, op: Binary) -> Vec<Edge> {
    let node = &nodes[i];
    let mut terms = Vec::new();
    for (position, edge) in node.inputs.iter().enumerate() {
        let minus = edge.minus != (node.kind == Kind::Binary(Binary::Sub) && position == 1);
        let from = &nodes[edge.from];
        let inner = uses[edge.from] == 1 && edge.only.is_empty() && from.members == node.members;
        let is_zero = !from.values.is_empty() && from.values.iter().all(|value| *value == 0.0);
        if inner && from.kind == Kind::Binary(op) {
            terms.extend(from.inputs.iter().map(|edge| Edge { minus: edge.minus != minus, ..edge.clone() }));
        } else if inner && op == Binary::Add && from.kind == Kind::Unary(Unary::Neg) {
            terms.extend(from.inputs.iter().map(|edge| Edge { minus: edge.minus == minus, ..edge.clone() }));
        } else if !(op == Binary::Add && is_zero) {
            terms.push(Edge { minus, ..edge.clone() });
        }
    }
    terms
}

/// Joins the terms that are members of one group.
fn merged(terms: Vec<Edge>, nodes: &[Node]) -> Vec<Edge> {
    let mut merged: Vec<Edge> = Vec::new();
    for term in terms {
        let known = merged.iter_mut().find(|known| {
            known.from == term.from
                && known.minus == term.minus
                && !term.only.is_empty()
                && !known.only.is_empty()
                && known.only.iter().all(|member| !term.only.contains(member))
        });
        match known {
            Some(known) => known.only.extend(term.only),
            None => merged.push(term),
        }
    }
    for edge in &mut merged {
        edge.only.sort_unstable();
        let mut all = nodes[edge.from].members.clone();
        all.sort_unstable();
        if edge.only == all {
            edge.only.clear();
        }
    }
    merged
}

/// Keeps the inputs and what an output needs.
fn compact(nodes: Vec<Node>) -> Graph {
    let mut kept: Vec<bool> =
        nodes.iter().map(|node| matches!(node.kind, Kind::Uniform | Kind::Column | Kind::Output)).collect();
    for i in (0..nodes.len()).rev() {
        if kept[i] {
            for edge in &nodes[i].inputs {
                kept[edge.from] = true;
            }
        }
    }
    let mut place = vec![0; nodes.len()];
    let mut left: Vec<Node> = Vec::new();
    for (i, mut node) in nodes.into_iter().enumerate() {
        if kept[i] {
            for edge in &mut node.inputs {
                edge.from = place[edge.from];
            }
            place[i] = left.len();
            left.push(node);
        }
    }
    Graph { nodes: left }
}
