//! Values with their origins: what a file, a method's tables and the command line say, merged.

use std::collections::BTreeMap;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use crate::source::Origin;
use crate::text::{shorten, show};

/// Items of a list that a message shows.
const SHOWN_ITEMS: usize = 6;

/// A value and where it was written.
#[derive(Clone, Debug)]
pub struct Node {
    /// Where it was written.
    pub origin: Origin,
    /// What it is.
    pub value: Value,
}

/// What TOML can say.
#[derive(Clone, Debug)]
pub enum Value {
    /// A text.
    Text(String),
    /// A whole number of 64 bits.
    Integer(i64),
    /// A real number.
    Float(f64),
    /// True or false.
    Flag(bool),
    /// Values in order.
    List(Vec<Node>),
    /// Keys with values.
    Table(Table),
    /// An integer of more than 64 bits, in decimal or as it was written.
    Huge(String),
    /// A date, which no key takes.
    Date(String),
}

/// A key's value and where the key itself was written.
#[derive(Clone, Debug)]
pub struct Entry {
    /// Where the key was written.
    pub key: Origin,
    /// Its value.
    pub node: Node,
}

/// Keys with their values.
pub type Table = BTreeMap<String, Entry>;

impl Node {
    /// The same as parsed, as part of a source.
    pub(crate) fn from_toml(parsed: &Spanned<DeValue<'_>>, source: usize) -> Self {
        let value = match parsed.get_ref() {
            DeValue::String(text) => Value::Text(text.as_ref().to_owned()),
            DeValue::Integer(digits) => match i64::from_str_radix(digits.as_str(), digits.radix()) {
                Ok(value) => Value::Integer(value),
                Err(_) => Value::Huge(digits.to_string()),
            },
            DeValue::Float(digits) => match digits.as_str().parse() {
                Ok(value) => Value::Float(value),
                Err(_) => Value::Huge(digits.as_str().to_owned()),
            },
            DeValue::Boolean(flag) => Value::Flag(*flag),
            DeValue::Datetime(date) => Value::Date(date.to_string()),
            DeValue::Array(list) => Value::List(list.iter().map(|item| Self::from_toml(item, source)).collect()),
            DeValue::Table(table) => Value::Table(from_toml(table, source)),
        };
        Self { origin: Origin { source, span: parsed.span() }, value }
    }

    /// How the value was written, near enough for a message.
    pub fn shown(&self) -> String {
        match &self.value {
            Value::Text(text) => format!("\"{}\"", shorten(text, 60)),
            Value::Integer(value) => value.to_string(),
            Value::Float(value) => show(*value),
            Value::Flag(value) => value.to_string(),
            Value::List(items) => {
                let shown = items.iter().take(SHOWN_ITEMS).map(Self::shown).collect::<Vec<_>>().join(", ");
                format!("[{shown}{}]", if items.len() > SHOWN_ITEMS { ", …" } else { "" })
            }
            Value::Table(_) => "a table".into(),
            Value::Huge(text) | Value::Date(text) => shorten(text, 40),
        }
    }

    /// The same as a number, where it is one.
    pub fn number(&self) -> Option<f64> {
        match self.value {
            Value::Float(value) => Some(value),
            Value::Integer(value) => Some(value as f64),
            Value::Huge(ref digits) => digits.parse().ok(),
            _ => None,
        }
    }
}

/// All keys of a parsed table.
pub(crate) fn from_toml(table: &DeTable<'_>, source: usize) -> Table {
    table
        .iter()
        .map(|(key, value)| {
            let origin = Origin { source, span: key.span() };
            (key.get_ref().as_ref().to_owned(), Entry { key: origin, node: Node::from_toml(value, source) })
        })
        .collect()
}

/// Lays `over` upon `base`: tables are merged key by key, everything else is replaced.
pub(crate) fn merge(base: &mut Table, over: Table) {
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
