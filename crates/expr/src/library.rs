//! The library of laws: text in the language itself, `laws.toml`.

use std::sync::{Arc, LazyLock};

use crate::error::ExprError;
use crate::exponents::Quantity;
use crate::formulas::{Formulas, Value};
use crate::function::{Function, Signature};
use crate::scope::{NameError, Scope, Symbol};
use crate::syntax::Path;

/// The text of the library, as it can stand below `[task.define]`.
pub const LIBRARY: &str = include_str!("laws.toml");

/// A law of the library.
#[derive(Clone, Debug)]
pub struct LawDoc {
    /// Name, parameters and formula.
    pub function: Arc<Function>,
    /// What it is.
    pub about: String,
    /// Where that is written.
    pub source: String,
}

static LAWS: LazyLock<Vec<LawDoc>> = LazyLock::new(|| read(LIBRARY));

/// All of them, in the order of the text.
pub fn laws() -> &'static [LawDoc] {
    &LAWS
}

pub(crate) fn law(name: &str) -> Option<&'static LawDoc> {
    laws().iter().find(|law| law.function.name() == name)
}

pub(crate) fn names() -> impl Iterator<Item = String> {
    laws().iter().map(|law| law.function.name().to_owned())
}

/// Definitions, each in a line behind the comments that say what it is; a test holds the text to this form.
fn read(text: &str) -> Vec<LawDoc> {
    let (mut laws, mut about, mut source) = (Vec::new(), Vec::new(), String::new());
    for line in text.lines() {
        if let Some(comment) = line.strip_prefix("# ") {
            match comment.strip_prefix("Source: ") {
                Some(from) => from.clone_into(&mut source),
                None => about.push(comment),
            }
            continue;
        }
        let parts = line.strip_prefix('"').and_then(|rest| rest.strip_suffix('"')?.split_once("\" = \""));
        let function = parts.and_then(|(signature, formula)| define(signature, formula).ok());
        if let Some(function) = function {
            laws.push(LawDoc { function: Arc::new(function), about: about.join(" "), source: source.clone() });
        }
        about.clear();
        source.clear();
    }
    laws
}

fn define(signature: &str, formula: &str) -> Result<Function, ExprError> {
    Function::new(Signature::parse(signature)?, formula)
}

impl LawDoc {
    /// What it gives where its arguments are what they have to be.
    ///
    /// # Errors
    /// What is wrong with it.
    pub fn gives(&self) -> Result<Quantity, ExprError> {
        /// The parameters as names.
        struct Alone<'f>(&'f Signature);

        impl Scope for Alone<'_> {
            fn name(&mut self, formulas: &mut Formulas, path: &Path) -> Result<Symbol, NameError> {
                let at = self.0.parameters.iter().position(|parameter| parameter.name == path.first());
                let at =
                    at.ok_or_else(|| NameError::unknown(self.0.parameters.iter().map(|known| known.name.clone())))?;
                let unit = self.0.parameters[at].unit.map_or(Quantity::Unknown, Quantity::Known);
                Ok(Symbol::new(vec![formulas.column(at)], unit, 1))
            }

            fn strict(&self) -> bool {
                true
            }
        }

        let Value { quantity, .. } =
            Formulas::default().read(self.function.text(), &mut Alone(self.function.signature()))?;
        Ok(quantity)
    }
}
