//! What the elements of an observation are called.

use std::ops::Range;

use hwasp_core::{Dimension, Port};
use hwasp_expr::{Part, Path, Value, groups};
use hwasp_settings::text::shorten;

use super::Compiler;
use crate::names::{InPlace, Place};

/// The most elements that are called by what they read; of more, each by its number.
const MOST_CALLED: usize = 200;

impl Compiler<'_, '_> {
    /// What the components of an observation are called, and what they measure. `clip(joint.*.vel, -1, 1)` is
    /// `clip(joint.knee.vel, -1, 1)` in the component of the knee.
    pub(super) fn called(&mut self, text: &str, value: &Value) -> Vec<Port> {
        let several = value.parts.len() > 1;
        let groups = if value.parts.len() > MOST_CALLED { Vec::new() } else { groups(text) };
        let dimension = value.quantity.dimension().unwrap_or(Dimension::None);
        let mut ports = Vec::new();
        for (i, &part) in value.parts.iter().enumerate() {
            ports.push(if let Some(at) = self.formulas.as_column(part) {
                let columns = &self.names.columns;
                Port { name: columns.names()[at].clone(), dimension: columns.dimension(at) }
            } else if let Some(port) = self.element(text, &groups, part) {
                port
            } else {
                let text = shorten(text, 60);
                Port { name: if several { format!("{text} [{i}]") } else { text }, dimension }
            });
        }
        ports
    }

    /// A component of a formula of groups with the elements that it reads in their place; none where it is no such formula.
    fn element(&mut self, text: &str, groups: &[(Path, Range<usize>)], part: Part) -> Option<Port> {
        if groups.is_empty() {
            return None;
        }
        let (columns, _) = self.formulas.inputs(&[part]);
        let names: Vec<String> = columns.iter().map(|&at| self.names.columns.names()[at].clone()).collect();
        let (mut shown, mut read) = (text.to_owned(), text.to_owned());
        // From the end, so that the places before stay.
        for (path, span) in groups.iter().rev() {
            let mut own = names.iter().filter_map(|name| Some((name, element_of(path, name)?)));
            let (Some((name, written)), None) = (own.next(), own.next()) else { return None };
            shown.replace_range(span.clone(), name);
            read.replace_range(span.clone(), &written);
        }
        let value = self.on_trial(|compiler| {
            let mut scope = InPlace { names: &mut compiler.names, place: Place::Step, width: 1 };
            compiler.formulas.read(&read, &mut scope).ok()
        })?;
        let dimension = value.quantity.dimension().unwrap_or(Dimension::None);
        (value.parts.len() == 1).then(|| Port { name: shorten(&shown, 60), dimension })
    }

    /// Reads something that the robot does not compute: it leaves no column and remembers nothing. None where it would.
    fn on_trial(&mut self, read: impl FnOnce(&mut Self) -> Option<Value>) -> Option<Value> {
        let (columns, memory) = (self.names.columns.clone(), self.names.memory.len());
        let value = read(self);
        let alike = self.names.columns.all().len() == columns.all().len() && self.names.memory.len() == memory;
        if !alike {
            self.names.columns = columns;
            self.names.memory.truncate(memory);
        }
        value.filter(|_| alike)
    }
}

/// The element of a group that has the column of this name, as formulas name it: `joint.*.vel` has `joint.knee.vel`.
fn element_of(path: &Path, column: &str) -> Option<String> {
    let (kind, attribute) = (path.word(0)?, path.word(2));
    let rest = column.strip_prefix(kind)?.strip_prefix('.')?;
    let (stem, index) = rest.split_at(rest.strip_suffix(']').and_then(|stem| stem.rfind('[')).unwrap_or(rest.len()));
    let name = match attribute {
        None => stem,
        Some(attribute) => stem.strip_suffix(attribute)?.strip_suffix('.')?,
    };
    let plain = |c: char| c.is_ascii_alphanumeric() || c == '_';
    let name = match name.strip_prefix('#') {
        Some(_) => name.to_owned(),
        None if name.chars().all(plain) => name.to_owned(),
        None if name.contains(['"', '\\']) => return None,
        None => format!("\"{name}\""),
    };
    let attribute = attribute.map_or_else(String::new, |attribute| format!(".{attribute}"));
    Some(format!("{kind}.{name}{attribute}{index}"))
}
