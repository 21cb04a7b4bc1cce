//! From a tree to operations: shapes, dimensions, names.

use std::ops::Range;

use hwasp_diff::{Binary, Unary};

use crate::error::ExprError;
use crate::exponents::Quantity;
use crate::formulas::{Formulas, MOST_STEPS, Part, Value};
use crate::function::Frame;
use crate::parser::{component, parse};
use crate::scope::{NameError, Scope};
use crate::shapes::{range, together};
use crate::suggest::suggest;
use crate::syntax::{Index, Node, Operator, Path, Tree, short};

/// The longest vector.
const LONGEST: usize = 10_000;
/// The most operations within each other, those of functions from text included.
const DEEPEST: usize = 1000;
/// The largest whole exponent that is written out as products.
const LARGEST_POWER: f64 = 16.0;

impl Formulas {
    /// Reads a formula.
    ///
    /// # Errors
    /// The first thing that is wrong with it.
    pub fn read(&mut self, text: &str, scope: &mut dyn Scope) -> Result<Value, ExprError> {
        let tree = parse(text)?;
        let value = Checker::new(self, scope).value(&tree)?;
        if self.is_full() {
            let message = format!("the formulas have more than {MOST_STEPS} operations");
            return Err(
                ExprError::new(0..text.len(), message).hint("vectors are shorter where a slice will do: x[0:3]")
            );
        }
        Ok(value)
    }
}

/// Reads one formula.
pub(crate) struct Checker<'c> {
    pub(crate) formulas: &'c mut Formulas,
    pub(crate) scope: &'c mut dyn Scope,
    /// The call whose formula is read, where it is one of a function from text.
    pub(crate) frame: Option<Frame>,
    /// Operations that are being read, one within the other.
    pub(crate) depth: usize,
    /// Whether the fault at hand was told as one of a function.
    pub(crate) told: bool,
}

impl<'c> Checker<'c> {
    pub(crate) fn new(formulas: &'c mut Formulas, scope: &'c mut dyn Scope) -> Self {
        Self { formulas, scope, frame: None, depth: 0, told: false }
    }
}

impl Checker<'_> {
    /// Goes a level deeper, as far as the stack surely allows.
    pub(crate) fn deeper(&mut self, tree: &Tree) -> Result<(), ExprError> {
        self.depth += 1;
        if self.depth > DEEPEST {
            let message = format!("more than {DEEPEST} operations stand within each other");
            return Err(ExprError::new(tree.span.clone(), message).hint("give parts of it names of their own"));
        }
        Ok(())
    }

    /// The operations of a tree.
    pub(crate) fn value(&mut self, tree: &Tree) -> Result<Value, ExprError> {
        if self.formulas.is_full() {
            return Err(ExprError::new(tree.span.clone(), "the formulas have too many operations"));
        }
        self.deeper(tree)?;
        let value = match &tree.node {
            Node::Number(value, unit) => {
                let quantity = unit.map_or(Quantity::Number, Quantity::Known);
                Value { parts: vec![self.formulas.constant(*value)], quantity }
            }
            Node::Name(path) => self.name(path, &tree.span)?,
            Node::Call(name, arguments) => self.call(name, arguments, &tree.span)?,
            Node::Minus(inner) => {
                let Value { parts, quantity } = self.value(inner)?;
                Value { parts: self.each(Unary::Neg, &parts), quantity }
            }
            Node::Not(inner) => {
                let value = self.truth(inner)?;
                let parts = value.parts.iter().map(|&part| self.formulas.not(part)).collect();
                Value { parts, quantity: Quantity::Number }
            }
            Node::Binary(operator, left, right) => self.operation(*operator, left, right, &tree.span)?,
            Node::Slice(inner, index) => {
                let value = self.value(inner)?;
                let range = range(*index, value.parts.len(), &tree.span)?;
                Value { parts: value.parts[range].to_vec(), quantity: value.quantity }
            }
            Node::List(items) => self.list(items, &tree.span)?,
        };
        if value.parts.len() > LONGEST {
            let message = format!("a vector of {} components is longer than {LONGEST}", value.parts.len());
            return Err(ExprError::new(tree.span.clone(), message));
        }
        self.count_expanded(&value, &tree.span)?;
        self.depth -= 1;
        Ok(value)
    }

    fn list(&mut self, items: &[Tree], span: &Range<usize>) -> Result<Value, ExprError> {
        let mut list: Option<Value> = None;
        for item in items {
            let value = self.value(item)?;
            match &mut list {
                None => list = Some(value),
                Some(list) => {
                    list.parts.extend(value.parts);
                    // A list may hold what it likes: an observation is one.
                    list.quantity = list.quantity.with(value.quantity).unwrap_or(Quantity::Unknown);
                }
            }
        }
        list.ok_or_else(|| ExprError::new(span.clone(), "the list is empty"))
    }

    pub(crate) fn name(&mut self, path: &Path, span: &Range<usize>) -> Result<Value, ExprError> {
        if path.len() == 1 && !path.quoted[0] && path.first() == "pi" {
            let parts = vec![self.formulas.constant(std::f64::consts::PI)];
            return Ok(Value { parts, quantity: Quantity::Number });
        }
        let (mut value, used) = if let Some(argument) = self.argument(path) {
            (argument, 1)
        } else {
            let known = self.scope.name(self.formulas, path);
            let symbol = known.map_err(|error| name_error(error, path, span))?;
            (Value { parts: symbol.parts, quantity: symbol.quantity }, symbol.used)
        };
        for at in used..path.len() {
            let here = path.spans[at].clone();
            let letter = path.word(at).unwrap_or_default();
            let Some(index) = component(letter) else {
                let message = format!("`{}` is no component of `{}`", short(letter), shown(path, at));
                return Err(ExprError::new(here, message).hint("components are .x, .y, .z and .w, or [0], [1:3]"));
            };
            let range = range(Index::One(index), value.parts.len(), &here)?;
            value.parts = value.parts[range].to_vec();
        }
        Ok(value)
    }

    fn operation(
        &mut self,
        operator: Operator,
        left: &Tree,
        right: &Tree,
        span: &Range<usize>,
    ) -> Result<Value, ExprError> {
        use Operator::{Add, And, Div, Equal, Greater, GreaterEqual, Less, LessEqual, Mul, NotEqual, Or, Power, Sub};
        if let And | Or = operator {
            let (a, b) = (self.truth(left)?, self.truth(right)?);
            let op = if operator == And { Binary::Mul } else { Binary::Max };
            return Ok(Value { parts: self.both(op, &a, &b, span)?, quantity: Quantity::Number });
        }
        if operator == Power {
            return self.power(left, right, span);
        }
        let (a, b) = (self.value(left)?, self.value(right)?);
        let quantity = match operator {
            Mul => a.quantity.times(b.quantity),
            Div => a.quantity.times(b.quantity.power(-1)),
            _ => self.alike(&a, &b, operator.sign(), span)?,
        };
        let parts = match operator {
            Add => self.both(Binary::Add, &a, &b, span)?,
            Sub => self.both(Binary::Sub, &a, &b, span)?,
            Mul => self.both(Binary::Mul, &a, &b, span)?,
            Div => self.both(Binary::Div, &a, &b, span)?,
            Less => self.both(Binary::Less, &a, &b, span)?,
            Greater => self.both(Binary::Less, &b, &a, span)?,
            LessEqual => self.negated(&b, &a, span)?,
            GreaterEqual => self.negated(&a, &b, span)?,
            Equal | NotEqual => {
                let less = Value { parts: self.both(Binary::Less, &a, &b, span)?, quantity: Quantity::Number };
                let more = Value { parts: self.both(Binary::Less, &b, &a, span)?, quantity: Quantity::Number };
                let apart = self.both(Binary::Max, &less, &more, span)?;
                if operator == Equal { apart.iter().map(|&part| self.formulas.not(part)).collect() } else { apart }
            }
            Power | And | Or => unreachable!("are dealt with above"),
        };
        let quantity = if operator.compares() { Quantity::Number } else { quantity };
        Ok(Value { parts, quantity })
    }

    /// Not a < b.
    fn negated(&mut self, a: &Value, b: &Value, span: &Range<usize>) -> Result<Vec<Part>, ExprError> {
        let less = self.both(Binary::Less, a, b, span)?;
        Ok(less.iter().map(|&part| self.formulas.not(part)).collect())
    }

    fn power(&mut self, left: &Tree, right: &Tree, span: &Range<usize>) -> Result<Value, ExprError> {
        let (base, exponent) = (self.value(left)?, self.value(right)?);
        let whole = match exponent.parts[..] {
            [only] => self.formulas.known(only).filter(|n| n.fract() == 0.0 && n.abs() <= LARGEST_POWER),
            _ => None,
        };
        if let Some(n) = whole {
            let parts = base.parts.iter().map(|&part| self.whole_power(part, n as i32)).collect();
            return Ok(Value { parts, quantity: base.quantity.power(n as i32) });
        }
        let half = matches!(exponent.parts[..], [only] if self.formulas.known(only) == Some(0.5));
        if half {
            return Ok(Value { parts: self.each(Unary::Sqrt, &base.parts), quantity: base.quantity.root() });
        }
        self.pure(&base, &left.span, "the base of a power that is not whole")?;
        self.pure(&exponent, &right.span, "an exponent")?;
        // a^b = exp(b·ln a), for a > 0.
        let logarithm = Value { parts: self.each(Unary::Ln, &base.parts), quantity: Quantity::Number };
        let product = self.both(Binary::Mul, &logarithm, &exponent, span)?;
        Ok(Value { parts: self.each(Unary::Exp, &product), quantity: Quantity::Number })
    }

    /// Products by squaring: x^2 is x·x to the bit.
    fn whole_power(&mut self, part: Part, exponent: i32) -> Part {
        let one = self.formulas.constant(1.0);
        let (mut left, mut square, mut power) = (exponent.unsigned_abs(), part, None);
        while left > 0 {
            if left & 1 == 1 {
                power = Some(match power {
                    None => square,
                    Some(power) => self.formulas.binary(Binary::Mul, power, square),
                });
            }
            left >>= 1;
            if left > 0 {
                square = self.formulas.binary(Binary::Mul, square, square);
            }
        }
        match power {
            None => one,
            Some(power) if exponent < 0 => self.formulas.binary(Binary::Div, one, power),
            Some(power) => power,
        }
    }

    /// What two values measure together.
    pub(crate) fn alike(&self, a: &Value, b: &Value, what: &str, span: &Range<usize>) -> Result<Quantity, ExprError> {
        match a.quantity.with(b.quantity) {
            Some(quantity) => Ok(quantity),
            None if !self.scope.strict() => Ok(Quantity::Unknown),
            None => Err(ExprError::new(
                span.clone(),
                format!("{} and {} do not go together in {what}", a.quantity, b.quantity),
            )
            .hint("see that both sides measure the same; a number without a unit fits everything")),
        }
    }

    /// Refuses what has a dimension, in laws.
    pub(crate) fn pure(&self, value: &Value, span: &Range<usize>, what: &str) -> Result<(), ExprError> {
        if value.quantity.is_pure() || !self.scope.strict() {
            return Ok(());
        }
        Err(ExprError::new(
            span.clone(),
            format!("{what} is a pure number or an angle, and this is {}", value.quantity),
        )
        .hint("divide by a quantity of the same unit first"))
    }

    /// A value as true (1) or false (0): anything but 0 is true.
    pub(crate) fn truth(&mut self, tree: &Tree) -> Result<Value, ExprError> {
        let value = self.value(tree)?;
        if is_truth(tree) {
            return Ok(value);
        }
        let zero = self.formulas.constant(0.0);
        let parts = value.parts.iter().map(|&part| {
            let (below, above) =
                (self.formulas.binary(Binary::Less, part, zero), self.formulas.binary(Binary::Less, zero, part));
            self.formulas.binary(Binary::Max, below, above)
        });
        Ok(Value { parts: parts.collect(), quantity: Quantity::Number })
    }

    /// One operation on every component.
    pub(crate) fn each(&mut self, op: Unary, parts: &[Part]) -> Vec<Part> {
        parts.iter().map(|&part| self.formulas.unary(op, part)).collect()
    }

    /// One operation on pairs of components; a scalar goes with every component.
    pub(crate) fn both(
        &mut self,
        op: Binary,
        a: &Value,
        b: &Value,
        span: &Range<usize>,
    ) -> Result<Vec<Part>, ExprError> {
        let length = together(&[a, b], span)?;
        let at = |value: &Value, i: usize| value.parts[if value.parts.len() == 1 { 0 } else { i }];
        Ok((0..length).map(|i| self.formulas.binary(op, at(a, i), at(b, i))).collect())
    }

    /// One operation over all components, from the left.
    pub(crate) fn fold(&mut self, op: Binary, parts: &[Part]) -> Part {
        let mut parts = parts.iter().copied();
        let first = parts.next().expect("a value has a component");
        parts.fold(first, |sum, part| self.formulas.binary(op, sum, part))
    }
}

/// Whether a tree gives 0 or 1 by its form.
fn is_truth(tree: &Tree) -> bool {
    match &tree.node {
        Node::Binary(operator, ..) => operator.compares() || matches!(operator, Operator::And | Operator::Or),
        Node::Not(_) => true,
        Node::Call(name, _) => matches!(name.as_str(), "any" | "all"),
        _ => false,
    }
}

/// The first parts of a path.
fn shown(path: &Path, parts: usize) -> String {
    let head = Path {
        segments: path.segments[..parts].to_vec(),
        spans: path.spans[..parts].to_vec(),
        quoted: path.quoted[..parts].to_vec(),
    };
    head.to_string()
}

fn name_error(error: NameError, path: &Path, span: &Range<usize>) -> ExprError {
    let at = error.at.min(path.len() - 1);
    let here = if path.len() == 1 { span.clone() } else { path.spans[at].clone() };
    let part = path.word(at).map_or_else(|| path.index(at).map_or(String::new(), |i| format!("#{i}")), short);
    if !error.message.is_empty() {
        let told = ExprError::new(here, error.message);
        return match error.hint {
            Some(hint) => told.hint(hint),
            None => told,
        };
    }
    let message =
        if at == 0 { format!("`{part}` is not known") } else { format!("`{}` has no `{part}`", shown(path, at)) };
    let told = ExprError::new(here, message);
    suggest(told, &part, &error.known)
}
