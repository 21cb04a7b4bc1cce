//! Who takes part in a comparison.

use super::CompareError;
use crate::spec::{Layers, Method};

/// A method, and where its design begins if not where the experiment says.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Contender {
    /// How tables call it: what was written.
    pub label: String,
    /// The method.
    pub method: Method,
    /// `design.initial`.
    initial: Option<String>,
}

impl Contender {
    /// Reads `hwasp`, or `fixed:middle`, `fixed:random`, `fixed:2 N/m`: a method, and after a colon where the design
    /// begins, which is where hardware that is fixed stays.
    pub fn parse(text: &str) -> Result<Self, CompareError> {
        let text = text.trim();
        let (name, initial) = text.split_once(':').map_or((text, None), |(name, initial)| (name, Some(initial.trim())));
        let Some(method) = Method::from_name(name.trim()) else {
            let names: Vec<_> = Method::ALL.iter().map(|(name, _)| *name).collect();
            let hint =
                format!("the methods are {}; fixed:middle, fixed:random or fixed:\"2 N/m\" too", names.join(", "));
            return Err(CompareError::Contender { text: text.to_owned(), hint });
        };
        if initial == Some("") {
            let hint = format!("say where the design begins, such as {name}:middle, or leave the colon out");
            return Err(CompareError::Contender { text: text.to_owned(), hint });
        }
        // A random design is the one that the experiment draws.
        let initial = initial.map(|initial| if initial == "random" { "logit" } else { initial }.to_owned());
        Ok(Self { label: text.to_owned(), method, initial })
    }

    /// The experiment as this contender runs it.
    pub(super) fn apply(&self, layers: Layers) -> Layers {
        match &self.initial {
            Some(initial) => {
                // Quoted, so that a number is the text that a quantity has to be.
                let quoted = format!("{initial:?}");
                layers.with_option(format!("--methods {}", self.label), "design.initial", &quoted)
            }
            None => layers,
        }
    }

    /// Its label without what a folder should not be called.
    pub(super) fn folder_name(&self) -> String {
        self.label.chars().map(|c| if c.is_ascii_alphanumeric() || "-.".contains(c) { c } else { '_' }).collect()
    }
}
