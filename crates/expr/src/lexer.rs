//! From text to tokens.

use std::ops::Range;

use crate::error::ExprError;
use crate::exponents::Exponents;
use crate::units::unit_at;

/// A word or sign.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Token {
    /// A number in SI, with the unit that was written beside it.
    Number(f64, Option<Exponents>),
    /// `joint`, or a part of a name in quotes.
    Word(String),
    /// `#2`, an element by its index.
    Index(usize),
    /// Anything else: an operator or a bracket.
    Sign(&'static str),
}

/// Signs, the longer ones first.
const SIGNS: [&str; 21] =
    ["<=", ">=", "==", "!=", "<", ">", "+", "-", "*", "/", "^", "(", ")", "[", "]", ",", ":", ".", "·", "−", "×"];

/// A token and where it stands.
#[derive(Clone, Debug)]
pub(crate) struct Spanned {
    pub(crate) token: Token,
    pub(crate) span: Range<usize>,
}

/// Takes a text apart.
pub(crate) fn tokens(text: &str) -> Result<Vec<Spanned>, ExprError> {
    let mut tokens: Vec<Spanned> = Vec::new();
    let mut at = 0;
    while let Some(first) = text[at..].chars().next() {
        let start = at;
        let rest = &text[at..];
        if first.is_whitespace() {
            at += first.len_utf8();
            continue;
        }
        let token = if first.is_ascii_digit() {
            number(text, &mut at, after_dot(&tokens))?
        } else if first == '"' || first == '\'' {
            Token::Word(quoted(text, &mut at, first)?)
        } else if first.is_ascii_alphabetic() || first == '_' {
            let length = rest.find(|c: char| !(c.is_ascii_alphanumeric() || c == '_')).unwrap_or(rest.len());
            at += length;
            Token::Word(rest[..length].to_owned())
        } else if first == '#' {
            let digits = &rest[1..];
            let length = digits.find(|c: char| !c.is_ascii_digit()).unwrap_or(digits.len());
            at += 1 + length;
            let index = digits[..length].parse().map_err(|_| {
                ExprError::new(start..at.max(start + 1), "# is not followed by a number")
                    .hint("elements without a name are counted from 0: joint.#2.pos")
            })?;
            Token::Index(index)
        } else if let Some(sign) = SIGNS.into_iter().find(|sign| rest.starts_with(sign)) {
            at += sign.len();
            Token::Sign(match sign {
                "·" | "×" => "*",
                "−" => "-",
                sign => sign,
            })
        } else {
            return Err(unexpected(first, start));
        };
        tokens.push(Spanned { token, span: start..at });
    }
    Ok(tokens)
}

fn unexpected(first: char, start: usize) -> ExprError {
    let shown = if first.is_control() { format!("character {:#x}", first as u32) } else { format!("`{first}`") };
    let error = ExprError::new(start..start + first.len_utf8(), format!("{shown} means nothing in a formula"));
    match first {
        '=' => error.hint("a comparison is written == or <="),
        '&' | '|' | '!' => error.hint("write and, or, not"),
        '%' => error.hint("a share is written as a number, 0.05"),
        '°' => error.hint("an angle is written 45 deg"),
        _ => error,
    }
}

/// Whether what follows continues a name: in `joint.2` the 2 is no number of its own.
fn after_dot(tokens: &[Spanned]) -> bool {
    matches!(tokens.last(), Some(Spanned { token: Token::Sign("."), .. }))
}

fn number(text: &str, at: &mut usize, in_name: bool) -> Result<Token, ExprError> {
    let (start, rest) = (*at, &text[*at..]);
    let bytes = rest.as_bytes();
    let digits = |mut i: usize| {
        while i < bytes.len() && (bytes[i].is_ascii_digit() || bytes[i] == b'_') {
            i += 1;
        }
        i
    };
    let mut length = digits(0);
    if in_name {
        let hint = format!("put the name into quotes, or write #{} for an index", &rest[..length]);
        return Err(ExprError::new(start..start + length, "a name does not begin with a digit").hint(hint));
    }
    if length < bytes.len() && bytes[length] == b'.' && bytes.get(length + 1).is_none_or(u8::is_ascii_digit) {
        length = digits(length + 1);
    }
    if bytes.get(length).is_some_and(|b| matches!(b, b'e' | b'E')) {
        let sign = usize::from(bytes.get(length + 1).is_some_and(|b| matches!(b, b'+' | b'-')));
        if bytes.get(length + 1 + sign).is_some_and(u8::is_ascii_digit) {
            length = digits(length + 1 + sign);
        }
    }
    *at += length;
    let value: Option<f64> = rest[..length].replace('_', "").parse().ok();
    let value = value.filter(|value| value.is_finite()).ok_or_else(|| {
        ExprError::new(
            start..start + length,
            format!("`{}` is no finite number", crate::syntax::short(&rest[..length])),
        )
    })?;
    let after = &text[*at..];
    let unit = after.trim_start_matches(' ');
    if let Some((factor, exponents, length)) = unit_at(unit) {
        *at += after.len() - unit.len() + length;
        return Ok(Token::Number(value * factor, Some(exponents)));
    }
    let word: String = unit.chars().take_while(|c| c.is_ascii_alphanumeric() || *c == '_').collect();
    if !word.is_empty() && !matches!(word.as_str(), "and" | "or") {
        let from = *at + after.len() - unit.len();
        let message = format!("`{}` after a number is no unit", crate::syntax::short(&word));
        return Err(ExprError::new(from..from + word.len(), message)
            .hint("a product is written with *, units are written as in 0.5 N*m/rad"));
    }
    Ok(Token::Number(value, None))
}

fn quoted(text: &str, at: &mut usize, quote: char) -> Result<String, ExprError> {
    let (start, rest) = (*at, &text[*at + 1..]);
    let Some(length) = rest.find(quote) else {
        return Err(ExprError::new(start..text.len(), "the quotes are not closed"));
    };
    *at += length + 2;
    Ok(rest[..length].to_owned())
}
