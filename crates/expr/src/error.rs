//! What is wrong with a formula, and where.

use std::ops::Range;

use thiserror::Error;

/// A fault of a formula.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[error("{message}")]
pub struct ExprError {
    /// What is wrong.
    pub message: String,
    /// A way out.
    pub hint: Option<String>,
    /// The bytes of the text that it is about.
    pub span: Range<usize>,
}

impl ExprError {
    pub(crate) fn new(span: Range<usize>, message: impl Into<String>) -> Self {
        Self { message: message.into(), hint: None, span }
    }

    pub(crate) fn hint(mut self, hint: impl Into<String>) -> Self {
        self.hint = Some(hint.into());
        self
    }
}
