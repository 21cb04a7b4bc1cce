//! The functions of formulas.

use std::ops::Range;

use hwasp_diff::{Binary, Unary};

use crate::check::Checker;
use crate::error::ExprError;
use crate::exponents::Quantity;
use crate::formulas::{Part, Value};
use crate::reference::FUNCTIONS;
use crate::shapes::together;
use crate::syntax::Tree;

/// Functions of pure numbers that are one operation.
const ELEMENTARY: [(&str, Unary); 7] = [
    ("exp", Unary::Exp),
    ("log", Unary::Ln),
    ("sin", Unary::Sin),
    ("cos", Unary::Cos),
    ("tanh", Unary::Tanh),
    ("sigmoid", Unary::Sigmoid),
    ("atan", Unary::Atan),
];

impl Checker<'_> {
    /// A function of some arguments.
    pub(crate) fn call(&mut self, name: &str, trees: &[Tree], span: &Range<usize>) -> Result<Value, ExprError> {
        let Some(function) = FUNCTIONS.iter().find(|function| function.name == name) else {
            return self.call_text(name, trees, span);
        };
        function.count_arguments(trees.len(), span)?;
        match name {
            "where" => return self.choice(trees, span),
            "any" | "all" => {
                let value = self.truth(&trees[0])?;
                let op = if name == "any" { Binary::Max } else { Binary::Mul };
                return Ok(scalar(self.fold(op, &value.parts), Quantity::Number));
            }
            "uniform" | "log_uniform" | "normal" => return self.draw(name, trees, span),
            _ => {}
        }
        let arguments = trees.iter().map(|tree| self.value(tree)).collect::<Result<Vec<_>, _>>()?;
        let first = &arguments[0];
        if let Some((_, op)) = ELEMENTARY.iter().find(|(known, _)| *known == name) {
            return self.elementary(*op, first, &trees[0], name);
        }
        match name {
            "abs" => Ok(Value { parts: self.each(Unary::Abs, &first.parts), quantity: first.quantity }),
            "si" => Ok(Value { parts: first.parts.clone(), quantity: Quantity::Unknown }),
            "sqrt" => Ok(Value { parts: self.each(Unary::Sqrt, &first.parts), quantity: first.quantity.root() }),
            "tan" => {
                let (sin, cos) = (
                    self.elementary(Unary::Sin, first, &trees[0], name)?,
                    self.elementary(Unary::Cos, first, &trees[0], name)?,
                );
                Ok(Value { parts: self.both(Binary::Div, &sin, &cos, span)?, quantity: Quantity::Number })
            }
            "asin" | "acos" => self.arc(name, first, &trees[0]),
            "atan2" => {
                self.alike(first, &arguments[1], name, span)?;
                let length = together(&[first, &arguments[1]], span)?;
                let parts = (0..length).map(|i| self.atan2(at(first, i), at(&arguments[1], i))).collect();
                Ok(Value { parts, quantity: Quantity::Number })
            }
            "wrap" => {
                self.pure(first, &trees[0].span, "an angle")?;
                let parts = first.parts.clone().into_iter().map(|part| {
                    let (sin, cos) = (self.formulas.unary(Unary::Sin, part), self.formulas.unary(Unary::Cos, part));
                    self.atan2(sin, cos)
                });
                Ok(Value { parts: parts.collect(), quantity: first.quantity })
            }
            "sign" => {
                let zero = self.formulas.constant(0.0);
                let parts = first.parts.clone().into_iter().map(|part| {
                    let above = self.formulas.binary(Binary::Less, zero, part);
                    let below = self.formulas.binary(Binary::Less, part, zero);
                    self.formulas.binary(Binary::Sub, above, below)
                });
                Ok(Value { parts: parts.collect(), quantity: Quantity::Number })
            }
            "min" | "max" => self.extreme(name, &arguments, span),
            "clip" => {
                let lower = self.alike(first, &arguments[1], name, span)?;
                let quantity = self.alike(first, &arguments[2], name, span)?;
                let above = Value { parts: self.both(Binary::Max, first, &arguments[1], span)?, quantity: lower };
                Ok(Value { parts: self.both(Binary::Min, &above, &arguments[2], span)?, quantity })
            }
            "sum" => Ok(scalar(self.fold(Binary::Add, &first.parts), first.quantity)),
            "mean" => {
                let sum = self.fold(Binary::Add, &first.parts);
                let count = self.formulas.constant(first.parts.len() as f64);
                Ok(scalar(self.formulas.binary(Binary::Div, sum, count), first.quantity))
            }
            "norm" => {
                let squares: Vec<Part> =
                    first.parts.iter().map(|&part| self.formulas.binary(Binary::Mul, part, part)).collect();
                let sum = self.fold(Binary::Add, &squares);
                Ok(scalar(self.root(sum), first.quantity))
            }
            "dot" => {
                let products = self.both(Binary::Mul, first, &arguments[1], span)?;
                Ok(scalar(self.fold(Binary::Add, &products), first.quantity.times(arguments[1].quantity)))
            }
            "cross" => {
                let [a, b] = [exactly(3, &arguments, 0, trees)?, exactly(3, &arguments, 1, trees)?];
                let quantity = first.quantity.times(arguments[1].quantity);
                Ok(Value { parts: self.cross([a[0], a[1], a[2]], [b[0], b[1], b[2]]).to_vec(), quantity })
            }
            "rotate" | "unrotate" | "multiply" | "conjugate" | "turn" | "roll" | "pitch" | "yaw" => {
                self.rotation(name, &arguments, trees)
            }
            "previous" => self.remembered(first, span),
            "diff" => {
                let before = self.remembered(first, span)?;
                Ok(Value { parts: self.both(Binary::Sub, first, &before, span)?, quantity: first.quantity })
            }
            other => unreachable!("{other} is in the table of functions"),
        }
    }

    fn elementary(&mut self, op: Unary, value: &Value, tree: &Tree, name: &str) -> Result<Value, ExprError> {
        self.pure(value, &tree.span, &format!("the argument of {name}"))?;
        Ok(Value { parts: self.each(op, &value.parts), quantity: Quantity::Number })
    }

    fn arc(&mut self, name: &str, value: &Value, tree: &Tree) -> Result<Value, ExprError> {
        self.pure(value, &tree.span, &format!("the argument of {name}"))?;
        let quarter = self.formulas.constant(std::f64::consts::FRAC_PI_2);
        let parts = value.parts.iter().map(|&part| {
            let arc = self.asin(part);
            if name == "asin" { arc } else { self.formulas.binary(Binary::Sub, quarter, arc) }
        });
        Ok(Value { parts: parts.collect(), quantity: Quantity::Number })
    }

    /// The angle of the point (√(1 - x²), x), with x kept within ±1.
    pub(crate) fn asin(&mut self, part: Part) -> Part {
        let [low, high] = [-1.0, 1.0].map(|x| self.formulas.constant(x));
        let above = self.formulas.binary(Binary::Max, part, low);
        let x = self.formulas.binary(Binary::Min, above, high);
        let square = self.formulas.binary(Binary::Mul, x, x);
        let rest = self.formulas.binary(Binary::Sub, high, square);
        // At ±1 and beyond its derivative is 0.
        let root = self.root(rest);
        self.atan2(x, root)
    }

    /// The angle of the point (x, y), in (-π, π]: 2·atan(y/(r + x)), or π where the point is on the negative half of the axis.
    pub(crate) fn atan2(&mut self, y: Part, x: Part) -> Part {
        let [zero, two, pi] = [0.0, 2.0, std::f64::consts::PI].map(|value| self.formulas.constant(value));
        let (xx, yy) = (self.formulas.binary(Binary::Mul, x, x), self.formulas.binary(Binary::Mul, y, y));
        let sum = self.formulas.binary(Binary::Add, xx, yy);
        let r = self.root(sum);
        // For x > 0: y/(r + x). Else (r - x)/y, which does not cancel.
        let right = self.formulas.binary(Binary::Less, zero, x);
        let left = self.formulas.not(right);
        let (beyond, before) = (self.formulas.binary(Binary::Add, r, x), self.formulas.binary(Binary::Sub, r, x));
        let half = |this: &mut Self, open: Part, ratio: Part| {
            let angle = this.formulas.unary(Unary::Atan, ratio);
            let angle = this.formulas.binary(Binary::Mul, two, angle);
            this.formulas.binary(Binary::Gate, open, angle)
        };
        // On the axis y = 0 the ratio of the left side would be no number.
        let (up, down) = (self.formulas.binary(Binary::Less, zero, y), self.formulas.binary(Binary::Less, y, zero));
        let off_axis = self.formulas.binary(Binary::Max, up, down);
        let on_axis = self.formulas.not(off_axis);
        let left_off = self.formulas.binary(Binary::Mul, left, off_axis);
        let negative = self.formulas.binary(Binary::Less, x, zero);
        let left_on = self.formulas.binary(Binary::Mul, negative, on_axis);
        let (beyond, aside) = (self.safe(right, beyond), self.safe(left_off, y));
        let (near, far) =
            (self.formulas.binary(Binary::Div, y, beyond), self.formulas.binary(Binary::Div, before, aside));
        let (a, b) = (half(self, right, near), half(self, left_off, far));
        let c = self.formulas.binary(Binary::Gate, left_on, pi);
        let ab = self.formulas.binary(Binary::Add, a, b);
        self.formulas.binary(Binary::Add, ab, c)
    }

    /// The value where a gate is open, 1 where it is shut: what is divided by it has a derivative even where nobody reads it.
    fn safe(&mut self, open: Part, value: Part) -> Part {
        let shut = self.formulas.not(open);
        let value = self.formulas.binary(Binary::Gate, open, value);
        self.formulas.binary(Binary::Add, value, shut)
    }

    /// The square root of a number that is not negative, with the derivative 0 at 0.
    fn root(&mut self, value: Part) -> Part {
        let zero = self.formulas.constant(0.0);
        let above = self.formulas.binary(Binary::Less, zero, value);
        let (safe, at_zero) = (self.safe(above, value), self.formulas.not(above));
        let root = self.formulas.unary(Unary::Sqrt, safe);
        self.formulas.binary(Binary::Sub, root, at_zero)
    }

    /// Of one vector its least or greatest component, of several values componentwise.
    fn extreme(&mut self, name: &str, arguments: &[Value], span: &Range<usize>) -> Result<Value, ExprError> {
        let op = if name == "min" { Binary::Min } else { Binary::Max };
        let mut result = arguments[0].clone();
        if arguments.len() == 1 {
            return Ok(scalar(self.fold(op, &result.parts), result.quantity));
        }
        for other in &arguments[1..] {
            let quantity = self.alike(&result, other, name, span)?;
            result = Value { parts: self.both(op, &result, other, span)?, quantity };
        }
        Ok(result)
    }

    fn choice(&mut self, trees: &[Tree], span: &Range<usize>) -> Result<Value, ExprError> {
        let condition = self.truth(&trees[0])?;
        let (yes, no) = (self.value(&trees[1])?, self.value(&trees[2])?);
        let quantity = self.alike(&yes, &no, "where", span)?;
        let length = together(&[&condition, &yes, &no], span)?;
        let parts = (0..length).map(|i| {
            let holds = at(&condition, i);
            let fails = self.formulas.not(holds);
            let (a, b) = (
                self.formulas.binary(Binary::Gate, holds, at(&yes, i)),
                self.formulas.binary(Binary::Gate, fails, at(&no, i)),
            );
            self.formulas.binary(Binary::Add, a, b)
        });
        Ok(Value { parts: parts.collect(), quantity })
    }

    fn remembered(&mut self, value: &Value, span: &Range<usize>) -> Result<Value, ExprError> {
        let parts = self.scope.previous(self.formulas, value).map_err(|why| ExprError::new(span.clone(), why))?;
        Ok(Value { parts, quantity: value.quantity })
    }
}

/// The components of an argument that has to have so many.
pub(crate) fn exactly(count: usize, arguments: &[Value], at: usize, trees: &[Tree]) -> Result<Vec<Part>, ExprError> {
    let parts = &arguments[at].parts;
    if parts.len() == count {
        return Ok(parts.clone());
    }
    let message = format!("a vector of {count} components is wanted here, and this has {}", parts.len());
    Err(ExprError::new(trees[at].span.clone(), message))
}

/// Component `i`; a scalar is the same everywhere.
pub(crate) fn at(value: &Value, i: usize) -> Part {
    value.parts[if value.parts.len() == 1 { 0 } else { i }]
}

pub(crate) fn scalar(part: Part, quantity: Quantity) -> Value {
    Value { parts: vec![part], quantity }
}
