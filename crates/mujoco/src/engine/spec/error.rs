//! Why a field cannot be read or set.

use super::super::Kind;
use super::FieldPath;

/// Why a field of a model cannot be read or set. An error changes nothing.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SpecError {
    /// The text is no path.
    #[error(
        "`{text}` names no field: {reason}; examples: `geom.shin.size[0]`, `body.foot.pos.z`, `actuator.#2.gear`, \
             `option.gravity[2]`"
    )]
    Syntax {
        /// The text.
        text: String,
        /// What is wrong.
        reason: String,
    },
    /// Nothing of that kind has fields.
    #[error("there is no kind `{given}`{}; there are: {}", meant(.nearest.as_ref()), .kinds.join(", "))]
    UnknownKind {
        /// What was given.
        given: String,
        /// The kind that is spelt most like it.
        nearest: Option<String>,
        /// All kinds.
        kinds: Vec<String>,
    },
    /// The elements of the kind have no such field.
    #[error("the kind `{kind}` has no field `{given}`{}; it has: {}", meant(.nearest.as_ref()), .fields.join(", "))]
    UnknownField {
        /// The kind.
        kind: Kind,
        /// What was given.
        given: String,
        /// The field that is spelt most like it.
        nearest: Option<String>,
        /// All fields of the kind.
        fields: Vec<String>,
    },
    /// The model has no such element.
    #[error("the model has no {kind} `{given}`{}; {}", meant(.nearest.as_ref()), known(*.kind, .names, *.count))]
    UnknownElement {
        /// The kind.
        kind: Kind,
        /// The name, or `#` and the index, that was given.
        given: String,
        /// The name that is spelt most like it.
        nearest: Option<String>,
        /// The names of the model for elements of the kind; of actuators without a name, the names of what they drive.
        names: Vec<String>,
        /// How many elements of the kind the model has.
        count: usize,
    },
    /// A name that stands for several elements.
    #[error("{count} actuators without a name drive `{given}`; say which by its index, such as `actuator.#{first}`")]
    Ambiguous {
        /// The name of what they drive.
        given: String,
        /// How many they are.
        count: usize,
        /// The index of the first.
        first: usize,
    },
    /// A field has fewer numbers, or several of which none is meant by the name alone.
    #[error("`{field}` of the kind `{kind}` has {len} {}: write `{field}[0]`{}", if *.len == 1 { "number" } else { "numbers" }, last(.field, *.len))]
    Index {
        /// The kind.
        kind: Kind,
        /// The field.
        field: String,
        /// How many numbers it has.
        len: usize,
    },
    /// The value is not within the limits.
    #[error("`{path}` = {value}{} is outside {}{low}, {high}]", after(.unit), if *.above { '(' } else { '[' })]
    Value {
        /// The field.
        path: Box<FieldPath>,
        /// The value, SI.
        value: f64,
        /// The unit's symbol.
        unit: &'static str,
        /// The least value, SI.
        low: f64,
        /// The greatest value, SI.
        high: f64,
        /// Whether a value has to be above the least.
        above: bool,
    },
    /// The model does not use the field; a change would have no effect.
    #[error("`{path}` has no effect: {reason}")]
    Unused {
        /// The field.
        path: Box<FieldPath>,
        /// Why, and what to do instead.
        reason: String,
    },
    /// The model gives no value for the field.
    #[error("`{path}` has no value: {reason}")]
    Unset {
        /// The field.
        path: Box<FieldPath>,
        /// What takes its place.
        reason: String,
    },
    /// Something cannot be added to the model.
    #[error("{0}")]
    Addition(String),
}

fn meant(nearest: Option<&String>) -> String {
    nearest.map(|name| format!("; did you mean `{name}`?")).unwrap_or_default()
}

fn after(symbol: &str) -> String {
    if symbol.is_empty() { String::new() } else { format!(" {symbol}") }
}

fn last(field: &str, len: usize) -> String {
    if len == 1 { String::new() } else { format!(" to `{field}[{}]`", len - 1) }
}

fn known(kind: Kind, names: &[String], count: usize) -> String {
    const MOST: usize = 40;
    match (count, names.len()) {
        (0, _) => format!("it has no {kind}"),
        (1, 0) => format!("it has one {kind} without a name: `{kind}.#0`"),
        (count, 0) => format!("it has {count} without a name: `{kind}.#0` to `{kind}.#{}`", count - 1),
        (_, named) if named > MOST => format!("it has {}, and {} others", names[..MOST].join(", "), named - MOST),
        _ => format!("it has: {}", names.join(", ")),
    }
}
