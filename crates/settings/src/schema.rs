//! Settings as a JSON Schema (draft 7, which every editor reads), by which editors complete and check files.

use hwasp_core::Dimension;
use serde_json::{Map, Value, json};

use crate::field::{Field, Kind};

/// The schema of a table with these settings and no others.
pub fn object_schema(fields: &[Field]) -> Value {
    let properties: Map<String, Value> = fields.iter().map(|field| (field.key.clone(), field.schema())).collect();
    json!({ "type": "object", "additionalProperties": false, "properties": properties })
}

impl Field {
    /// The schema of its value, with meaning, default and limits in words.
    pub fn schema(&self) -> Value {
        let plain = |text: &str| text.replace('`', "");
        let mut about = plain(&self.meaning);
        if !self.limits.is_empty() {
            about = format!("{about} ({})", plain(&self.limits));
        }
        let mut schema = self.kind.schema();
        if let Value::Object(map) = &mut schema {
            map.insert("description".to_owned(), json!(format!("{about}; default {}", plain(&self.default))));
        }
        schema
    }
}

impl Kind {
    fn schema(&self) -> Value {
        match self {
            Self::Number([lo, hi]) => json!({ "type": "number", "minimum": lo, "maximum": hi }),
            // Whole numbers may be written with a point or an exponent.
            Self::Integer([lo, hi]) => {
                json!({ "type": "number", "multipleOf": 1, "minimum": lo, "maximum": hi })
            }
            Self::Flag => json!({ "type": "boolean" }),
            Self::Text(most) => json!({ "type": "string", "maxLength": most }),
            Self::Line(most) => json!({ "type": "string", "maxLength": most, "pattern": r"^[^\u0000-\u001f]*$" }),
            Self::Choice(names) => json!({ "enum": names }),
            Self::Names(names) => json!({ "enum": names }),
            Self::Quantity(Dimension::None, _) => json!({ "type": ["number", "string"] }),
            Self::Quantity(dimension, _) => json!({ "type": "string", "pattern": pattern(&dimension.symbols()) }),
            Self::Optional(kind) => json!({ "anyOf": [kind.schema(), { "const": "none" }] }),
            Self::List { of, length: [least, most], single } => {
                let mut list = json!({ "type": "array", "items": of.schema(), "minItems": least });
                if let (Value::Object(map), true) = (&mut list, *most < usize::MAX) {
                    map.insert("maxItems".to_owned(), json!(most));
                }
                if *single { json!({ "anyOf": [of.schema(), list] }) } else { list }
            }
            Self::AnyQuantity => {
                let units: Vec<&str> = Dimension::ALL.iter().flat_map(|dimension| dimension.symbols()).collect();
                json!({ "type": ["number", "string"], "pattern": pattern(&units) })
            }
            Self::Table(of) => json!({ "type": "object", "additionalProperties": of.schema() }),
            Self::AnyOf(kinds) => json!({ "anyOf": kinds.iter().map(Self::schema).collect::<Vec<_>>() }),
            Self::Open => json!({}),
        }
    }
}

/// A number, and one of these units.
fn pattern(symbols: &[&str]) -> String {
    let units: Vec<String> = symbols.iter().map(|symbol| symbol.replace('·', "[·*]")).collect();
    format!(r"^\s*[-+]?[0-9._]+([eE][-+]?[0-9]+)?\s*({})\s*$", units.join("|"))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `"axtion"` for a place of a design parameter was accepted by editors: a value of several forms had no schema at all.
    #[test]
    fn a_value_of_several_forms_is_one_of_them() {
        let places = Kind::Choice(vec!["graph", "action"]);
        let schema = Kind::AnyOf(vec![Kind::Table(Box::new(places)), Kind::Flag]).schema();
        let table = json!({ "type": "object", "additionalProperties": { "enum": ["graph", "action"] } });
        assert_eq!(schema, json!({ "anyOf": [table, { "type": "boolean" }] }));
    }

    #[test]
    fn a_quantity_names_its_units() {
        let kind = Kind::Quantity(Dimension::Torque, [0.0, 1.0]);
        let expected = r"^\s*[-+]?[0-9._]+([eE][-+]?[0-9]+)?\s*(N[·*]m|N[·*]mm)\s*$";
        assert_eq!(kind.schema(), json!({ "type": "string", "pattern": expected }));
    }
}
