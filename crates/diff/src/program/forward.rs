//! The row instructions, run over a block.

use pulp::NullaryFnOnce;

use super::lanes::{Operand, Rows, map1, map2};
use super::tape::Values;
use super::{Instruction, Program, ProgramTape, Slot, check_batch};
use crate::Float;
use crate::ops::{Binary, Unary, with_binary, with_unary};

impl Program {
    /// Runs the row instructions over `rows` rows of `columns` [C × rows] and writes the outputs into `out` [O × rows].
    /// The uniform values are those of the last [`bind`](Self::bind). The registers stay on the tape for
    /// [`vjp`](Self::vjp) and [`jvp`](Self::jvp).
    ///
    /// # Panics
    /// If there are more rows than the tape was made for, or a slice is too short.
    pub fn forward<F: Float>(
        &self,
        columns: &[F],
        stride: usize,
        rows: usize,
        tape: &mut ProgramTape<F>,
        out: &mut [F],
        out_stride: usize,
    ) {
        tape.check(self);
        assert!(rows <= tape.max_rows, "{rows} rows on a tape for {}", tape.max_rows);
        check_batch("columns", columns, self.column_names.len(), stride, rows);
        check_batch("outputs", out, self.outputs.len(), out_stride, rows);
        tape.rows = rows;
        pulp::Arch::new().dispatch(Forward { program: self, columns, column_stride: stride, tape, out, out_stride });
    }
}

/// One forward pass over a block; its shapes are checked.
struct Forward<'a, F: Float> {
    program: &'a Program,
    columns: &'a [F],
    column_stride: usize,
    tape: &'a mut ProgramTape<F>,
    out: &'a mut [F],
    out_stride: usize,
}

impl<F: Float> NullaryFnOnce for Forward<'_, F> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        if self.tape.rows == 1 {
            return self.one_row();
        }
        let Self { program, columns, column_stride, tape, out, out_stride } = self;
        let (rows, stride) = (tape.rows, tape.stride);
        for (k, instruction) in program.row_code.iter().enumerate() {
            let (registers, rest) = tape.registers.split_at_mut(k * stride);
            let values = Values {
                constants: &tape.constants,
                uniforms: &tape.uniforms,
                columns,
                column_stride,
                registers,
                stride,
                rows,
            };
            let out = &mut rest[..rows];
            match *instruction {
                Instruction::Unary(op, a) => {
                    if let Operand::Rows(a) = values.operand(a) {
                        with_unary!(op, OP => map1(out, a, |a| OP.value(a)));
                    }
                }
                Instruction::Binary(op, a, b) => {
                    let (a, b) = (values.operand(a), values.operand(b));
                    with_binary!(op, OP => binary(out, a, b, |a, b| OP.value(a, b)));
                }
            }
        }
        let values = Values {
            constants: &tape.constants,
            uniforms: &tape.uniforms,
            columns,
            column_stride,
            registers: &tape.registers,
            stride,
            rows,
        };
        for (o, &slot) in program.outputs.iter().enumerate() {
            let out = &mut out[o * out_stride..][..rows];
            match values.operand(slot) {
                Operand::Same(value) => out.fill(value.0),
                Operand::Rows(Rows(value)) => out.copy_from_slice(value),
            }
        }
    }
}

impl<F: Float> Forward<'_, F> {
    /// The same of one row, as the simulator runs laws and formulas: with no loop over rows an instruction is a few loads and the
    /// operation.
    #[inline(always)]
    fn one_row(self) {
        let Self { program, columns, column_stride, tape, out, out_stride } = self;
        let (constants, uniforms, stride) = (&tape.constants[..], &tape.uniforms[..], tape.stride);
        let value = |slot: Slot, registers: &[F]| match slot {
            Slot::Constant(c) => constants[c],
            Slot::Uniform(u) => uniforms[u],
            Slot::Column(c) => columns[c * column_stride],
            Slot::Register(r) => registers[r * stride],
        };
        for (k, instruction) in program.row_code.iter().enumerate() {
            let registers = &tape.registers;
            let result = match *instruction {
                Instruction::Unary(op, a) => op.value(value(a, registers)),
                Instruction::Binary(op, a, b) => op.value(value(a, registers), value(b, registers)),
            };
            tape.registers[k * stride] = result;
        }
        for (o, &slot) in program.outputs.iter().enumerate() {
            out[o * out_stride] = value(slot, &tape.registers);
        }
    }
}

/// Picks the loop by which operands vary by row; at least one does.
#[inline(always)]
fn binary<F: Float>(out: &mut [F], a: Operand<'_, F>, b: Operand<'_, F>, f: impl Fn(F, F) -> F) {
    match (a, b) {
        (Operand::Rows(a), Operand::Rows(b)) => map2(out, a, b, f),
        (Operand::Rows(a), Operand::Same(b)) => map2(out, a, b, f),
        (Operand::Same(a), Operand::Rows(b)) => map2(out, a, b, f),
        (Operand::Same(a), Operand::Same(b)) => out.fill(f(a.0, b.0)),
    }
}
