//! What the reverse pass does with each contribution, decided once when a program is made.

use super::{Instruction, Slot};

/// What happens to a contribution to the cotangent of an operand.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Deposit {
    /// Nothing that is asked for depends on the operand.
    Skip,
    /// The first contribution to a column or register: it overwrites, so that nothing has to be set to zero before.
    Store,
    /// A further contribution to a column or register.
    Add,
    /// The operand is uniform: the rows are added up into its accumulator.
    Sum,
}

/// The deposits of the reverse pass: outputs in order, then row instructions from last to first.
#[derive(Clone, Debug)]
pub(super) struct ReversePlan {
    /// Per output: what its cotangent does to the value it stands for.
    pub(super) outputs: Vec<Deposit>,
    /// Per row instruction: whether its register has a cotangent at all, and what is done for its operands.
    pub(super) row_code: Vec<Option<[Deposit; 2]>>,
    /// The columns that get no contribution: their cotangent is zero.
    pub(super) untouched: Vec<usize>,
}

impl ReversePlan {
    /// The plan for a program whose column `c` wants no cotangent where `held[c]` is set.
    pub(super) fn new(row_code: &[Instruction], outputs: &[Slot], held: &[bool]) -> Self {
        let mut active = vec![false; row_code.len()];
        for (k, instruction) in row_code.iter().enumerate() {
            active[k] = instruction.operands().any(|slot| is_active(slot, &active, held));
        }
        let mut columns = vec![false; held.len()];
        let mut registers = vec![false; row_code.len()];
        let mut deposit = |slot: Slot, registers: &mut [bool]| {
            let touched = match slot {
                _ if !is_active(slot, &active, held) => return Deposit::Skip,
                Slot::Constant(_) => return Deposit::Skip,
                Slot::Uniform(_) => return Deposit::Sum,
                Slot::Column(c) => &mut columns[c],
                Slot::Register(r) => &mut registers[r],
            };
            if std::mem::replace(touched, true) { Deposit::Add } else { Deposit::Store }
        };
        let outputs = outputs.iter().map(|&slot| deposit(slot, &mut registers)).collect();
        let mut code = vec![None; row_code.len()];
        for (k, instruction) in row_code.iter().enumerate().rev() {
            if registers[k] {
                let mut deposits = [Deposit::Skip; 2];
                for (operand, slot) in instruction.operands().enumerate() {
                    deposits[operand] = deposit(slot, &mut registers);
                }
                code[k] = Some(deposits);
            }
        }
        let untouched = (0..columns.len()).filter(|&c| !columns[c]).collect();
        Self { outputs, row_code: code, untouched }
    }
}

/// Whether a value depends on a uniform or on a column that wants a cotangent.
fn is_active(slot: Slot, registers: &[bool], held: &[bool]) -> bool {
    match slot {
        Slot::Constant(_) => false,
        Slot::Uniform(_) => true,
        Slot::Column(c) => !held[c],
        Slot::Register(r) => registers[r],
    }
}
