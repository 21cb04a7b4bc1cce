//! Functions from text: `spring(angle: rad, stiffness: N*m/rad, rest: rad)` with a formula behind it.

use std::fmt;
use std::ops::Range;
use std::sync::Arc;

use crate::error::ExprError;
use crate::exponents::Exponents;
use crate::formulas::Value;
use crate::parser::parse;
use crate::reference::FUNCTIONS;
use crate::syntax::{Tree, short};
use crate::units::parse_unit;

/// The most parameters of a function.
const MOST_PARAMETERS: usize = 20;
/// The longest name, bytes.
const LONGEST_NAME: usize = 50;

/// Why a name of one's own is none that formulas can use.
pub fn name_fault(name: &str) -> Option<String> {
    let plain = |c: char| c.is_ascii_alphanumeric() || c == '_';
    if name.len() > LONGEST_NAME || !name.starts_with(|c: char| c.is_ascii_alphabetic()) || !name.chars().all(plain) {
        return Some(format!("names begin with a letter and have up to {LONGEST_NAME} letters, digits and _"));
    }
    if matches!(name, "and" | "or" | "not" | "pi") {
        return Some(format!("`{name}` has a meaning in formulas"));
    }
    parse_unit(name).is_some().then(|| format!("`{name}` is a unit"))
}

/// What a function is called with.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Parameter {
    /// What the formula calls it.
    pub name: String,
    /// What it has to be in; none where it may be in anything.
    pub unit: Option<Exponents>,
    /// That unit as it was written, to be shown.
    written: String,
}

/// The name of a function and its parameters.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Signature {
    /// Its name.
    pub name: String,
    /// At least one.
    pub parameters: Vec<Parameter>,
}

impl Signature {
    /// Reads `name(first, second: N*m)`.
    ///
    /// # Errors
    /// Of a text that is none; the span is within it.
    pub fn parse(text: &str) -> Result<Self, ExprError> {
        const HINT: &str = "write it spring(angle, stiffness, rest), or with units: spring(angle: rad, ratio: 1)";
        let whole = 0..text.len();
        let inside = text.split_once('(').and_then(|(name, rest)| Some((name, rest.trim_end().strip_suffix(')')?)));
        let Some((name, inside)) = inside else {
            return Err(ExprError::new(whole, format!("`{}` is no function with parameters", short(text))).hint(HINT));
        };
        let fault = |what: &str, name: &str, why: String| {
            ExprError::new(whole.clone(), format!("the {what} `{}` cannot be called so: {why}", short(name)))
                .hint("take another name")
        };
        let name = name.trim();
        if let Some(why) = name_fault(name) {
            return Err(fault("function", name, why));
        }
        if FUNCTIONS.iter().any(|function| function.name == name) {
            return Err(fault("function", name, "formulas have a function of this name".to_owned()));
        }
        if inside.trim().is_empty() {
            let message = format!("`{name}` is a function without parameters");
            return Err(ExprError::new(whole, message).hint(format!("write it without brackets: {name} = \"…\"")));
        }
        let mut parameters: Vec<Parameter> = Vec::new();
        for written in inside.split(',') {
            let (name, unit) = match written.split_once(':') {
                None => (written.trim(), None),
                Some((name, unit)) => (name.trim(), Some(unit.trim())),
            };
            if name.is_empty() {
                let message = format!("`{}` has a parameter without a name", short(text));
                return Err(ExprError::new(whole, message).hint(HINT));
            }
            if let Some(why) = name_fault(name) {
                return Err(fault("parameter", name, why));
            }
            if parameters.iter().any(|known| known.name == name) {
                return Err(fault("parameter", name, "another one has this name".to_owned()));
            }
            let written = unit.unwrap_or_default().to_owned();
            let unit = match unit {
                None => None,
                Some("1") => Some(Exponents::NONE),
                Some(unit) => {
                    // In units that are not SI a call would mean another number than it says.
                    let Some((1.0, exponents)) = parse_unit(unit) else {
                        let message = format!("`{}` of `{name}` is no unit of SI", short(unit));
                        let hint = "units are products of kg, m, s, A, rad, N, W, V, ohm and Hz, such as N*m/rad; 1 is a pure number";
                        return Err(ExprError::new(whole, message).hint(hint));
                    };
                    Some(exponents)
                }
            };
            parameters.push(Parameter { name: name.to_owned(), unit, written });
        }
        if parameters.len() > MOST_PARAMETERS {
            let message = format!("`{name}` has {} parameters, more than {MOST_PARAMETERS}", parameters.len());
            return Err(ExprError::new(whole, message).hint("a vector is one parameter: [a, b, c]"));
        }
        Ok(Self { name: name.to_owned(), parameters })
    }
}

impl fmt::Display for Signature {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}(", self.name)?;
        for (i, Parameter { name, unit, written }) in self.parameters.iter().enumerate() {
            let comma = if i > 0 { ", " } else { "" };
            let colon = if unit.is_some() { ": " } else { "" };
            write!(f, "{comma}{name}{colon}{written}")?;
        }
        f.write_str(")")
    }
}

/// A function from text. What its formula says beside the parameters is read where it is called.
#[derive(Clone, Debug)]
pub struct Function {
    pub(crate) signature: Signature,
    pub(crate) text: String,
    pub(crate) body: Tree,
}

impl Function {
    /// A function with a formula.
    ///
    /// # Errors
    /// Of a text that is no formula; the span is within it.
    pub fn new(signature: Signature, text: &str) -> Result<Self, ExprError> {
        Ok(Self { body: parse(text)?, signature, text: text.to_owned() })
    }

    /// Its name.
    pub fn name(&self) -> &str {
        &self.signature.name
    }

    /// Its name and parameters.
    pub fn signature(&self) -> &Signature {
        &self.signature
    }

    /// Its formula.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// A part of its formula, for messages.
    pub(crate) fn part(&self, span: &Range<usize>) -> String {
        short(self.text.get(span.clone()).unwrap_or(&self.text))
    }
}

/// A call that is being expanded.
pub(crate) struct Frame {
    pub(crate) function: Arc<Function>,
    pub(crate) arguments: Vec<Value>,
    /// Whether the function is of the library, which knows nothing of a user's names.
    pub(crate) of_library: bool,
}
