//! Who takes part in a comparison.

use hwasp_experiment::{Layers, Method};

use crate::error::CompareError;

/// A method, and what it sets of the experiment.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Contender {
    /// How tables call it: what was written.
    pub label: String,
    /// The method.
    pub method: Method,
    /// What it sets of the experiment.
    settings: Vec<(String, String)>,
}

impl Contender {
    /// Reads some of them, separated by commas; those within braces and quotes separate nothing.
    pub fn parse_list(text: &str) -> Result<Vec<Self>, CompareError> {
        let (mut depth, mut quoted) = (0_usize, false);
        let separates = |c: char| {
            match c {
                '"' => quoted = !quoted,
                '{' if !quoted => depth += 1,
                '}' if !quoted => depth = depth.saturating_sub(1),
                _ => {}
            }
            c == ',' && depth == 0 && !quoted
        };
        text.split(separates).map(Self::parse).collect()
    }

    /// Reads `hwasp`, or `fixed:middle`, `fixed:random`, `fixed:2 N/m`, `fixed:{ gear = 70, shank = "0.5 m" }`: a method, and
    /// after a colon where the design begins, which is where hardware that is fixed stays. Parameters that are not named begin
    /// where the problem says, in the middle where it does not.
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
        // Values of parameters stand in one pair of braces, and nothing else has any.
        let table = initial.and_then(|initial| initial.strip_prefix('{')).map(|text| text.strip_suffix('}'));
        let inside = table.unwrap_or(initial).unwrap_or("}");
        let named = table.is_none() || inside.contains('=') || inside.trim().is_empty();
        if initial.is_some() && (inside.contains(['{', '}']) || !named) {
            let hint = format!("write values of parameters like {name}:'{{ gear = 70, shank = \"0.5 m\" }}'");
            return Err(CompareError::Contender { text: text.to_owned(), hint });
        }
        let contender = Self { label: text.to_owned(), method, settings: Vec::new() };
        Ok(match initial {
            // A random design is the one that the experiment draws.
            Some("random") => contender.with("design.initial", "\"logit\""),
            // One for each parameter, as the experiment has it.
            Some(table) if table.starts_with('{') => contender.with("design.initial", table),
            // Quoted, so that a number is the text that a quantity has to be.
            Some(initial) => contender.with("design.initial", &format!("{initial:?}")),
            None => contender,
        })
    }

    /// The same with one value of the experiment set.
    pub(super) fn with(mut self, key: &str, value: &str) -> Self {
        self.settings.push((key.to_owned(), value.to_owned()));
        self
    }

    /// The experiment as this contender runs it.
    pub(super) fn apply(&self, layers: Layers) -> Layers {
        let typed = format!("--methods {}", self.label);
        self.settings.iter().fold(layers, |layers, (key, value)| layers.with_option(typed.clone(), key, value))
    }

    /// Its label without what a folder should not be called.
    pub(super) fn folder_name(&self) -> String {
        folder_name(&self.label)
    }
}

/// A label without what a folder should not be called.
pub(super) fn folder_name(label: &str) -> String {
    label.chars().map(|c| if c.is_ascii_alphanumeric() || "-.".contains(c) { c } else { '_' }).collect()
}
