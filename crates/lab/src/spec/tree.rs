//! Values with their origins: what a file, a method's tables and the command line say, merged.

use std::collections::BTreeMap;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::fault::{shorten, show};
use super::source::Origin;

/// A value and where it was written.
#[derive(Clone, Debug)]
pub(super) struct Node {
    pub(super) origin: Origin,
    pub(super) value: Value,
}

/// What TOML can say.
#[derive(Clone, Debug)]
pub(super) enum Value {
    Text(String),
    Integer(i64),
    Float(f64),
    Flag(bool),
    List(Vec<Node>),
    Table(Table),
    /// What no key takes: dates, and integers of more than 64 bits; kept as what it is, for the message.
    Other(String),
}

/// A key's value and where the key itself was written.
#[derive(Clone, Debug)]
pub(super) struct Entry {
    pub(super) key: Origin,
    pub(super) node: Node,
}

/// Keys with their values.
pub(super) type Table = BTreeMap<String, Entry>;

impl Node {
    /// The same as parsed, as part of a source.
    pub(super) fn from_toml(parsed: &Spanned<DeValue<'_>>, source: usize) -> Self {
        let value = match parsed.get_ref() {
            DeValue::String(text) => Value::Text(text.as_ref().to_owned()),
            DeValue::Integer(digits) => match i64::from_str_radix(digits.as_str(), digits.radix()) {
                Ok(value) => Value::Integer(value),
                Err(_) => Value::Other(format!("the integer {}", shorten(&digits.to_string(), 40))),
            },
            DeValue::Float(digits) => match digits.as_str().parse() {
                Ok(value) => Value::Float(value),
                Err(_) => Value::Other(format!("the number {}", shorten(digits.as_str(), 40))),
            },
            DeValue::Boolean(flag) => Value::Flag(*flag),
            DeValue::Datetime(date) => Value::Other(format!("the date {date}")),
            DeValue::Array(list) => Value::List(list.iter().map(|item| Self::from_toml(item, source)).collect()),
            DeValue::Table(table) => Value::Table(from_toml(table, source)),
        };
        Self { origin: Origin { source, span: parsed.span() }, value }
    }

    /// How the value was written, near enough for a message.
    pub(super) fn shown(&self) -> String {
        match &self.value {
            Value::Text(text) => format!("\"{}\"", shorten(text, 60)),
            Value::Integer(value) => value.to_string(),
            Value::Float(value) => show(*value),
            Value::Flag(value) => value.to_string(),
            Value::List(items) => format!("a list of {}", items.len()),
            Value::Table(_) => "a table".into(),
            Value::Other(what) => what.clone(),
        }
    }

    /// The same as a number, where it is one.
    pub(super) fn number(&self) -> Option<f64> {
        match self.value {
            Value::Float(value) => Some(value),
            Value::Integer(value) => Some(value as f64),
            _ => None,
        }
    }
}

/// All keys of a parsed table.
pub(super) fn from_toml(table: &DeTable<'_>, source: usize) -> Table {
    table
        .iter()
        .map(|(key, value)| {
            let origin = Origin { source, span: key.span() };
            (key.get_ref().as_ref().to_owned(), Entry { key: origin, node: Node::from_toml(value, source) })
        })
        .collect()
}

/// Lays `over` upon `base`: tables are merged key by key, everything else is replaced.
pub(super) fn merge(base: &mut Table, over: Table) {
    for (key, entry) in over {
        match (base.get_mut(&key), entry) {
            (
                Some(Entry { node: Node { value: Value::Table(below), .. }, .. }),
                Entry { node: Node { value: Value::Table(above), .. }, .. },
            ) => merge(below, above),
            (_, entry) => {
                base.insert(key, entry);
            }
        }
    }
}
