//! Names for formulas, and functions.

use std::sync::Arc;

use hwasp_expr::{ExprError, Function, Signature};

use super::Compiler;
use crate::names::{InPlace, OwnName, Place};
use crate::parameter::name_fault;
use crate::texts::tell;

/// An entry of `[task.define]`.
struct Definition<'s> {
    key: &'s str,
    text: &'s str,
    /// None of a name for a formula.
    function: Option<Arc<Function>>,
}

impl Definition<'_> {
    fn name(&self) -> &str {
        self.function.as_ref().map_or(self.key, |function| function.name())
    }

    /// Whether it is what a fault says is not there.
    fn is_missing(&self, error: &ExprError) -> bool {
        match &self.function {
            Some(function) => error.message == format!("there is no function `{}`", function.name()),
            None => error.message == format!("`{}` is not known", self.key),
        }
    }
}

impl Compiler<'_, '_> {
    /// Names and functions, which may name each other. Each is read as soon as what it names is there, so that none leads back to
    /// itself. What cannot be read is told, or left for later.
    pub(super) fn definitions(&mut self, tells: bool) {
        let settings = self.settings;
        let mut left: Vec<Definition<'_>> = Vec::new();
        for (key, text) in &settings.define {
            if !self.defined.contains(key) {
                let found = self.definition(key, text, &left, tells);
                left.extend(found);
            }
        }
        // One that names another waits for it: to read all again for each would never end.
        let mut tried = vec![false; left.len()];
        for first in 0..left.len() {
            let mut waiting = if tried[first] { vec![] } else { vec![first] };
            while let Some(&at) = waiting.last() {
                match self.define(&left[at]) {
                    Ok(()) => self.defined.push(left[at].key.to_owned()),
                    Err(error) => {
                        let other = left.iter().position(|other| other.is_missing(&error));
                        if let Some(other) = other.filter(|other| !tried[*other] && !waiting.contains(other)) {
                            waiting.push(other);
                            continue;
                        }
                    }
                }
                tried[at] = true;
                waiting.pop();
            }
        }
        left.retain(|definition| !self.defined.iter().any(|key| key == definition.key));
        if !tells {
            self.names.faulty.pending = left.iter().map(|definition| definition.name().to_owned()).collect();
            return;
        }
        self.names.faulty.pending.clear();
        let roots = self.tell_definitions(&left);
        self.tell_waiting(roots);
    }

    /// Tells what is wrong with definitions, each fault once: what names a faulty one has none of its own, and a circle is told
    /// where it begins. How many were told.
    fn tell_definitions(&mut self, left: &[Definition<'_>]) -> usize {
        let mut errors: Vec<Option<ExprError>> = Vec::new();
        for definition in left {
            self.names.faulty.take();
            let error = self.define(definition).err();
            let follows = self.names.faulty.take().is_some();
            errors.push(error.filter(|_| !follows));
        }
        let next = |at: usize| left.iter().position(|other| errors[at].as_ref().is_some_and(|e| other.is_missing(e)));
        let mut roots = 0;
        for (at, definition) in left.iter().enumerate() {
            self.sound = false;
            let Some(error) = &errors[at] else { continue };
            let mut error = error.clone();
            let mut circle = vec![at];
            while let Some(other) = next(circle[circle.len() - 1]).filter(|other| !circle.contains(other)) {
                circle.push(other);
            }
            let last = next(circle[circle.len() - 1]);
            if circle.len() > 1 || last.is_some() {
                // It leads to a fault, into a circle, or stands in one that is told at its first.
                if last != Some(at) || circle.iter().any(|other| *other < at) {
                    continue;
                }
                let names: Vec<&str> = circle.iter().chain([&at]).map(|&at| left[at].name()).collect();
                (error.message, error.hint) = if circle.len() == 1 {
                    let hint = "a law has as many operations at every moment: write the steps out";
                    (format!("`{}` names itself", definition.name()), Some(hint.to_owned()))
                } else {
                    let message = format!("`{}` leads back to itself: {}", definition.name(), names.join(", "));
                    (message, Some("a definition can name those that do not name it".to_owned()))
                };
            }
            tell(self.section, &["define", definition.key], 0, &error);
            roots += 1;
        }
        self.names.faulty.own.extend(left.iter().map(|definition| definition.name().to_owned()));
        roots
    }

    /// What a key and its text say, where both can be used; else the fault is told.
    fn definition<'s>(
        &mut self,
        key: &'s str,
        text: &'s str,
        known: &[Definition<'_>],
        tells: bool,
    ) -> Option<Definition<'s>> {
        if !key.contains('(') {
            let free = if tells { self.own_name("define", key) } else { self.own_name_fault(key).is_none() };
            return free.then_some(Definition { key, text, function: None });
        }
        let signature = Signature::parse(key).and_then(|signature| {
            let mut names =
                std::iter::once(&signature.name).chain(signature.parameters.iter().map(|known| &known.name));
            let refuse = |message, hint: &str| ExprError { message, hint: Some(hint.to_owned()), span: 0..key.len() };
            if let Some((name, why)) = names.find_map(|name| Some((name, name_fault(name)?))) {
                return Err(refuse(format!("`{name}` cannot be called so: {why}"), "take another name"));
            }
            let mut others = known.iter().filter_map(|other| other.function.as_ref()).chain(&self.names.functions);
            if others.any(|other| other.name() == signature.name) {
                let hint = "give one of them another name: a function has one number of parameters";
                return Err(refuse(format!("there are two functions `{}`", signature.name), hint));
            }
            Ok(signature)
        });
        let signature = match signature {
            Ok(signature) => signature,
            Err(error) => {
                if tells {
                    self.refuse(&["define", key], error.message, error.hint);
                }
                return None;
            }
        };
        match Function::new(signature, text) {
            Ok(function) => Some(Definition { key, text, function: Some(Arc::new(function)) }),
            Err(error) => {
                if tells {
                    tell(self.section, &["define", key], 0, &error);
                    self.sound = false;
                }
                None
            }
        }
    }

    fn define(&mut self, definition: &Definition<'_>) -> Result<(), ExprError> {
        let remembered = self.names.memory.len();
        let mut scope = InPlace { names: &mut self.names, place: Place::Define, width: 1 };
        if let Some(function) = &definition.function {
            self.formulas.check(function, &mut scope)?;
            self.names.functions.push(Arc::clone(function));
            return Ok(());
        }
        match self.formulas.read(definition.text, &mut scope) {
            Ok(value) => self.names.own.push(OwnName { name: definition.key.to_owned(), value }),
            Err(error) => {
                // What it wanted to be remembered, it will want again.
                self.names.memory.truncate(remembered);
                return Err(error);
            }
        }
        Ok(())
    }
}
