//! A traced law as a straight-line program over the columns of a batch.
//!
//! *Uniform* inputs are the same for all rows (design parameters), *column* inputs have a value per row (commands,
//! states). What depends on uniforms alone is computed once per parameter vector ([`Program::bind`]), the rest per row.
//!
//! Batches are column-major: the value of column `c` in row `r` is `data[c * stride + r]`, with `stride >= rows`.

// Every loop must end up inside the function that pulp compiles for the widest vector instructions.
#![allow(clippy::inline_always)]

mod forward;
mod interpret;
mod jvp;
mod lanes;
mod lower;
mod plan;
mod tape;
mod vjp;

use crate::Float;
use crate::ops::{Binary, Unary};
use crate::trace::{Node, Tape, Var};
use plan::ReversePlan;

pub use interpret::Interpreter;
pub use tape::ProgramTape;

/// Where a value lives while a program runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Slot {
    /// An entry of [`Program::constants`].
    Constant(usize),
    /// A uniform value: first the uniform inputs, then the results of the uniform instructions.
    Uniform(usize),
    /// An input column.
    Column(usize),
    /// The result of a row instruction, one value per row.
    Register(usize),
}

/// One step of a program. The k-th row instruction writes register k.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Instruction {
    Unary(Unary, Slot),
    Binary(Binary, Slot, Slot),
}

/// A traced function from uniform inputs (U values) and column inputs (C values per row) to outputs (O values per row).
///
/// ```
/// use hwasp_diff::Program;
/// // The force of a spring: the stiffness is a design parameter, the position comes row by row.
/// let spring = Program::trace(&["stiffness"], &["position"], |u, c| vec![("force".into(), -(u[0] * c[0]))]);
/// let mut tape = spring.tape::<f64>(2);
/// let mut force = [0.0; 2];
/// spring.bind(&[3.0], &mut tape);
/// spring.forward(&[1.0, 2.0], 2, 2, &mut tape, &mut force, 2);
/// assert_eq!(force, [-3.0, -6.0]);
/// ```
///
/// # Derivatives
/// `abs` has derivative zero at zero; where the operands of `min` or `max` are equal the derivative follows the first.
/// At the edge of a domain (`sqrt` and `ln` at zero, division by zero) derivatives are infinite or NaN, as the formulas say.
///
/// # Reproducibility
/// In `f64`, the outputs are bit for bit those of the law run on plain `f64`. A row's results never depend on the other
/// rows or on the processor's vector width (the mathematical functions of the platform excepted); sums over rows are
/// taken in a fixed order.
#[derive(Clone, Debug)]
pub struct Program {
    uniform_names: Vec<String>,
    column_names: Vec<String>,
    output_names: Vec<String>,
    constants: Vec<f64>,
    uniform_code: Vec<Instruction>,
    row_code: Vec<Instruction>,
    /// The order in which the steps of both kinds were recorded: whether the next one is a row instruction.
    recorded: Vec<bool>,
    outputs: Vec<Slot>,
    held: Vec<bool>,
    plan: ReversePlan,
}

/// Programs are equal if they have the same names and do the same steps with the same constants, bit for bit.
impl PartialEq for Program {
    fn eq(&self, other: &Self) -> bool {
        let names = |p: &Self| [p.uniform_names.clone(), p.column_names.clone(), p.output_names.clone()];
        let bits = |p: &Self| p.constants.iter().map(|constant| constant.to_bits()).collect::<Vec<_>>();
        names(self) == names(other)
            && bits(self) == bits(other)
            && (&self.uniform_code, &self.row_code) == (&other.uniform_code, &other.row_code)
            && (&self.outputs, &self.held) == (&other.outputs, &other.held)
    }
}

impl Program {
    /// Records `law`, which gets the uniform and the column inputs in the order of their names and returns its named
    /// outputs. Operations that no output needs are dropped, equal ones done once.
    pub fn trace<L>(uniforms: &[impl AsRef<str>], columns: &[impl AsRef<str>], law: L) -> Self
    where
        L: for<'t> FnOnce(&[Var<'t>], &[Var<'t>]) -> Vec<(String, Var<'t>)>,
    {
        let tape = Tape::default();
        let outputs: Vec<_> = {
            let u: Vec<_> = (0..uniforms.len()).map(|i| tape.push(Node::Uniform(i))).collect();
            let c: Vec<_> = (0..columns.len()).map(|i| tape.push(Node::Column(i))).collect();
            law(&u, &c).into_iter().map(|(name, value)| (name, value.arg())).collect()
        };
        let (uniform_names, column_names) = (names(uniforms), names(columns));
        lower::lower(&tape.into_nodes(), uniform_names, column_names, outputs)
    }

    /// Holds columns constant: where `held[c]` is set, the cotangent of column `c` is zero and its tangent is taken as
    /// zero. Work that only they need is skipped. Use it for states that no gradient is wanted for.
    ///
    /// # Panics
    /// If `held` has not one entry per column.
    #[must_use]
    pub fn holding(mut self, held: &[bool]) -> Self {
        assert_eq!(held.len(), self.column_names.len(), "one entry per column");
        self.held = held.to_vec();
        self.plan = ReversePlan::new(&self.row_code, &self.outputs, &self.held);
        self
    }

    /// The names of the uniform inputs; their count is U.
    pub fn uniform_names(&self) -> &[String] {
        &self.uniform_names
    }

    /// The names of the input columns; their count is C.
    pub fn column_names(&self) -> &[String] {
        &self.column_names
    }

    /// The names of the outputs; their count is O.
    pub fn output_names(&self) -> &[String] {
        &self.output_names
    }

    /// How many instructions run once per parameter vector.
    pub fn uniform_instructions(&self) -> usize {
        self.uniform_code.len()
    }

    /// How many instructions run in every row.
    pub fn row_instructions(&self) -> usize {
        self.row_code.len()
    }

    pub(crate) fn constants(&self) -> &[f64] {
        &self.constants
    }

    pub(crate) fn uniform_code(&self) -> &[Instruction] {
        &self.uniform_code
    }

    pub(crate) fn row_code(&self) -> &[Instruction] {
        &self.row_code
    }

    pub(crate) fn output_slots(&self) -> &[Slot] {
        &self.outputs
    }

    /// The run-time state for blocks of up to `max_rows` rows: everything that running needs is allocated here.
    pub fn tape<F: Float>(&self, max_rows: usize) -> ProgramTape<F> {
        ProgramTape::new(self, max_rows)
    }

    /// Sets the uniform inputs (U values), runs the uniform instructions, and sets the accumulated cotangents of the
    /// uniform values to zero.
    ///
    /// # Panics
    /// If `uniforms` has not U values or `tape` belongs to another program.
    pub fn bind<F: Float>(&self, uniforms: &[F], tape: &mut ProgramTape<F>) {
        let inputs = self.uniform_names.len();
        assert_eq!(uniforms.len(), inputs, "one value per uniform input");
        tape.check(self);
        tape.uniforms[..inputs].copy_from_slice(uniforms);
        for (k, instruction) in self.uniform_code.iter().enumerate() {
            let value = match *instruction {
                Instruction::Unary(op, a) => op.value(tape.uniform_value(a)),
                Instruction::Binary(op, a, b) => op.value(tape.uniform_value(a), tape.uniform_value(b)),
            };
            tape.uniforms[inputs + k] = value;
        }
        tape.uniform_cotangents.fill(F::ZERO);
    }

    /// Sets the tangents of the uniform inputs (U values) and pushes them through the uniform instructions; the values
    /// are those of the last [`bind`](Self::bind).
    ///
    /// # Panics
    /// If `tangent` has not U values or `tape` belongs to another program.
    pub fn bind_tangent<F: Float>(&self, tangent: &[F], tape: &mut ProgramTape<F>) {
        let inputs = self.uniform_names.len();
        assert_eq!(tangent.len(), inputs, "one tangent per uniform input");
        tape.check(self);
        tape.uniform_tangents[..inputs].copy_from_slice(tangent);
        for (k, instruction) in self.uniform_code.iter().enumerate() {
            let value = tape.uniforms[inputs + k];
            let tangent = match *instruction {
                Instruction::Unary(op, a) => op.pull(tape.uniform_tangent(a), tape.uniform_value(a), value),
                Instruction::Binary(op, a, b) => {
                    let (x, y) = (tape.uniform_value(a), tape.uniform_value(b));
                    op.pull_a(tape.uniform_tangent(a), x, y, value) + op.pull_b(tape.uniform_tangent(b), x, y, value)
                }
            };
            tape.uniform_tangents[inputs + k] = tangent;
        }
    }

    /// Pulls the accumulated cotangents of the uniform values back to the uniform inputs and ADDS the result into `grad`
    /// (U values). The accumulators keep what they hold until the next [`bind`](Self::bind).
    ///
    /// # Panics
    /// If `grad` has not U values or `tape` belongs to another program.
    pub fn vjp_uniform<F: Float>(&self, tape: &mut ProgramTape<F>, grad: &mut [F]) {
        let inputs = self.uniform_names.len();
        assert_eq!(grad.len(), inputs, "one gradient entry per uniform input");
        tape.check(self);
        tape.uniform_scratch.copy_from_slice(&tape.uniform_cotangents);
        for (k, instruction) in self.uniform_code.iter().enumerate().rev() {
            let g = tape.uniform_scratch[inputs + k];
            let value = tape.uniforms[inputs + k];
            match *instruction {
                Instruction::Unary(op, a) => {
                    let pulled = op.pull(g, tape.uniform_value(a), value);
                    tape.add_uniform(a, pulled);
                }
                Instruction::Binary(op, a, b) => {
                    let (x, y) = (tape.uniform_value(a), tape.uniform_value(b));
                    tape.add_uniform(a, op.pull_a(g, x, y, value));
                    tape.add_uniform(b, op.pull_b(g, x, y, value));
                }
            }
        }
        for (total, &pulled) in grad.iter_mut().zip(&tape.uniform_scratch[..inputs]) {
            *total += pulled;
        }
    }
}

fn names(list: &[impl AsRef<str>]) -> Vec<String> {
    list.iter().map(|name| name.as_ref().to_owned()).collect()
}

/// Checks the shape of a column-major batch, where `what` names it in the message.
fn check_batch<F>(what: &str, data: &[F], columns: usize, stride: usize, rows: usize) {
    assert!(columns < 2 || stride >= rows, "{what}: the stride {stride} is less than the {rows} rows");
    let needed = if columns == 0 { 0 } else { (columns - 1) * stride + rows };
    assert!(data.len() >= needed, "{what}: {} values given, {needed} needed", data.len());
}
