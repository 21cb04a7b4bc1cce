//! A program read out step by step, for those who write it in another language.

use std::marker::PhantomData;

use super::{Instruction, Program, Slot};
use crate::ops::{Binary, Unary};
use crate::{Scalar, Var};

/// What the steps of a program mean to a reader: names in the text of another language, say, or numbers of another kind.
///
/// ```
/// use hwasp_diff::{Binary, Interpreter, Program, Unary};
///
/// /// Writes formulas.
/// struct Formulas;
///
/// impl Interpreter for Formulas {
///     type Value = String;
///     fn constant(&mut self, value: f64) -> String {
///         value.to_string()
///     }
///     fn unary(&mut self, op: Unary, a: &String) -> String {
///         format!("{op:?}({a})")
///     }
///     fn binary(&mut self, op: Binary, a: &String, b: &String) -> String {
///         format!("{op:?}({a}, {b})")
///     }
/// }
///
/// let spring = Program::trace(&["stiffness"], &["position"], |u, c| vec![("force".into(), -(u[0] * c[0]))]);
/// let force = spring.interpret(&["k".to_owned()], &["x".to_owned()], &mut Formulas);
/// assert_eq!(force, ["Neg(Mul(k, x))"]);
/// ```
pub trait Interpreter {
    /// What stands for a number.
    type Value: Clone;

    /// A constant.
    fn constant(&mut self, value: f64) -> Self::Value;
    /// A function of one number.
    fn unary(&mut self, op: Unary, a: &Self::Value) -> Self::Value;
    /// A function of two numbers.
    fn binary(&mut self, op: Binary, a: &Self::Value, b: &Self::Value) -> Self::Value;
}

/// What stands for every value read so far.
struct Values<'a, V> {
    constants: Vec<V>,
    uniforms: Vec<V>,
    columns: &'a [V],
    registers: Vec<V>,
}

impl<V: Clone> Values<'_, V> {
    fn at(&self, slot: Slot) -> &V {
        match slot {
            Slot::Constant(i) => &self.constants[i],
            Slot::Uniform(i) => &self.uniforms[i],
            Slot::Column(i) => &self.columns[i],
            Slot::Register(i) => &self.registers[i],
        }
    }

    fn step<I: Interpreter<Value = V>>(&self, instruction: Instruction, with: &mut I) -> V {
        match instruction {
            Instruction::Unary(op, a) => with.unary(op, self.at(a)),
            Instruction::Binary(op, a, b) => with.binary(op, self.at(a), self.at(b)),
        }
    }
}

impl Program {
    /// Reads the program out: every constant, every uniform step, every row step, each once and after what it reads.
    /// Returns what stands for the outputs (O).
    ///
    /// # Panics
    /// If there are not as many `uniforms` and `columns` as the program has.
    pub fn interpret<I: Interpreter>(
        &self,
        uniforms: &[I::Value],
        columns: &[I::Value],
        with: &mut I,
    ) -> Vec<I::Value> {
        let rows = self.row_code.len();
        let order = std::iter::repeat_n(false, self.uniform_code.len()).chain(std::iter::repeat_n(true, rows));
        self.read(order, uniforms, columns, with)
    }

    /// Records the program once more, as a part of the trace that `uniforms` and `columns` belong to: a law that is data
    /// is composed as one that is code. The steps come in the order in which they were first recorded, so that the larger
    /// program is the same, down to the order of its sums, as if the law had been traced in its place.
    ///
    /// # Panics
    /// If there are not as many `uniforms` and `columns` as the program has.
    pub fn retrace<'t>(&self, uniforms: &[Var<'t>], columns: &[Var<'t>]) -> Vec<Var<'t>> {
        self.read(self.recorded.iter().copied(), uniforms, columns, &mut Recorder(PhantomData))
    }

    /// Reads the steps in an order: where it says `true` the next row step, else the next uniform step.
    fn read<I: Interpreter>(
        &self,
        order: impl Iterator<Item = bool>,
        uniforms: &[I::Value],
        columns: &[I::Value],
        with: &mut I,
    ) -> Vec<I::Value> {
        assert_eq!(uniforms.len(), self.uniform_names.len(), "one value per uniform input");
        assert_eq!(columns.len(), self.column_names.len(), "one value per column");
        let mut values = Values {
            constants: self.constants.iter().map(|&value| with.constant(value)).collect(),
            uniforms: uniforms.to_vec(),
            columns,
            registers: Vec::new(),
        };
        let (mut uniform_code, mut row_code) = (self.uniform_code.iter(), self.row_code.iter());
        for by_row in order {
            let next = if by_row { row_code.next() } else { uniform_code.next() };
            let value = values.step(*next.expect("an order has as many steps of a kind as the program"), with);
            if by_row { values.registers.push(value) } else { values.uniforms.push(value) }
        }
        self.outputs.iter().map(|&slot| values.at(slot).clone()).collect()
    }
}

/// Records steps on the tape of the numbers that it is given.
struct Recorder<'t>(PhantomData<Var<'t>>);

impl<'t> Interpreter for Recorder<'t> {
    type Value = Var<'t>;

    fn constant(&mut self, value: f64) -> Var<'t> {
        Scalar::constant(value)
    }

    fn unary(&mut self, op: Unary, a: &Var<'t>) -> Var<'t> {
        a.unary(op)
    }

    fn binary(&mut self, op: Binary, a: &Var<'t>, b: &Var<'t>) -> Var<'t> {
        a.binary(op, *b)
    }
}
