//! Functions that draw random numbers.

use std::ops::Range;

use hwasp_diff::{Binary, Unary};

use crate::check::Checker;
use crate::error::ExprError;
use crate::exponents::Quantity;
use crate::formulas::{Part, Value};
use crate::functions::at;
use crate::scope::Distribution;
use crate::shapes::together;
use crate::syntax::Tree;

impl Checker<'_> {
    /// A draw for each component of what the formula is for.
    pub(crate) fn draw(&mut self, name: &str, trees: &[Tree], span: &Range<usize>) -> Result<Value, ExprError> {
        let (a, b) = (self.value(&trees[0])?, self.value(&trees[1])?);
        let quantity = self.alike(&a, &b, name, span)?;
        let count = together(&[&a, &b], span)?.max(self.scope.width());
        self.check_draw(name, (&a, &trees[0]), (&b, &trees[1]))?;
        let from = if name == "normal" { Distribution::Normal } else { Distribution::Uniform };
        let drawn = self.scope.draw(self.formulas, from, count);
        let parts = drawn.map_err(|why| ExprError::new(span.clone(), why))?;
        let drawn = Value { parts, quantity: Quantity::Number };
        let result = match name {
            "normal" => {
                let b = Value { parts: b.parts.iter().map(|&part| self.not_negative(part)).collect(), quantity };
                let off = Value { parts: self.both(Binary::Mul, &b, &drawn, span)?, quantity };
                self.both(Binary::Add, &a, &off, span)?
            }
            "uniform" => self.between(&a, &b, &drawn, span)?,
            _ => {
                self.pure(&a, &trees[0].span, "a limit of log_uniform")?;
                let [low, high] =
                    [&a, &b].map(|v| Value { parts: self.each(Unary::Ln, &v.parts), quantity: Quantity::Number });
                let logarithm = self.between(&low, &high, &drawn, span)?;
                self.each(Unary::Exp, &logarithm)
            }
        };
        Ok(Value { parts: result, quantity })
    }

    /// Refuses what no draw can be from, as far as its numbers are known.
    fn check_draw(
        &self,
        name: &str,
        (a, first): (&Value, &Tree),
        (b, second): (&Value, &Tree),
    ) -> Result<(), ExprError> {
        let known = |value: &Value, i: usize| self.formulas.known(at(value, i));
        for i in 0..a.parts.len().max(b.parts.len()) {
            let (low, high) = (known(a, i), known(b, i));
            let shown = |value: f64| hwasp_settings::text::show(value);
            match (name, low, high) {
                ("normal", _, Some(std)) if std < 0.0 => {
                    let message = format!("the standard deviation {} is negative", shown(std));
                    return Err(
                        ExprError::new(second.span.clone(), message).hint("write normal(mean, std) with std 0 or more")
                    );
                }
                ("log_uniform", Some(low), _) if low <= 0.0 => {
                    let message = format!("the limit {} has no logarithm", shown(low));
                    return Err(
                        ExprError::new(first.span.clone(), message).hint("log_uniform draws between limits above 0")
                    );
                }
                ("uniform" | "log_uniform", Some(low), Some(high)) if low > high => {
                    let message = format!("the lower limit {} is above the upper one, {}", shown(low), shown(high));
                    let span = first.span.start..second.span.end;
                    return Err(ExprError::new(span, message).hint(format!("exchange them: {name}(low, high)")));
                }
                _ => {}
            }
        }
        Ok(())
    }

    /// The same number; none where it is negative, so that a draw that cannot be is told when it is drawn.
    fn not_negative(&mut self, part: Part) -> Part {
        if self.formulas.known(part).is_some() {
            return part;
        }
        let [zero, none] = [0.0, f64::NAN].map(|value| self.formulas.constant(value));
        let below = self.formulas.binary(Binary::Less, part, zero);
        let fault = self.formulas.binary(Binary::Gate, below, none);
        self.formulas.binary(Binary::Add, part, fault)
    }

    /// a + (b - a)·u.
    fn between(&mut self, a: &Value, b: &Value, u: &Value, span: &Range<usize>) -> Result<Vec<Part>, ExprError> {
        let width = self.both(Binary::Sub, b, a, span)?.into_iter().map(|part| self.not_negative(part)).collect();
        let width = Value { parts: width, quantity: Quantity::Number };
        let off = Value { parts: self.both(Binary::Mul, &width, u, span)?, quantity: Quantity::Number };
        self.both(Binary::Add, a, &off, span)
    }
}
