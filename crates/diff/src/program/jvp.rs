//! The tangent pass over the row instructions.

use pulp::NullaryFnOnce;

use super::lanes::{Lane, Operand, Rows, Same, put};
use super::tape::Values;
use super::{Instruction, Program, ProgramTape, Slot, check_batch};
use crate::Float;
use crate::ops::{Binary, Unary, with_binary, with_unary};

impl Program {
    /// Pushes tangents through the row instructions: `column_tangent` [C × rows] and the tangents of the last
    /// [`bind_tangent`](Self::bind_tangent) give `out_tangent` [O × rows]. Values are those of the last
    /// [`forward`](Self::forward), which must have seen the same `columns` and `rows`.
    ///
    /// # Panics
    /// If `rows` differs from the last forward pass, or a slice is too short.
    #[allow(clippy::too_many_arguments)] // two batches read, one written, each with its shape
    pub fn jvp<F: Float>(
        &self,
        columns: &[F],
        column_tangent: &[F],
        stride: usize,
        rows: usize,
        tape: &mut ProgramTape<F>,
        out_tangent: &mut [F],
        out_stride: usize,
    ) {
        tape.check(self);
        assert_eq!(rows, tape.rows, "as many rows as in the last forward pass");
        check_batch("columns", columns, self.column_names.len(), stride, rows);
        check_batch("column tangents", column_tangent, self.column_names.len(), stride, rows);
        check_batch("output tangents", out_tangent, self.outputs.len(), out_stride, rows);
        pulp::Arch::new().dispatch(Tangent {
            program: self,
            columns,
            incoming: column_tangent,
            column_stride: stride,
            tape,
            out: out_tangent,
            out_stride,
        });
    }
}

/// One tangent pass over a block; its shapes are checked.
struct Tangent<'a, F: Float> {
    program: &'a Program,
    columns: &'a [F],
    incoming: &'a [F],
    column_stride: usize,
    tape: &'a mut ProgramTape<F>,
    out: &'a mut [F],
    out_stride: usize,
}

impl<F: Float> NullaryFnOnce for Tangent<'_, F> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Self { program, columns, incoming, column_stride, tape, out, out_stride } = self;
        let (rows, stride) = (tape.rows, tape.stride);
        let values = Values {
            constants: &tape.constants,
            uniforms: &tape.uniforms,
            columns,
            column_stride,
            registers: &tape.registers,
            stride,
            rows,
        };
        for (k, instruction) in program.row_code.iter().enumerate() {
            let (registers, rest) = tape.scratch.split_at_mut(k * stride);
            let tangents = Values { uniforms: &tape.uniform_tangents, columns: incoming, registers, ..values };
            let v = Rows(&values.registers[k * stride..][..rows]);
            let out = &mut rest[..rows];
            match *instruction {
                Instruction::Unary(op, a) => {
                    if let (Operand::Rows(a), Operand::Rows(t)) = (values.operand(a), program.tangent(a, &tangents)) {
                        with_unary!(op, OP => put(out, false, (t, a, a, v), |t, a, _, v| OP.pull(t, a, v)));
                    } else {
                        out.fill(F::ZERO);
                    }
                }
                Instruction::Binary(op, a, b) => {
                    let sides = [a, b].map(|slot| (values.operand(slot), program.tangent(slot, &tangents)));
                    with_binary!(op, OP => binary(
                        out,
                        sides,
                        v,
                        |t, a, b, v| OP.pull_a(t, a, b, v),
                        |t, a, b, v| OP.pull_b(t, a, b, v),
                    ));
                }
            }
        }
        let tangents =
            Values { uniforms: &tape.uniform_tangents, columns: incoming, registers: &tape.scratch, ..values };
        for (o, &slot) in program.outputs.iter().enumerate() {
            let out = &mut out[o * out_stride..][..rows];
            match program.tangent(slot, &tangents) {
                Operand::Same(value) => out.fill(value.0),
                Operand::Rows(Rows(value)) => out.copy_from_slice(value),
            }
        }
    }
}

impl Program {
    /// The tangent of a slot: none for constants and held columns.
    #[inline(always)]
    fn tangent<'a, F: Float>(&self, slot: Slot, tangents: &Values<'a, F>) -> Operand<'a, F> {
        match slot {
            Slot::Constant(_) => Operand::Same(Same(F::ZERO)),
            Slot::Column(c) if self.held[c] => Operand::Same(Same(F::ZERO)),
            _ => tangents.operand(slot),
        }
    }
}

/// The two terms of the tangent of a function of two numbers, one loop each.
#[inline(always)]
fn binary<F: Float>(
    out: &mut [F],
    [(a, ta), (b, tb)]: [(Operand<'_, F>, Operand<'_, F>); 2],
    v: Rows<'_, F>,
    pull_a: impl Fn(F, F, F, F) -> F,
    pull_b: impl Fn(F, F, F, F) -> F,
) {
    match (a, b) {
        (Operand::Rows(a), Operand::Rows(b)) => {
            term(out, false, ta, a, b, v, pull_a);
            term(out, true, tb, a, b, v, pull_b);
        }
        (Operand::Rows(a), Operand::Same(b)) => {
            term(out, false, ta, a, b, v, pull_a);
            term(out, true, tb, a, b, v, pull_b);
        }
        (Operand::Same(a), Operand::Rows(b)) => {
            term(out, false, ta, a, b, v, pull_a);
            term(out, true, tb, a, b, v, pull_b);
        }
        (Operand::Same(_), Operand::Same(_)) => out.fill(F::ZERO),
    }
}

/// One term: `out = pull(t, a, b, v)`, or added to what is there.
#[inline(always)]
fn term<F: Float>(
    out: &mut [F],
    add: bool,
    t: Operand<'_, F>,
    a: impl Lane<F>,
    b: impl Lane<F>,
    v: Rows<'_, F>,
    pull: impl Fn(F, F, F, F) -> F,
) {
    match t {
        Operand::Rows(t) => put(out, add, (t, a, b, v), pull),
        // A tangent of zero contributes nothing, whatever the derivative is.
        Operand::Same(Same(t)) if t == F::ZERO => {
            if !add {
                out.fill(F::ZERO);
            }
        }
        Operand::Same(t) => put(out, add, (t, a, b, v), pull),
    }
}
