//! The reverse pass over the row instructions.

use pulp::NullaryFnOnce;

use super::lanes::{Lane, Operand, Rows, Same, put, sum};
use super::plan::Deposit;
use super::tape::Values;
use super::{Instruction, Program, ProgramTape, Slot, check_batch};
use crate::Float;
use crate::ops::{Binary, Unary, with_binary, with_unary};

impl Program {
    /// Pulls `out_cotangent` [O × rows] back through the row instructions: OVERWRITES `column_cotangent` [C × rows] and
    /// ADDS the sum over the rows into the tape's accumulators for the uniform values (see
    /// [`vjp_uniform`](Self::vjp_uniform)). Values are those of the last [`forward`](Self::forward), which must have seen
    /// the same `columns` and `rows`.
    ///
    /// # Panics
    /// If `rows` differs from the last forward pass, or a slice is too short.
    #[allow(clippy::too_many_arguments)] // two batches read, one written, each with its shape
    pub fn vjp<F: Float>(
        &self,
        columns: &[F],
        stride: usize,
        rows: usize,
        out_cotangent: &[F],
        cot_stride: usize,
        tape: &mut ProgramTape<F>,
        column_cotangent: &mut [F],
        column_cot_stride: usize,
    ) {
        tape.check(self);
        assert_eq!(rows, tape.rows, "as many rows as in the last forward pass");
        check_batch("columns", columns, self.column_names.len(), stride, rows);
        check_batch("output cotangents", out_cotangent, self.outputs.len(), cot_stride, rows);
        check_batch("column cotangents", column_cotangent, self.column_names.len(), column_cot_stride, rows);
        pulp::Arch::new().dispatch(Reverse {
            program: self,
            columns,
            column_stride: stride,
            out_cotangent,
            cot_stride,
            tape,
            column_cotangent,
            column_cot_stride,
        });
    }
}

/// One reverse pass over a block; its shapes are checked.
struct Reverse<'a, F: Float> {
    program: &'a Program,
    columns: &'a [F],
    column_stride: usize,
    out_cotangent: &'a [F],
    cot_stride: usize,
    tape: &'a mut ProgramTape<F>,
    column_cotangent: &'a mut [F],
    column_cot_stride: usize,
}

impl<F: Float> NullaryFnOnce for Reverse<'_, F> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Self { program, tape, column_cotangent, column_cot_stride, .. } = self;
        let (rows, stride) = (tape.rows, tape.stride);
        let values = Values {
            constants: &tape.constants,
            uniforms: &tape.uniforms,
            columns: self.columns,
            column_stride: self.column_stride,
            registers: &tape.registers,
            stride,
            rows,
        };
        for &c in &program.plan.untouched {
            column_cotangent[c * column_cot_stride..][..rows].fill(F::ZERO);
        }
        let mut sinks = Sinks {
            uniforms: &mut tape.uniform_cotangents,
            columns: column_cotangent,
            column_stride: column_cot_stride,
            registers: &mut tape.scratch,
            stride,
            rows,
        };
        for (o, (&slot, &deposit)) in program.outputs.iter().zip(&program.plan.outputs).enumerate() {
            let g = Rows(&self.out_cotangent[o * self.cot_stride..][..rows]);
            match slot {
                Slot::Constant(_) => {}
                Slot::Uniform(_) => sinks.uniform(slot, deposit, (g, g, g, g), |g, _, _, _| g),
                Slot::Column(_) | Slot::Register(_) => {
                    sinks.rows(slot, deposit, (g, g, g, g), |g, _, _, _| g);
                }
            }
        }
        for (k, instruction) in program.row_code.iter().enumerate().rev() {
            let Some([da, db]) = program.plan.row_code[k] else {
                continue;
            };
            let v = Rows(&values.registers[k * stride..][..rows]);
            let (registers, rest) = tape.scratch.split_at_mut(k * stride);
            let g = Rows(&rest[..rows]);
            let mut sinks = Sinks {
                uniforms: &mut tape.uniform_cotangents,
                columns: column_cotangent,
                column_stride: column_cot_stride,
                registers,
                stride,
                rows,
            };
            match *instruction {
                Instruction::Unary(op, slot) => {
                    if let Operand::Rows(a) = values.operand(slot) {
                        with_unary!(op, OP => sinks.rows(slot, da, (g, a, a, v), |g, a, _, v| OP.pull(g, a, v)));
                    }
                }
                Instruction::Binary(op, a, b) => {
                    let operands = (values.operand(a), values.operand(b));
                    let sides = [(a, da), (b, db)];
                    with_binary!(op, OP => binary(
                        &mut sinks,
                        sides,
                        operands,
                        (g, v),
                        |g, a, b, v| OP.pull_a(g, a, b, v),
                        |g, a, b, v| OP.pull_b(g, a, b, v),
                    ));
                }
            }
        }
    }
}

/// Where cotangents go.
struct Sinks<'a, F> {
    uniforms: &'a mut [F],
    columns: &'a mut [F],
    column_stride: usize,
    registers: &'a mut [F],
    stride: usize,
    rows: usize,
}

impl<F: Float> Sinks<'_, F> {
    /// Contributes row by row to the cotangent of a column or register.
    #[inline(always)]
    fn rows(
        &mut self,
        slot: Slot,
        deposit: Deposit,
        lanes: (impl Lane<F>, impl Lane<F>, impl Lane<F>, impl Lane<F>),
        f: impl Fn(F, F, F, F) -> F,
    ) {
        let add = match deposit {
            Deposit::Skip | Deposit::Sum => return,
            Deposit::Store => false,
            Deposit::Add => true,
        };
        let target = match slot {
            Slot::Column(c) => &mut self.columns[c * self.column_stride..][..self.rows],
            Slot::Register(r) => &mut self.registers[r * self.stride..][..self.rows],
            Slot::Constant(_) | Slot::Uniform(_) => return,
        };
        put(target, add, lanes, f);
    }

    /// Contributes the sum over the rows to the cotangent of a uniform value.
    #[inline(always)]
    fn uniform(
        &mut self,
        slot: Slot,
        deposit: Deposit,
        lanes: (impl Lane<F>, impl Lane<F>, impl Lane<F>, impl Lane<F>),
        f: impl Fn(F, F, F, F) -> F,
    ) {
        if let (Slot::Uniform(u), Deposit::Sum) = (slot, deposit) {
            self.uniforms[u] += sum(self.rows, lanes, f);
        }
    }
}

/// Contributes to both operands; which loops are needed follows from which operands vary by row.
#[inline(always)]
fn binary<F: Float>(
    sinks: &mut Sinks<'_, F>,
    [(slot_a, da), (slot_b, db)]: [(Slot, Deposit); 2],
    (a, b): (Operand<'_, F>, Operand<'_, F>),
    (g, v): (Rows<'_, F>, Rows<'_, F>),
    pull_a: impl Fn(F, F, F, F) -> F,
    pull_b: impl Fn(F, F, F, F) -> F,
) {
    match (a, b) {
        (Operand::Rows(a), Operand::Rows(b)) => {
            sinks.rows(slot_a, da, (g, a, b, v), pull_a);
            sinks.rows(slot_b, db, (g, a, b, v), pull_b);
        }
        (Operand::Rows(a), Operand::Same(b)) => {
            sinks.rows(slot_a, da, (g, a, b, v), pull_a);
            sinks.uniform(slot_b, db, (g, a, b, v), pull_b);
        }
        (Operand::Same(a), Operand::Rows(b)) => {
            sinks.uniform(slot_a, da, (g, a, b, v), pull_a);
            sinks.rows(slot_b, db, (g, a, b, v), pull_b);
        }
        (Operand::Same(Same(_)), Operand::Same(Same(_))) => {}
    }
}
