//! What things are called in a drawing.

use std::fmt::Write as _;

use super::GraphStyle;
use crate::ops::{Binary, Unary};

/// `stiffness[3]` is member 3 of the group `stiffness`.
pub(super) fn member(name: &str) -> Option<(&str, usize)> {
    let (base, index) = name.strip_suffix(']')?.rsplit_once('[')?;
    Some((base.trim_end(), index.trim().parse().ok()?))
}

/// A name with the size of its group and its unit.
pub(super) fn labelled(name: &str, members: usize, style: &GraphStyle) -> String {
    let unit_of = |name: &str| style.units.iter().find(|(named, _)| named == name).map(|(_, unit)| unit.as_str());
    let unit = unit_of(name).or_else(|| unit_of(member(name)?.0)).filter(|unit| !unit.is_empty());
    let mut label = name.to_owned();
    if members > 1 {
        let _ = write!(label, " [{members}]");
    }
    if let Some(unit) = unit {
        let _ = write!(label, ", {unit}");
    }
    label
}

/// A constant in a few digits.
pub(super) fn number(value: f64) -> String {
    let size = value.abs();
    if size != 0.0 && !(1e-3..1e6).contains(&size) {
        return format!("{value:.3e}").replace('-', "−");
    }
    let text = format!("{value:.4}");
    let text = if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
    text.replace('-', "−")
}

/// The constants of a group: one number if all are the same, else the first and last.
pub(super) fn numbers(values: &[f64]) -> String {
    match values {
        [] => String::new(),
        [first, rest @ ..] if rest.iter().all(|value| value == first) => number(*first),
        [first, .., last] => format!("{} … {}", number(*first), number(*last)),
        [only] => number(*only),
    }
}

pub(super) fn unary(op: Unary) -> &'static str {
    match op {
        Unary::Neg => "−",
        Unary::Exp => "exp",
        Unary::Ln => "ln",
        Unary::Sqrt => "√",
        Unary::Sin => "sin",
        Unary::Cos => "cos",
        Unary::Tanh => "tanh",
        Unary::Abs => "|·|",
        Unary::Sigmoid => "σ",
        Unary::Atan => "atan",
    }
}

pub(super) fn binary(op: Binary) -> &'static str {
    match op {
        Binary::Add | Binary::Sub => "+",
        Binary::Mul => "×",
        Binary::Div => "÷",
        Binary::Min => "min",
        Binary::Max => "max",
        Binary::Less => "<",
        Binary::Gate => "if",
    }
}
