//! The run-time state of a program.

use super::lanes::{LANES, Operand, Rows, Same};
use super::{Program, Slot};
use crate::Float;

/// The registers that a [`Program`] runs in, allocated once by [`Program::tape`]. One tape per thread.
#[derive(Clone, Debug)]
pub struct ProgramTape<F: Float> {
    pub(super) constants: Vec<F>,
    /// The uniform inputs, then the results of the uniform instructions.
    pub(super) uniforms: Vec<F>,
    pub(super) uniform_tangents: Vec<F>,
    /// What the rows have contributed to the cotangents of the uniform values since the last bind.
    pub(super) uniform_cotangents: Vec<F>,
    pub(super) uniform_scratch: Vec<F>,
    /// The values of the last forward pass: register r holds `registers[r * stride ..][.. rows]`.
    pub(super) registers: Vec<F>,
    /// The cotangents or tangents of the registers while a vjp or jvp runs.
    pub(super) scratch: Vec<F>,
    pub(super) max_rows: usize,
    pub(super) stride: usize,
    /// The rows of the last forward pass.
    pub(super) rows: usize,
}

impl<F: Float> ProgramTape<F> {
    pub(super) fn new(program: &Program, max_rows: usize) -> Self {
        let uniforms = program.uniform_names().len() + program.uniform_code().len();
        let stride = max_rows.next_multiple_of(LANES);
        let registers = program.row_code().len() * stride;
        Self {
            constants: program.constants().iter().map(|&value| F::from_f64(value)).collect(),
            uniforms: vec![F::ZERO; uniforms],
            uniform_tangents: vec![F::ZERO; uniforms],
            uniform_cotangents: vec![F::ZERO; uniforms],
            uniform_scratch: vec![F::ZERO; uniforms],
            registers: vec![F::ZERO; registers],
            scratch: vec![F::ZERO; registers],
            max_rows,
            stride,
            rows: 0,
        }
    }

    /// The most rows that one block may have.
    pub fn max_rows(&self) -> usize {
        self.max_rows
    }

    /// Adds what `other` has accumulated for the uniform values: call it in a fixed order of tapes (of threads, of
    /// blocks) for the same bits every time, then [`Program::vjp_uniform`] on the sum.
    ///
    /// # Panics
    /// If the tapes belong to different programs.
    pub fn add_uniform_cotangents(&mut self, other: &Self) {
        assert_eq!(self.uniform_cotangents.len(), other.uniform_cotangents.len(), "tapes of the same program");
        for (total, &more) in self.uniform_cotangents.iter_mut().zip(&other.uniform_cotangents) {
            *total += more;
        }
    }

    /// Sets the accumulated cotangents of the uniform values to zero and keeps the bound values.
    pub fn clear_uniform_cotangents(&mut self) {
        self.uniform_cotangents.fill(F::ZERO);
    }

    /// Checks that this tape was made for a program of this shape.
    pub(super) fn check(&self, program: &Program) {
        let uniforms = program.uniform_names().len() + program.uniform_code().len();
        assert!(
            self.uniforms.len() == uniforms
                && self.constants.len() == program.constants().len()
                && self.registers.len() == program.row_code().len() * self.stride,
            "the tape belongs to another program"
        );
    }

    /// A value that is the same in all rows.
    pub(super) fn uniform_value(&self, slot: Slot) -> F {
        match slot {
            Slot::Constant(c) => self.constants[c],
            Slot::Uniform(u) => self.uniforms[u],
            Slot::Column(_) | Slot::Register(_) => {
                unreachable!("uniform instructions read uniform values")
            }
        }
    }

    /// The tangent of a value that is the same in all rows.
    pub(super) fn uniform_tangent(&self, slot: Slot) -> F {
        match slot {
            Slot::Uniform(u) => self.uniform_tangents[u],
            _ => F::ZERO,
        }
    }

    /// Adds to the cotangent of a uniform value in the uniform reverse pass.
    pub(super) fn add_uniform(&mut self, slot: Slot, pulled: F) {
        if let Slot::Uniform(u) = slot {
            self.uniform_scratch[u] += pulled;
        }
    }
}

/// All that the values of a block can be read from.
#[derive(Clone, Copy)]
pub(super) struct Values<'a, F> {
    pub(super) constants: &'a [F],
    pub(super) uniforms: &'a [F],
    pub(super) columns: &'a [F],
    pub(super) column_stride: usize,
    pub(super) registers: &'a [F],
    pub(super) stride: usize,
    pub(super) rows: usize,
}

impl<'a, F: Float> Values<'a, F> {
    /// The value in a slot, as the loops read it.
    #[inline(always)]
    pub(super) fn operand(&self, slot: Slot) -> Operand<'a, F> {
        match slot {
            Slot::Constant(c) => Operand::Same(Same(self.constants[c])),
            Slot::Uniform(u) => Operand::Same(Same(self.uniforms[u])),
            Slot::Column(c) => Operand::Rows(Rows(&self.columns[c * self.column_stride..][..self.rows])),
            Slot::Register(r) => Operand::Rows(Rows(&self.registers[r * self.stride..][..self.rows])),
        }
    }
}
