//! Values as they are written into resolved files.

use serde::ser::{Serialize, SerializeMap, Serializer};

/// A value to be written.
#[derive(Clone, Debug, PartialEq)]
pub enum Item {
    /// A text; quantities are texts too.
    Text(String),
    /// A whole number.
    Integer(u64),
    /// A real number.
    Float(f64),
    /// True or false.
    Flag(bool),
    /// Values in order.
    List(Vec<Item>),
    /// Keys with values.
    Keys(Keys),
}

/// Keys with values, in the order in which they are written.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Keys(pub Vec<(String, Item)>);

impl Keys {
    /// Adds a key behind the others.
    pub fn push(&mut self, key: &str, item: Item) {
        self.0.push((key.to_owned(), item));
    }
}

impl From<&str> for Item {
    fn from(text: &str) -> Self {
        Self::Text(text.to_owned())
    }
}

impl From<String> for Item {
    fn from(text: String) -> Self {
        Self::Text(text)
    }
}

impl Serialize for Item {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Text(text) => serializer.serialize_str(text),
            Self::Integer(value) => serializer.serialize_u64(*value),
            Self::Float(value) => serializer.serialize_f64(*value),
            Self::Flag(value) => serializer.serialize_bool(*value),
            Self::List(items) => serializer.collect_seq(items),
            Self::Keys(keys) => keys.serialize(serializer),
        }
    }
}

impl Serialize for Keys {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(self.0.len()))?;
        for (key, item) in &self.0 {
            map.serialize_entry(key, item)?;
        }
        map.end()
    }
}
