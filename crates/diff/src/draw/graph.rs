//! From a program to the graph that is drawn: what is done alike on each member of a group becomes one node.

use std::collections::{BTreeSet, HashMap, HashSet};

use super::names::{self, labelled};
use super::{GraphStyle, simplify};
use crate::Program;
use crate::ops::{Binary, Unary};
use crate::program::{Instruction, Slot};

/// What a node stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Kind {
    Uniform,
    Column,
    Constant,
    Unary(Unary),
    Binary(Binary),
    /// Kept between two constants.
    Clamp,
    Output,
}

/// A node, standing for all members of a group or for one value.
#[derive(Clone, Debug)]
pub(super) struct Node {
    pub(super) kind: Kind,
    pub(super) label: String,
    /// The indices of the members; empty for a single value.
    pub(super) members: Vec<usize>,
    pub(super) inputs: Vec<Edge>,
    /// The values of a constant, one per member if they differ by member.
    pub(super) values: Vec<f64>,
}

/// An edge into a node.
#[derive(Clone, Debug)]
pub(super) struct Edge {
    pub(super) from: usize,
    /// The members of a group that are meant, if not all.
    pub(super) only: Vec<usize>,
    /// Where the edge enters a sum with a minus.
    pub(super) minus: bool,
}

/// Nodes in an order in which inputs come first.
#[derive(Clone, Debug)]
pub(super) struct Graph {
    pub(super) nodes: Vec<Node>,
}

impl Graph {
    /// The graph of a program, grouped and simplified.
    pub(super) fn of(program: &Program, style: &GraphStyle) -> Self {
        let raw = Raw::of(program);
        let classes = classify(&raw);
        simplify::simplify(collect(&raw, &classes, style))
    }
}

/// A single value of the program.
struct Raw<'a> {
    kind: Kind,
    name: &'a str,
    value: f64,
    args: Vec<usize>,
}

impl<'a> Raw<'a> {
    /// All values of a program: inputs, then instructions with their constants, then outputs.
    fn of(program: &'a Program) -> Vec<Self> {
        let input = |kind| move |name: &'a String| Raw { kind, name, value: 0.0, args: Vec::new() };
        let uniforms = program.uniform_names().len();
        let columns = program.column_names().len();
        let mut raw: Vec<_> = program.uniform_names().iter().map(input(Kind::Uniform)).collect();
        raw.extend(program.column_names().iter().map(input(Kind::Column)));
        let mut place: HashMap<Slot, usize> = HashMap::new();
        let read = |slot, raw: &mut Vec<Self>, place: &HashMap<Slot, usize>| match slot {
            Slot::Uniform(u) if u < uniforms => u,
            Slot::Column(c) => uniforms + c,
            // A constant is drawn beside each of its uses.
            Slot::Constant(c) => {
                raw.push(Raw { kind: Kind::Constant, name: "", value: program.constants()[c], args: Vec::new() });
                raw.len() - 1
            }
            slot => place[&slot],
        };
        let uniform_code = program.uniform_code().iter().enumerate().map(|(k, i)| (Slot::Uniform(uniforms + k), i));
        let row_code = program.row_code().iter().enumerate().map(|(k, i)| (Slot::Register(k), i));
        for (slot, instruction) in uniform_code.chain(row_code) {
            let kind = match *instruction {
                Instruction::Unary(op, _) => Kind::Unary(op),
                Instruction::Binary(op, _, _) => Kind::Binary(op),
            };
            let args = instruction.operands().map(|slot| read(slot, &mut raw, &place)).collect();
            raw.push(Raw { kind, name: "", value: 0.0, args });
            place.insert(slot, raw.len() - 1);
        }
        for (name, &slot) in program.output_names().iter().zip(program.output_slots()) {
            let args = vec![read(slot, &mut raw, &place)];
            raw.push(Raw { kind: Kind::Output, name, value: 0.0, args });
        }
        debug_assert!(raw.len() >= uniforms + columns);
        raw
    }
}

/// What makes values members of one group.
#[derive(Clone, PartialEq, Eq, Hash)]
struct Key {
    kind: Kind,
    base: String,
    args: Vec<ArgKey>,
    /// Counts the equal operations on one member.
    repeat: usize,
}

#[derive(Clone, PartialEq, Eq, Hash)]
enum ArgKey {
    Group(usize),
    Shared(usize),
    Constant,
}

/// The group and member index of a value; none if it stands for itself.
type Class = Option<(usize, usize)>;

/// Finds the groups. A group counts only if the operation is done on all members of what it reads, so candidates are
/// taken back until all that remain are whole.
fn classify(raw: &[Raw<'_>]) -> Vec<Class> {
    let mut ids: HashMap<Key, usize> = HashMap::new();
    let mut rejected: HashSet<usize> = HashSet::new();
    loop {
        let mut classes: Vec<Class> = Vec::with_capacity(raw.len());
        let mut members: HashMap<usize, BTreeSet<usize>> = HashMap::new();
        let mut reads: HashMap<usize, Vec<usize>> = HashMap::new();
        for node in raw {
            let class = candidate(node, raw, &classes).map(|(mut key, index)| {
                loop {
                    let next = ids.len();
                    let id = *ids.entry(key.clone()).or_insert(next);
                    if members.entry(id).or_default().insert(index) {
                        let groups = key.args.iter().filter_map(|arg| match arg {
                            ArgKey::Group(group) => Some(*group),
                            _ => None,
                        });
                        reads.insert(id, groups.collect());
                        return (id, index);
                    }
                    key.repeat += 1;
                }
            });
            classes.push(class.filter(|(id, _)| !rejected.contains(id)));
        }
        let partial = |id: &usize| members[id].len() < 2 || reads[id].iter().any(|group| members[group] != members[id]);
        let before = rejected.len();
        rejected.extend(members.keys().filter(|id| partial(id)));
        if rejected.len() == before {
            return classes;
        }
    }
}

/// The group that a value may belong to, and its index there.
fn candidate(node: &Raw<'_>, raw: &[Raw<'_>], classes: &[Class]) -> Option<(Key, usize)> {
    let key = |base: &str, args| Key { kind: node.kind, base: base.to_owned(), args, repeat: 0 };
    if matches!(node.kind, Kind::Uniform | Kind::Column) {
        let (base, index) = names::member(node.name)?;
        return Some((key(base, Vec::new()), index));
    }
    let mut index = None;
    let mut args = Vec::new();
    for &arg in &node.args {
        args.push(match classes[arg] {
            Some((_, member)) if *index.get_or_insert(member) != member => return None,
            Some((group, _)) => ArgKey::Group(group),
            None if raw[arg].kind == Kind::Constant => ArgKey::Constant,
            None => ArgKey::Shared(arg),
        });
    }
    let index = index?;
    if node.kind == Kind::Output {
        let (base, member) = names::member(node.name)?;
        return (member == index).then(|| (key(base, args), index));
    }
    Some((key("", args), index))
}

/// One node per group and per value that stands for itself.
fn collect(raw: &[Raw<'_>], classes: &[Class], style: &GraphStyle) -> Graph {
    let mut nodes: Vec<Node> = Vec::new();
    let mut of_group: HashMap<usize, usize> = HashMap::new();
    let mut of_raw: HashMap<usize, usize> = HashMap::new();
    for (i, node) in raw.iter().enumerate() {
        let group: Vec<usize> = match classes[i] {
            // Constants are made with the operation that reads them.
            _ if node.kind == Kind::Constant => continue,
            Some((id, _)) if of_group.contains_key(&id) => continue,
            Some((id, _)) => {
                (i..raw.len()).filter(|&j| matches!(classes[j], Some((other, _)) if other == id)).collect()
            }
            None => vec![i],
        };
        let mut inputs = Vec::new();
        for (position, &arg) in node.args.iter().enumerate() {
            let (from, only) = match classes[arg] {
                _ if raw[arg].kind == Kind::Constant => {
                    let values: Vec<_> = group.iter().map(|&member| raw[raw[member].args[position]].value).collect();
                    let label = names::numbers(&values);
                    let members = Vec::new();
                    nodes.push(Node { kind: Kind::Constant, label, members, inputs: Vec::new(), values });
                    (nodes.len() - 1, Vec::new())
                }
                Some((id, member)) => (of_group[&id], if classes[i].is_some() { Vec::new() } else { vec![member] }),
                None => (of_raw[&arg], Vec::new()),
            };
            inputs.push(Edge { from, only, minus: false });
        }
        let members: Vec<usize> = group.iter().filter_map(|&j| classes[j].map(|(_, index)| index)).collect();
        let base = if members.is_empty() { node.name } else { names::member(node.name).map_or("", |(base, _)| base) };
        let label = match node.kind {
            Kind::Unary(op) => names::unary(op).to_owned(),
            Kind::Binary(op) => names::binary(op).to_owned(),
            _ => labelled(base, members.len(), style),
        };
        nodes.push(Node { kind: node.kind, label, members, inputs, values: Vec::new() });
        of_raw.insert(i, nodes.len() - 1);
        if let Some((id, _)) = classes[i] {
            of_group.insert(id, nodes.len() - 1);
        }
    }
    Graph { nodes }
}
