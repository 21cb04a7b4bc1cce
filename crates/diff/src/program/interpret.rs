//! A program read out step by step, for those who write it in another language.

use super::{Instruction, Program, Slot};
use crate::ops::{Binary, Unary};

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
        assert_eq!(uniforms.len(), self.uniform_names.len(), "one value per uniform input");
        assert_eq!(columns.len(), self.column_names.len(), "one value per column");
        let mut values = Values {
            constants: self.constants.iter().map(|&value| with.constant(value)).collect(),
            uniforms: uniforms.to_vec(),
            columns,
            registers: Vec::new(),
        };
        for &instruction in &self.uniform_code {
            let value = values.step(instruction, with);
            values.uniforms.push(value);
        }
        for &instruction in &self.row_code {
            let value = values.step(instruction, with);
            values.registers.push(value);
        }
        self.outputs.iter().map(|&slot| values.at(slot).clone()).collect()
    }
}
