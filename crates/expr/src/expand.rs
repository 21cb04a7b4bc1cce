//! Calls of functions from text: the formula in the place of the call, with the arguments for the parameters.

use std::ops::Range;
use std::sync::Arc;

use crate::check::Checker;
use crate::error::ExprError;
use crate::exponents::{Exponents, Quantity};
use crate::formulas::{Formulas, MOST_STEPS, Value};
use crate::function::{Frame, Function};
use crate::library::law;
use crate::reference::FUNCTIONS;
use crate::scope::Scope;
use crate::suggest::suggest;
use crate::syntax::{Node, Path, Tree, short};

impl Formulas {
    /// Checks what a function says, as far as that does not depend on its arguments: its names, and the functions that it calls. A
    /// function that calls what is not there yet is refused, so that none can lead back to itself.
    ///
    /// # Errors
    /// The first thing that is wrong; the span is within the function's formula.
    pub fn check(&mut self, function: &Function, scope: &mut dyn Scope) -> Result<(), ExprError> {
        let mut checker = Checker::new(self, scope);
        checker.check_body(function, &function.body)
    }
}

impl Checker<'_> {
    /// What a name of the function that is being expanded stands for.
    pub(crate) fn argument(&self, path: &Path) -> Option<Value> {
        let frame = self.frame.as_ref().filter(|_| !path.quoted[0])?;
        let at = frame.function.signature.parameters.iter().position(|parameter| parameter.name == path.first())?;
        Some(frame.arguments[at].clone())
    }

    /// Whether it is a formula of the library that is read.
    pub(crate) fn in_library(&self) -> bool {
        self.frame.as_ref().is_some_and(|frame| frame.of_library)
    }

    /// A function from text by its name: the user's goes before the library's, except within the library.
    fn function(&self, name: &str) -> Option<(Arc<Function>, bool)> {
        let own = if self.in_library() { None } else { self.scope.function(name) };
        own.map(|function| (function, false)).or_else(|| Some((Arc::clone(&law(name)?.function), true)))
    }

    /// A call of a function that is none of those built in.
    pub(crate) fn call_text(&mut self, name: &str, trees: &[Tree], span: &Range<usize>) -> Result<Value, ExprError> {
        let Some((function, of_library)) = self.function(name) else { return Err(self.no_function(name, span)) };
        count_arguments(&function, trees, span)?;
        let mut arguments = Vec::with_capacity(trees.len());
        for (tree, parameter) in trees.iter().zip(&function.signature.parameters) {
            let mut value = self.value(tree)?;
            if let Some(unit) = parameter.unit {
                value.quantity = match value.quantity {
                    Quantity::Known(own) if !own.fits(unit) => {
                        let told = |unit: Exponents| {
                            if unit.is_pure() { "a pure number".into() } else { format!("in {unit}") }
                        };
                        let (wanted, found) = (told(unit), told(own));
                        let message = format!("`{}` of {name} is {wanted}, and this is {found}", parameter.name);
                        let hint = format!("write it {}", function.signature);
                        return Err(ExprError::new(tree.span.clone(), message).hint(hint));
                    }
                    Quantity::Known(own) => Quantity::Known(own),
                    Quantity::Number | Quantity::Unknown => Quantity::Known(unit),
                };
            }
            arguments.push(value);
        }
        let frame = Frame { function: Arc::clone(&function), arguments, of_library };
        let outer = self.frame.replace(frame);
        let value = self.value(&function.body);
        self.frame = outer;
        value.map_err(|error| self.told_at_call(&function, span, error))
    }

    /// A fault of a function's formula, told where it is called: of several calls within each other, by the innermost.
    fn told_at_call(&mut self, function: &Function, span: &Range<usize>, mut error: ExprError) -> ExprError {
        if !self.told {
            let part = function.part(&error.span);
            error.message = format!("in {}, at `{part}`: {}", function.signature.name, error.message);
            self.told = true;
        }
        error.span = span.clone();
        error
    }

    /// Counts what the formulas of functions come to: a few that call each other twice would grow without end.
    pub(crate) fn count_expanded(&mut self, value: &Value, span: &Range<usize>) -> Result<(), ExprError> {
        if self.frame.is_none() {
            return Ok(());
        }
        self.formulas.expanded += value.parts.len();
        if self.formulas.expanded <= MOST_STEPS {
            return Ok(());
        }
        let message = format!("calls of functions come to more than {MOST_STEPS} operations");
        Err(ExprError::new(span.clone(), message)
            .hint("a function that calls others twice grows fast: name what they give"))
    }

    fn no_function(&self, name: &str, span: &Range<usize>) -> ExprError {
        let own = if self.in_library() { Vec::new() } else { self.scope.functions() };
        let built_in = FUNCTIONS.iter().map(|function| function.name.to_owned());
        let names: Vec<String> = own.into_iter().chain(built_in).chain(crate::library::names()).collect();
        let here = span.start..span.start + name.len();
        suggest(ExprError::new(here, format!("there is no function `{}`", short(name))), name, &names)
    }

    fn check_body(&mut self, function: &Function, tree: &Tree) -> Result<(), ExprError> {
        self.deeper(tree)?;
        match &tree.node {
            Node::Name(path) => {
                let parameter = |name: &str| function.signature.parameters.iter().any(|known| known.name == name);
                if path.quoted[0] || !parameter(path.first()) {
                    self.name(path, &tree.span)?;
                }
            }
            Node::Call(name, trees) => match (FUNCTIONS.iter().find(|known| known.name == name), self.function(name)) {
                (Some(known), _) => known.count_arguments(trees.len(), &tree.span)?,
                (None, Some((called, _))) => count_arguments(&called, trees, &tree.span)?,
                (None, None) => return Err(self.no_function(name, &tree.span)),
            },
            _ => {}
        }
        for tree in tree.node.within() {
            self.check_body(function, tree)?;
        }
        self.depth -= 1;
        Ok(())
    }
}

fn count_arguments(function: &Function, trees: &[Tree], span: &Range<usize>) -> Result<(), ExprError> {
    let wanted = function.signature.parameters.len();
    if trees.len() == wanted {
        return Ok(());
    }
    let plural = if wanted == 1 { "argument" } else { "arguments" };
    let message = format!("{} takes {wanted} {plural}, and has {}", function.signature.name, trees.len());
    Err(ExprError::new(span.clone(), message).hint(format!("write it {}", function.signature)))
}
