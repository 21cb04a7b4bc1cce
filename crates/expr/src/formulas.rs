//! Formulas that were read: scalar operations on numbered inputs.

use std::collections::HashMap;

use hwasp_diff::{Binary, Program, Scalar, Unary, Var};

use crate::exponents::Quantity;

/// The most operations of all formulas together: what is beyond was written by no person.
pub(crate) const MOST_STEPS: usize = 200_000;

/// A scalar of [`Formulas`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Part(pub(crate) u32);

/// A formula that was read: its components, and what they measure.
#[derive(Clone, Debug)]
pub struct Value {
    /// The components, at least one; a scalar has one.
    pub parts: Vec<Part>,
    /// What they measure.
    pub quantity: Quantity,
}

/// Any number of formulas over the same inputs.
#[derive(Clone, Debug, Default)]
pub struct Formulas {
    pub(crate) steps: Vec<Step>,
    /// What the formulas of functions have come to.
    pub(crate) expanded: usize,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Step {
    Constant(f64),
    Uniform(usize),
    Column(usize),
    Unary(Unary, Part),
    Binary(Binary, Part, Part),
}

impl Formulas {
    /// Input column `i` of the program: a value that changes from step to step.
    pub fn column(&mut self, i: usize) -> Part {
        self.push(Step::Column(i))
    }

    /// Uniform input `i` of the program: a value that stays, such as a design parameter.
    pub fn uniform(&mut self, i: usize) -> Part {
        self.push(Step::Uniform(i))
    }

    /// A number.
    pub fn constant(&mut self, value: f64) -> Part {
        self.push(Step::Constant(value))
    }

    /// The number that a scalar is, where it depends on no input.
    pub fn known(&self, part: Part) -> Option<f64> {
        match self.steps[part.0 as usize] {
            Step::Constant(value) => Some(value),
            _ => None,
        }
    }

    /// Whether a scalar is an input column as it is, and which.
    pub fn as_column(&self, part: Part) -> Option<usize> {
        match self.steps[part.0 as usize] {
            Step::Column(i) => Some(i),
            _ => None,
        }
    }

    /// The columns and the uniform inputs that some scalars depend on, in order.
    pub fn inputs(&self, parts: &[Part]) -> (Vec<usize>, Vec<usize>) {
        let mut needed = vec![false; self.steps.len()];
        for part in parts {
            needed[part.0 as usize] = true;
        }
        let (mut columns, mut uniforms) = (Vec::new(), Vec::new());
        // Operands come before what reads them: from the end, all readers of a step were seen before it.
        for at in (0..self.steps.len()).rev() {
            if !needed[at] {
                continue;
            }
            match self.steps[at] {
                Step::Constant(_) => {}
                Step::Column(i) => columns.push(i),
                Step::Uniform(i) => uniforms.push(i),
                Step::Unary(_, a) => needed[a.0 as usize] = true,
                Step::Binary(_, a, b) => {
                    needed[a.0 as usize] = true;
                    needed[b.0 as usize] = true;
                }
            }
        }
        for list in [&mut columns, &mut uniforms] {
            list.sort_unstable();
            list.dedup();
        }
        (columns, uniforms)
    }

    /// The program that gives some scalars under names, from inputs of these names.
    pub fn program(&self, uniforms: &[String], columns: &[String], outputs: Vec<(String, Part)>) -> Program {
        let columns: Vec<(usize, String)> = columns.iter().cloned().enumerate().collect();
        self.program_over(uniforms, &columns, outputs)
    }

    /// The same from some of the columns, in the order in which they are named here.
    pub fn program_over(
        &self,
        uniforms: &[String],
        columns: &[(usize, String)],
        outputs: Vec<(String, Part)>,
    ) -> Program {
        let names: Vec<&String> = columns.iter().map(|(_, name)| name).collect();
        let place: HashMap<usize, usize> = columns.iter().enumerate().map(|(at, (column, _))| (*column, at)).collect();
        Program::trace(uniforms, &names, |u, c| {
            // What only other programs read is no input of this one.
            let absent = || Var::constant(f64::NAN);
            let mut values: Vec<Var<'_>> = Vec::with_capacity(self.steps.len());
            for step in &self.steps {
                let value = match *step {
                    Step::Constant(value) => Var::constant(value),
                    Step::Uniform(i) => u.get(i).copied().unwrap_or_else(absent),
                    Step::Column(i) => place.get(&i).map_or_else(absent, |&at| c[at]),
                    Step::Unary(op, a) => unary(op, values[a.0 as usize]),
                    Step::Binary(op, a, b) => binary(op, values[a.0 as usize], values[b.0 as usize]),
                };
                values.push(value);
            }
            outputs.into_iter().map(|(name, part)| (name, values[part.0 as usize])).collect()
        })
    }

    pub(crate) fn push(&mut self, step: Step) -> Part {
        let part = Part(u32::try_from(self.steps.len()).expect("formulas are far shorter than 2^32 operations"));
        self.steps.push(step);
        part
    }

    /// Too many operations to go on with.
    pub(crate) fn is_full(&self) -> bool {
        self.steps.len() > MOST_STEPS
    }

    pub(crate) fn unary(&mut self, op: Unary, a: Part) -> Part {
        match self.known(a) {
            Some(a) => self.constant(unary(op, a)),
            None => self.push(Step::Unary(op, a)),
        }
    }

    pub(crate) fn binary(&mut self, op: Binary, a: Part, b: Part) -> Part {
        match (self.known(a), self.known(b)) {
            (Some(a), Some(b)) => self.constant(binary(op, a, b)),
            _ => self.push(Step::Binary(op, a, b)),
        }
    }

    /// 1 where `a` is 0, else 0, for what is 0 or 1.
    pub(crate) fn not(&mut self, a: Part) -> Part {
        let one = self.constant(1.0);
        self.binary(Binary::Sub, one, a)
    }
}

/// An operation on numbers or traces of them.
fn unary<T: Scalar>(op: Unary, a: T) -> T {
    match op {
        Unary::Neg => -a,
        Unary::Exp => a.exp(),
        Unary::Ln => a.ln(),
        Unary::Sqrt => a.sqrt(),
        Unary::Sin => a.sin(),
        Unary::Cos => a.cos(),
        Unary::Tanh => a.tanh(),
        Unary::Abs => a.abs(),
        Unary::Sigmoid => a.sigmoid(),
        Unary::Atan => a.atan(),
    }
}

fn binary<T: Scalar>(op: Binary, a: T, b: T) -> T {
    match op {
        Binary::Add => a + b,
        Binary::Sub => a - b,
        Binary::Mul => a * b,
        Binary::Div => a / b,
        Binary::Min => a.min(b),
        Binary::Max => a.max(b),
        Binary::Less => a.less(b),
        Binary::Gate => a.gate(b),
    }
}
