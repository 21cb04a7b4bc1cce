//! From a recorded tape to a program: dead code dropped, uniform instructions apart from row instructions.

use std::collections::HashMap;

use super::plan::ReversePlan;
use super::{Instruction, Program, Slot};
use crate::trace::{Arg, Node};

/// Builds the program whose outputs are the given operands of the tape `nodes`.
pub(super) fn lower(
    nodes: &[Node],
    uniform_names: Vec<String>,
    column_names: Vec<String>,
    outputs: Vec<(String, Arg)>,
) -> Program {
    let needed = needed(nodes, &outputs);
    let mut constants = Constants::default();
    let mut slots = Vec::with_capacity(nodes.len());
    let (mut uniform_code, mut row_code) = (Vec::new(), Vec::new());
    let mut recorded = Vec::new();
    for (node, needed) in nodes.iter().zip(needed) {
        let instruction = match *node {
            Node::Uniform(i) => {
                slots.push(Some(Slot::Uniform(i)));
                continue;
            }
            Node::Column(i) => {
                slots.push(Some(Slot::Column(i)));
                continue;
            }
            Node::Unary(..) | Node::Binary(..) if !needed => {
                slots.push(None);
                continue;
            }
            Node::Unary(op, a) => Instruction::Unary(op, constants.slot(a, &slots)),
            Node::Binary(op, a, b) => Instruction::Binary(op, constants.slot(a, &slots), constants.slot(b, &slots)),
        };
        let by_row = instruction.operands().any(Slot::varies_by_row);
        recorded.push(by_row);
        let slot = if by_row {
            row_code.push(instruction);
            Slot::Register(row_code.len() - 1)
        } else {
            uniform_code.push(instruction);
            Slot::Uniform(uniform_names.len() + uniform_code.len() - 1)
        };
        slots.push(Some(slot));
    }
    let (output_names, outputs): (Vec<_>, Vec<_>) =
        outputs.into_iter().map(|(name, arg)| (name, constants.slot(arg, &slots))).unzip();
    let held = vec![false; column_names.len()];
    let plan = ReversePlan::new(&row_code, &outputs, &held);
    Program {
        uniform_names,
        column_names,
        output_names,
        constants: constants.values,
        uniform_code,
        row_code,
        recorded,
        outputs,
        held,
        plan,
    }
}

/// Which nodes some output depends on.
fn needed(nodes: &[Node], outputs: &[(String, Arg)]) -> Vec<bool> {
    fn mark(needed: &mut [bool], arg: Arg) {
        if let Arg::Node(index) = arg {
            needed[index] = true;
        }
    }
    let mut needed = vec![false; nodes.len()];
    for (_, arg) in outputs {
        mark(&mut needed, *arg);
    }
    for index in (0..nodes.len()).rev() {
        if needed[index] {
            match nodes[index] {
                Node::Uniform(_) | Node::Column(_) => {}
                Node::Unary(_, a) => mark(&mut needed, a),
                Node::Binary(_, a, b) => {
                    mark(&mut needed, a);
                    mark(&mut needed, b);
                }
            }
        }
    }
    needed
}

/// The constants of a program, each kept once.
#[derive(Default)]
struct Constants {
    values: Vec<f64>,
    known: HashMap<u64, usize>,
}

impl Constants {
    fn slot(&mut self, arg: Arg, slots: &[Option<Slot>]) -> Slot {
        match arg {
            Arg::Constant(bits) => Slot::Constant(*self.known.entry(bits).or_insert_with(|| {
                self.values.push(f64::from_bits(bits));
                self.values.len() - 1
            })),
            Arg::Node(index) => slots[index].expect("what a needed node reads is needed too"),
        }
    }
}

impl Slot {
    /// Whether the value differs from row to row.
    pub(crate) fn varies_by_row(self) -> bool {
        matches!(self, Self::Column(_) | Self::Register(_))
    }
}

impl Instruction {
    /// What the instruction reads, in order.
    pub(crate) fn operands(self) -> impl Iterator<Item = Slot> {
        let (a, b) = match self {
            Self::Unary(_, a) => (a, None),
            Self::Binary(_, a, b) => (a, Some(b)),
        };
        std::iter::once(a).chain(b)
    }
}
