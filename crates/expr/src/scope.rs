//! What names stand for.

use std::sync::Arc;

use crate::exponents::Quantity;
use crate::formulas::{Formulas, Part, Value};
use crate::function::Function;
use crate::syntax::Path;

/// What a name stands for.
#[derive(Clone, Debug)]
pub struct Symbol {
    /// Its components.
    pub parts: Vec<Part>,
    /// What they measure.
    pub quantity: Quantity,
    /// How many parts of the path belong to the name; those that follow are components, `.x`.
    pub used: usize,
}

impl Symbol {
    /// A name of `used` parts.
    pub fn new(parts: Vec<Part>, quantity: Quantity, used: usize) -> Self {
        Self { parts, quantity, used }
    }
}

/// Why a name stands for nothing.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NameError {
    /// Which part of the path is wrong; 0 where it is the name as a whole.
    pub at: usize,
    /// What is wrong; empty for a name that is not known.
    pub message: String,
    /// What could have been meant: the nearest is told.
    pub known: Vec<String>,
    /// A way out, where it is no other name.
    pub hint: Option<String>,
}

impl NameError {
    /// A first part that nobody knows.
    pub fn unknown(known: impl IntoIterator<Item = impl Into<String>>) -> Self {
        Self::at(0, known)
    }

    /// A part that nobody knows.
    pub fn at(at: usize, known: impl IntoIterator<Item = impl Into<String>>) -> Self {
        Self { at, message: String::new(), known: known.into_iter().map(Into::into).collect(), hint: None }
    }

    /// Something else.
    pub fn because(at: usize, message: impl Into<String>, hint: impl Into<String>) -> Self {
        Self { at, message: message.into(), known: Vec::new(), hint: Some(hint.into()) }
    }
}

/// How a random number is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Distribution {
    /// Uniform in [0, 1).
    Uniform,
    /// Normal, mean 0 and standard deviation 1.
    Normal,
}

/// Knows what names stand for, in one place of an experiment.
pub trait Scope {
    /// What a name stands for. Inputs come into being by [`Formulas::column`] and [`Formulas::uniform`].
    ///
    /// # Errors
    /// Of a name that is not known here.
    fn name(&mut self, formulas: &mut Formulas, path: &Path) -> Result<Symbol, NameError>;

    /// The values of the step before, of which as many are to be remembered as `value` has components.
    ///
    /// # Errors
    /// Why there is none here.
    fn previous(&mut self, _formulas: &mut Formulas, _value: &Value) -> Result<Vec<Part>, String> {
        Err("there is no step before here".to_owned())
    }

    /// Random numbers, `count` of them.
    ///
    /// # Errors
    /// Why nothing is drawn here.
    fn draw(&mut self, _formulas: &mut Formulas, _from: Distribution, _count: usize) -> Result<Vec<Part>, String> {
        Err("nothing is drawn at random here".to_owned())
    }

    /// How many components a draw has: those of what the formula is for.
    fn width(&self) -> usize {
        1
    }

    /// Whether sums of unlike dimensions are faults: in laws.
    fn strict(&self) -> bool {
        false
    }

    /// A function of the user's by its name. Those of the library are there everywhere.
    fn function(&self, _name: &str) -> Option<Arc<Function>> {
        None
    }

    /// The names of the user's functions, of which the nearest is told.
    fn functions(&self) -> Vec<String> {
        Vec::new()
    }
}
