//! Formulas that were made by a program, written as text.

use std::fmt::Write;

use hwasp_diff::{Binary, Unary};

use crate::formulas::{Formulas, Part, Step};

/// The deepest that operations of a text lie within each other; what is deeper gets a name.
const DEEPEST: usize = 24;

/// Formulas as text.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Texts {
    /// Names for what is used more than once, in the order in which they use each other.
    pub definitions: Vec<(String, String)>,
    /// One for each scalar that was asked for.
    pub formulas: Vec<String>,
}

impl Formulas {
    /// Some scalars as text, which is read as the same values. Uniform inputs and columns have these names; what is used more
    /// than once is called `prefix` and a number.
    ///
    /// ```
    /// let mut formulas = hwasp_expr::Formulas::default();
    /// let knee = formulas.column(0);
    /// let texts = formulas.text(&[], &["joint.knee.pos".into()], "law", &[knee]);
    /// assert_eq!(texts.formulas, ["joint.knee.pos"]);
    /// ```
    pub fn text(&self, uniforms: &[String], columns: &[String], prefix: &str, outputs: &[Part]) -> Texts {
        let mut uses = vec![0_usize; self.steps.len()];
        for part in outputs {
            uses[part.0 as usize] += 1;
        }
        for at in (0..self.steps.len()).rev() {
            if uses[at] > 0 {
                for operand in operands(self.steps[at]) {
                    uses[operand.0 as usize] += 1;
                }
            }
        }
        let mut texts = Texts::default();
        let mut written: Vec<(String, usize)> = Vec::with_capacity(self.steps.len());
        for (step, &uses) in self.steps.iter().zip(&uses) {
            if uses == 0 {
                written.push((String::new(), 0));
                continue;
            }
            let depth = operands(*step).map(|part| written[part.0 as usize].1 + 1).max().unwrap_or(0);
            let of = |part: Part| written[part.0 as usize].0.as_str();
            let text = match *step {
                // A negative number is the operand of no other sign.
                Step::Constant(value) if value.is_sign_negative() => format!("({value:?})"),
                Step::Constant(value) => format!("{value:?}"),
                Step::Uniform(i) => uniforms[i].clone(),
                Step::Column(i) => columns[i].clone(),
                Step::Unary(op, a) => unary(op, of(a)),
                Step::Binary(op, a, b) => binary(op, of(a), of(b)),
            };
            let named = depth > 0 && (uses > 1 || depth >= DEEPEST);
            if named {
                let mut name = prefix.to_owned();
                let _ = write!(name, "{}", texts.definitions.len() + 1);
                texts.definitions.push((name.clone(), text));
                written.push((name, 0));
            } else {
                written.push((text, depth));
            }
        }
        texts.formulas = outputs.iter().map(|part| written[part.0 as usize].0.clone()).collect();
        texts
    }
}

fn operands(step: Step) -> impl Iterator<Item = Part> {
    let (a, b) = match step {
        Step::Constant(_) | Step::Uniform(_) | Step::Column(_) => (None, None),
        Step::Unary(_, a) => (Some(a), None),
        Step::Binary(_, a, b) => (Some(a), Some(b)),
    };
    [a, b].into_iter().flatten()
}

fn unary(op: Unary, a: &str) -> String {
    let name = match op {
        Unary::Neg => return format!("(-{a})"),
        Unary::Exp => "exp",
        Unary::Ln => "log",
        Unary::Sqrt => "sqrt",
        Unary::Sin => "sin",
        Unary::Cos => "cos",
        Unary::Tanh => "tanh",
        Unary::Abs => "abs",
        Unary::Sigmoid => "sigmoid",
        Unary::Atan => "atan",
    };
    format!("{name}({a})")
}

fn binary(op: Binary, a: &str, b: &str) -> String {
    match op {
        Binary::Add => format!("({a} + {b})"),
        Binary::Sub => format!("({a} - {b})"),
        Binary::Mul => format!("({a} * {b})"),
        Binary::Div => format!("({a} / {b})"),
        Binary::Min => format!("min({a}, {b})"),
        Binary::Max => format!("max({a}, {b})"),
        Binary::Less => format!("({a} < {b})"),
        Binary::Gate => format!("where({a}, {b}, 0)"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exponents::Quantity;
    use crate::scope::{NameError, Scope, Symbol};
    use crate::syntax::Path;

    /// Two columns, `x` and `y`, and names for what was defined.
    #[derive(Default)]
    struct Names(Vec<(String, Part)>);

    impl Scope for Names {
        fn name(&mut self, formulas: &mut Formulas, path: &Path) -> Result<Symbol, NameError> {
            let part = match path.first() {
                "x" => formulas.column(0),
                "y" => formulas.column(1),
                name => {
                    let found = self.0.iter().find(|(known, _)| known == name);
                    found.ok_or_else(|| NameError::unknown(["x", "y"]))?.1
                }
            };
            Ok(Symbol::new(vec![part], Quantity::Unknown, 1))
        }
    }

    fn values(formulas: &Formulas, part: Part) -> Vec<u64> {
        let columns = ["x".to_owned(), "y".to_owned()];
        let program = formulas.program(&[], &columns, vec![("out".into(), part)]);
        let points = [[0.3, -0.7], [-1.25, 2.5], [1e-3, 4.0], [2.0, 2.0]];
        let mut tape = program.tape::<f64>(1);
        program.bind(&[], &mut tape);
        let mut out = [0.0];
        let value = |point: &[f64; 2]| {
            program.forward(point, 1, 1, &mut tape, &mut out, 1);
            out[0].to_bits()
        };
        points.iter().map(value).collect()
    }

    #[test]
    fn what_is_written_is_read_as_the_same_values() {
        let long = format!("x{}", " + y * x".repeat(60));
        let formulas = [
            "x - -1.5e-7 * y",
            "atan2(x, y) + atan2(x, y)^3 / (1 + x^2)",
            "where(x < y, sqrt(x), -y) + clip(x * y, -1, 0.5)",
            "-(-x) - (y - x) - wrap(3 * x)",
            "tanh(exp(x) - log(abs(y) + 1)) * sigmoid(y) + sign(x) * asin(x / 4) * cos(y) * sin(x)",
            &long,
        ];
        for text in formulas {
            let mut first = Formulas::default();
            let value = first.read(text, &mut Names::default()).unwrap();
            let texts = first.text(&[], &["x".into(), "y".into()], "t", &value.parts);
            let (mut again, mut names) = (Formulas::default(), Names::default());
            for (name, text) in &texts.definitions {
                let part = again.read(text, &mut names).unwrap().parts[0];
                names.0.push((name.clone(), part));
            }
            let part = again.read(&texts.formulas[0], &mut names).unwrap().parts[0];
            assert_eq!(values(&again, part), values(&first, value.parts[0]), "{text}: {texts:?}");
        }
    }

    #[test]
    fn what_is_used_twice_is_written_once() {
        let mut formulas = Formulas::default();
        let value = formulas.read("sin(x) + sin(x) * y", &mut Names::default()).unwrap();
        // The program of these formulas finds equal operations; the text does where one scalar is used twice.
        let sine = formulas.read("sin(x)", &mut Names::default()).unwrap().parts[0];
        let mut names = Names(vec![("s".into(), sine)]);
        let twice = formulas.read("s + s * y", &mut names).unwrap().parts[0];
        let texts = formulas.text(&[], &["x".into(), "y".into()], "t", &[twice, value.parts[0]]);
        assert_eq!(texts.definitions, [("t1".to_owned(), "sin(x)".to_owned())]);
        assert_eq!(texts.formulas[0], "(t1 + (t1 * y))");
    }
}
