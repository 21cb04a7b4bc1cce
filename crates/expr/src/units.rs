//! Units in formulas: products and powers of symbols, `N*m/rad`, `m/s^2`.

use hwasp_core::split_quantity;

use crate::error::ExprError;
use crate::exponents::Exponents;

/// Symbol, factor to SI, exponents of kg, m, s, A, rad.
const SYMBOLS: &[(&str, f64, [i8; 5])] = &[
    ("m", 1.0, [0, 1, 0, 0, 0]),
    ("km", 1e3, [0, 1, 0, 0, 0]),
    ("cm", 1e-2, [0, 1, 0, 0, 0]),
    ("mm", 1e-3, [0, 1, 0, 0, 0]),
    ("s", 1.0, [0, 0, 1, 0, 0]),
    ("ms", 1e-3, [0, 0, 1, 0, 0]),
    ("min", 60.0, [0, 0, 1, 0, 0]),
    ("kg", 1.0, [1, 0, 0, 0, 0]),
    ("g", 1e-3, [1, 0, 0, 0, 0]),
    ("N", 1.0, [1, 1, -2, 0, 0]),
    ("kN", 1e3, [1, 1, -2, 0, 0]),
    ("mN", 1e-3, [1, 1, -2, 0, 0]),
    ("J", 1.0, [1, 2, -2, 0, 0]),
    ("W", 1.0, [1, 2, -3, 0, 0]),
    ("Hz", 1.0, [0, 0, -1, 0, 0]),
    ("Pa", 1.0, [1, -1, -2, 0, 0]),
    ("A", 1.0, [0, 0, 0, 1, 0]),
    ("V", 1.0, [1, 2, -3, -1, 0]),
    ("ohm", 1.0, [1, 2, -3, -2, 0]),
    ("rad", 1.0, [0, 0, 0, 0, 1]),
    ("deg", std::f64::consts::PI / 180.0, [0, 0, 0, 0, 1]),
    ("rpm", std::f64::consts::PI / 30.0, [0, 0, -1, 0, 1]),
];

/// Factor and exponents of one symbol.
pub(crate) fn symbol(name: &str) -> Option<(f64, Exponents)> {
    let found = SYMBOLS.iter().find(|(symbol, ..)| *symbol == name);
    found.map(|&(_, factor, exponents)| (factor, Exponents::new(exponents)))
}

/// The unit at the start of `text`: its factor to SI, its exponents, and how many bytes it takes; none where there is none.
///
/// What follows `*`, `·` or `/` belongs to it where it is a symbol too and no space is in between.
pub(crate) fn unit_at(text: &str) -> Option<(f64, Exponents, usize)> {
    let (mut factor, mut exponents, mut at) = power_at(text)?;
    loop {
        let rest = &text[at..];
        let Some(operator) = rest.chars().next().filter(|c| matches!(c, '*' | '·' | '/')) else { break };
        let Some((next, of, length)) = power_at(&rest[operator.len_utf8()..]) else { break };
        let sign = if operator == '/' { -1 } else { 1 };
        factor *= next.powi(sign);
        exponents = exponents.times(of.power(sign));
        at += operator.len_utf8() + length;
    }
    Some((factor, exponents, at))
}

/// A symbol with its exponent: `s^2`, `s²`.
fn power_at(text: &str) -> Option<(f64, Exponents, usize)> {
    let length = text.find(|c: char| !c.is_ascii_alphabetic()).unwrap_or(text.len());
    let rest = &text[length..];
    // `m_1` and `s2` are names, `s.x` is one too.
    if rest.starts_with(|c: char| c.is_alphanumeric() || matches!(c, '_' | '.' | '[' | '(')) {
        return None;
    }
    let (factor, exponents) = symbol(&text[..length])?;
    let powers = [("^2", 2), ("²", 2), ("^3", 3), ("³", 3)];
    let power = powers.into_iter().find(|(written, _)| rest.starts_with(written));
    Some(power.map_or((factor, exponents, length), |(written, power)| {
        (factor.powi(power), exponents.power(power), length + written.len())
    }))
}

/// A unit by itself, `"N*m/rad"`: its factor to SI and its exponents; none where the text is no unit.
pub fn parse_unit(text: &str) -> Option<(f64, Exponents)> {
    let text = text.trim();
    let (factor, exponents, length) = unit_at(text)?;
    (length == text.len()).then_some((factor, exponents))
}

/// A number with its unit, `"-0.5 rad"`, or without one: the value in SI, and the exponents of the unit where there is one.
///
/// # Errors
/// Of a text that is neither.
pub fn quantity(text: &str) -> Result<(f64, Option<Exponents>), ExprError> {
    let whole = 0..text.len();
    let (number, unit) = split_quantity(text);
    let Ok(value) = number.parse::<f64>() else {
        return Err(ExprError::new(whole, format!("`{}` does not begin with a number", text.trim())));
    };
    if unit.is_empty() {
        return Ok((value, None));
    }
    match parse_unit(unit) {
        Some((factor, exponents)) => Ok((value * factor, Some(exponents))),
        None => Err(unknown_unit(whole, unit)),
    }
}

fn unknown_unit(span: std::ops::Range<usize>, unit: &str) -> ExprError {
    let symbols = SYMBOLS.iter().map(|(symbol, ..)| *symbol).collect::<Vec<_>>().join(", ");
    ExprError::new(span, format!("`{unit}` is no unit"))
        .hint(format!("units are products of {symbols}, such as N*m/rad or m/s^2"))
}
