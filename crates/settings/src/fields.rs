//! The one text that a struct of settings is read, written and described by.

use std::fmt::Display;
use std::ops::RangeInclusive;
use std::path::PathBuf;

use hwasp_core::Dimension;

use crate::choice::Choice;
use crate::field::{Field, Kind, readable};
use crate::item::{Item, Keys};
use crate::section::Section;
use crate::text::show;
use crate::tree::{Node, Value};
use crate::values::with_unit;

mod lists;

/// Settings that a file may have.
pub trait Settings {
    /// Goes over the fields once, in the order in which they are written. What a field holds before is its default.
    fn fields(&mut self, fields: &mut Fields<'_, '_>);
}

/// No settings.
impl Settings for () {
    fn fields(&mut self, _: &mut Fields<'_, '_>) {}
}

/// What [`Settings::fields`] goes over its fields for.
pub struct Fields<'f, 'r> {
    purpose: Purpose<'f, 'r>,
    default: Option<String>,
    limits: Option<String>,
    kind: Option<Kind>,
}

enum Purpose<'f, 'r> {
    Read(&'f mut Section<'r>),
    Write(&'f mut Keys),
    Describe(&'f mut Vec<Field>),
}

/// Reads settings from a table. What is absent or wrong keeps its default; what is wrong is told by the table's reader.
pub fn read(settings: &mut (impl Settings + ?Sized), section: &mut Section<'_>) {
    settings.fields(&mut Fields::new(Purpose::Read(section)));
}

/// The values as a file has them, in order: what is read back gives the same.
pub fn written(settings: &mut (impl Settings + ?Sized)) -> Keys {
    let mut keys = Keys::default();
    settings.fields(&mut Fields::new(Purpose::Write(&mut keys)));
    keys
}

/// What there is to set, in order.
pub fn described(settings: &mut (impl Settings + ?Sized)) -> Vec<Field> {
    let mut fields = Vec::new();
    settings.fields(&mut Fields::new(Purpose::Describe(&mut fields)));
    fields
}

impl<'f, 'r> Fields<'f, 'r> {
    fn new(purpose: Purpose<'f, 'r>) -> Self {
        Self { purpose, default: None, limits: None, kind: None }
    }

    /// Says in words what the default of the next field is, where it depends on other settings.
    pub fn default(&mut self, words: impl Into<String>) -> &mut Self {
        self.default = Some(words.into());
        self
    }

    /// Says in words what the limits of the next field are.
    pub fn limits(&mut self, words: impl Into<String>) -> &mut Self {
        self.limits = Some(words.into());
        self
    }

    /// Says what the value of the next field may be, where it is an [`open`](Self::open) one.
    pub fn kind(&mut self, kind: Kind) -> &mut Self {
        self.kind = Some(kind);
        self
    }

    /// A real number.
    pub fn number(&mut self, key: &str, value: &mut f64, limits: RangeInclusive<f64>, meaning: &str) {
        let kind = || Kind::Number(ends(&limits));
        let exchanged = *value;
        self.field(key, meaning, kind, &show(exchanged), Item::Float(exchanged), |section| {
            *value = section.number(key, exchanged, limits.clone());
        });
    }

    /// A real number of which 0 means none.
    pub fn positive(&mut self, key: &str, value: &mut Option<f64>, most: f64, meaning: &str) {
        let mut number = value.unwrap_or(0.0);
        self.number(key, &mut number, 0.0..=most, meaning);
        *value = (number > 0.0).then_some(number);
    }

    /// A real number or "none".
    pub fn optional_number(&mut self, key: &str, value: &mut Option<f64>, limits: RangeInclusive<f64>, meaning: &str) {
        let kind = || Kind::Optional(Box::new(Kind::Number(ends(&limits))));
        let item = value.map_or(Item::from("none"), Item::Float);
        self.field(key, meaning, kind, &shown(&item), item.clone(), |section| {
            *value = section.optional_number(key, limits.clone());
        });
    }

    /// A whole number.
    pub fn integer(&mut self, key: &str, value: &mut u64, limits: RangeInclusive<u64>, meaning: &str) {
        let kind = || Kind::Integer([*limits.start(), *limits.end()]);
        let exchanged = *value;
        self.field(key, meaning, kind, &exchanged.to_string(), Item::Integer(exchanged), |section| {
            *value = section.integer(key, exchanged, limits.clone());
        });
    }

    /// A count of things.
    pub fn count(&mut self, key: &str, value: &mut usize, limits: RangeInclusive<usize>, meaning: &str) {
        let mut count = *value as u64;
        self.integer(key, &mut count, *limits.start() as u64..=*limits.end() as u64, meaning);
        *value = count as usize;
    }

    /// True or false.
    pub fn flag(&mut self, key: &str, value: &mut bool, meaning: &str) {
        let exchanged = *value;
        self.field(
            key,
            meaning,
            || Kind::Flag,
            &exchanged.to_string(),
            Item::Flag(exchanged),
            |section| {
                *value = section.flag(key, exchanged);
            },
        );
    }

    /// One line of text.
    pub fn line(&mut self, key: &str, value: &mut String, most: usize, meaning: &str) {
        self.text_of(key, value, (most, false), meaning);
    }

    /// A text of one line or several.
    pub fn text(&mut self, key: &str, value: &mut String, most: usize, meaning: &str) {
        self.text_of(key, value, (most, true), meaning);
    }

    fn text_of(&mut self, key: &str, value: &mut String, (most, lines): (usize, bool), meaning: &str) {
        let item = Item::Text(value.clone());
        self.field(
            key,
            meaning,
            || if lines { Kind::Text(most) } else { Kind::Line(most) },
            &shown(&item),
            item.clone(),
            |section| {
                if let Some(text) = section.text(key, most, lines) {
                    *value = text;
                }
            },
        );
    }

    /// The path of a file, as it is written: relative to whatever the owner of the setting says.
    pub fn path(&mut self, key: &str, value: &mut PathBuf, meaning: &str) {
        let mut text = value.to_string_lossy().into_owned();
        self.line(key, &mut text, 4096, meaning);
        *value = text.into();
    }

    /// One of some names.
    pub fn choice<T: Choice>(&mut self, key: &str, value: &mut T, meaning: &str) {
        let kind = || Kind::Choice(names::<T>());
        let item = Item::from(value.name());
        self.field(key, meaning, kind, &shown(&item), item.clone(), |section| {
            *value = section.choice(key, T::ALL).unwrap_or(*value);
        });
    }

    /// A quantity such as `"3 N"`; value and limits are in SI.
    pub fn quantity(
        &mut self,
        key: &str,
        value: &mut f64,
        dimension: Dimension,
        limits: RangeInclusive<f64>,
        meaning: &str,
    ) {
        let kind = || Kind::Quantity(dimension, ends(&limits));
        let (exchanged, item) = (*value, quantity(*value, dimension));
        self.field(key, meaning, kind, &quoted(exchanged, dimension, &limits), item, |section| {
            *value = section.quantity(key, dimension, exchanged, &limits);
        });
    }

    /// A quantity or "none"; `example` is what hints show.
    pub fn optional_quantity(
        &mut self,
        key: &str,
        value: &mut Option<f64>,
        (dimension, example): (Dimension, f64),
        limits: RangeInclusive<f64>,
        meaning: &str,
    ) {
        let kind = || Kind::Optional(Box::new(Kind::Quantity(dimension, ends(&limits))));
        let item = value.map_or(Item::from("none"), |value| quantity(value, dimension));
        let default = value.map_or("\"none\"".to_owned(), |value| quoted(value, dimension, &limits));
        self.field(key, meaning, kind, &default, item, |section| {
            if section.has(key) {
                *value = section.optional_quantity(key, dimension, example, &limits);
            }
        });
    }

    /// A value of a form of its own. `read` is given the value where there is one; an `item` of none is not written.
    pub fn open(&mut self, key: &str, meaning: &str, item: Option<Item>, read: impl FnOnce(&Section<'r>, &'r Node)) {
        self.optional_field(
            key,
            meaning,
            || Kind::Open,
            item,
            |section| {
                if let Some(node) = section.take(key) {
                    read(section, node);
                }
            },
        );
    }

    /// Called when all fields before were read, and in no other case: for settings that only mean something together.
    pub fn finally(&mut self, read: impl FnOnce(&Section<'r>)) {
        if let Purpose::Read(section) = &mut self.purpose {
            read(section);
        }
    }

    /// Holds values against each other while they are read: unless `holds`, the fault is told at the key. To be asked only
    /// of values that were sound by themselves ([`sound`](Self::sound)).
    pub fn check(&mut self, key: &str, holds: bool, fault: impl FnOnce() -> (String, String)) {
        if let Purpose::Read(section) = &mut self.purpose
            && !holds
        {
            let (message, hint) = fault();
            section.clash(key, message, &hint);
        }
    }

    /// Whether these keys of the table at hand have the values that were asked for.
    pub fn sound(&self, keys: &[&str]) -> bool {
        match &self.purpose {
            Purpose::Read(section) => section.sound(keys),
            _ => true,
        }
    }

    /// Whether values are being read: defaults that depend on what was read before are set then.
    pub fn reads(&self) -> bool {
        matches!(self.purpose, Purpose::Read(_))
    }

    /// Whether a file sets this key.
    pub fn is_set(&self, key: &str) -> bool {
        matches!(&self.purpose, Purpose::Read(section) if section.has(key))
    }

    fn field(
        &mut self,
        key: &str,
        meaning: &str,
        kind: impl FnOnce() -> Kind,
        default: &str,
        item: Item,
        read: impl FnOnce(&mut Section<'r>),
    ) {
        let (words, limits, given) = (self.default.take(), self.limits.take(), self.kind.take());
        match &mut self.purpose {
            Purpose::Read(section) => read(section),
            Purpose::Write(keys) => keys.push(key, item),
            Purpose::Describe(fields) => {
                let kind = given.unwrap_or_else(kind);
                fields.push(Field {
                    key: key.to_owned(),
                    default: words.unwrap_or_else(|| default.to_owned()),
                    limits: limits.unwrap_or_else(|| kind.limits()),
                    kind,
                    meaning: meaning.to_owned(),
                });
            }
        }
    }

    fn optional_field(
        &mut self,
        key: &str,
        meaning: &str,
        kind: impl FnOnce() -> Kind,
        item: Option<Item>,
        read: impl FnOnce(&mut Section<'r>),
    ) {
        match item {
            None if matches!(self.purpose, Purpose::Write(_)) => {
                (self.default, self.limits, self.kind) = (None, None, None);
            }
            item => {
                let default = item.as_ref().map_or("\"none\"".to_owned(), shown);
                self.field(key, meaning, kind, &default, item.unwrap_or(Item::from("none")), read);
            }
        }
    }
}

fn ends(limits: &RangeInclusive<f64>) -> [f64; 2] {
    [*limits.start(), *limits.end()]
}

fn names<T: Choice>() -> Vec<&'static str> {
    T::ALL.iter().map(|(name, _)| *name).collect()
}

/// A quantity as the reference shows it, in the unit of its limits.
fn quoted(value: f64, dimension: Dimension, limits: &RangeInclusive<f64>) -> String {
    let unit = readable(dimension, *limits.end());
    match unit.symbol {
        "" => unit.short(value),
        symbol => format!("\"{} {symbol}\"", unit.short(value)),
    }
}

/// A quantity as it is written; a pure number is no text.
fn quantity(value: f64, dimension: Dimension) -> Item {
    match dimension {
        Dimension::None => Item::Float(value),
        dimension => Item::Text(with_unit(value, dimension)),
    }
}

/// An item as a reference shows it.
fn shown(item: &Item) -> String {
    match item {
        Item::Text(text) => format!("\"{text}\""),
        Item::Integer(value) => value.to_string(),
        Item::Float(value) => show(*value),
        Item::Flag(value) => value.to_string(),
        Item::List(items) => format!("[{}]", items.iter().map(shown).collect::<Vec<_>>().join(", ")),
        Item::Keys(keys) => {
            let of = |(key, item): &(String, Item)| format!("{key} = {}", shown(item));
            format!("{{ {} }}", keys.0.iter().map(of).collect::<Vec<_>>().join(", "))
        }
    }
}

impl Display for Item {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&shown(self))
    }
}

impl Node {
    /// The text, where it is one.
    pub fn text(&self) -> Option<&str> {
        if let Value::Text(text) = &self.value { Some(text) } else { None }
    }
}
