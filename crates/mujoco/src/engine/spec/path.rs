//! Names of numbers of a model: `geom.shin.size[0]`.

use std::fmt;
use std::str::FromStr;

use hwasp_settings::nearest;

use super::super::Kind;
use super::SpecError;
use super::fields::{Field, KINDS, fields};

/// The name of one number of a model: a kind, an element, a field and an index.
///
/// ```text
/// geom.shin.size[0]        body.foot.pos.z         joint.knee.stiffness
/// geom."left shin".size[1] actuator.#2.gear        option.gravity[2]
/// ```
///
/// Fields are called as in MJCF. Places, directions and accelerations have the components `x`, `y` and `z` beside their
/// indices, quaternions `w` too. Where the first number is the usual one (`gear`, `friction`, `stiffness`), the name alone
/// means it. Names that would be misread stand in quotes, with `\` before `"` and `\`. `#` and a number count the elements
/// of the kind in the order of the compiled model. An actuator without a name goes by the name of what it drives.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct FieldPath {
    kind: Kind,
    element: Element,
    /// Its place in the table of the kind.
    field: usize,
    index: usize,
}

/// Which element of a kind.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub enum Element {
    /// The one of this name.
    Name(String),
    /// The one of this index in the compiled model.
    Index(usize),
    /// The only one: the model's options.
    Only,
}

impl FieldPath {
    /// The kind of the element.
    pub fn kind(&self) -> Kind {
        self.kind
    }

    /// The element.
    pub fn element(&self) -> &Element {
        &self.element
    }

    /// The name of the field, as MJCF has it.
    pub fn field(&self) -> &'static str {
        self.entry().name
    }

    /// The index of the number in the field.
    pub fn index(&self) -> usize {
        self.index
    }

    /// The path of a number by the place of its element; the kind has the field.
    pub(super) fn of(kind: Kind, place: usize, field: &str, index: usize) -> Self {
        let element = if kind == Kind::Options { Element::Only } else { Element::Index(place) };
        let field = fields(kind).iter().position(|known| known.name == field).expect("the kind has the field");
        Self { kind, element, field, index }
    }

    /// The same field with another index, which it has.
    pub(super) fn at(&self, index: usize) -> Self {
        Self { index, ..self.clone() }
    }

    /// The field in the table.
    pub(super) fn entry(&self) -> &'static Field {
        &fields(self.kind)[self.field]
    }

    /// Kind and field without an index, for messages.
    pub(super) fn without_index(&self) -> String {
        match &self.element {
            Element::Only => format!("{}.{}", self.kind, self.field()),
            element => format!("{}.{element}.{}", self.kind, self.field()),
        }
    }
}

impl FromStr for FieldPath {
    type Err = SpecError;

    fn from_str(text: &str) -> Result<Self, SpecError> {
        let syntax = |reason: &str| SpecError::Syntax { text: text.to_owned(), reason: reason.to_owned() };
        let (kind, rest) = text.split_once('.').ok_or_else(|| syntax("it has no `.`"))?;
        let kind = self::kind(kind)?;
        if kind == Kind::Options {
            let (field, index) = tail(kind, rest)?.ok_or_else(|| syntax("the field is not closed by `]`"))?;
            return Ok(Self { kind, element: Element::Only, field, index });
        }
        let (element, rest) = if let Some(quoted) = rest.strip_prefix('"') {
            let (name, after) = unquoted(quoted).ok_or_else(|| syntax("a quote is not closed"))?;
            let rest = after.strip_prefix('.').ok_or_else(|| syntax("no field follows the name"))?;
            (Element::Name(name), rest)
        } else {
            let at = field_start(kind, rest).ok_or_else(|| syntax("no field follows the name"))?;
            let name = &rest[..at - 1];
            let element = match name.strip_prefix('#') {
                Some(number) => Element::Index(number.parse().map_err(|_| syntax("`#` is not followed by an index"))?),
                None => Element::Name(name.to_owned()),
            };
            (element, &rest[at..])
        };
        if element == Element::Name(String::new()) {
            return Err(syntax("the name is empty; elements without a name go by their index, `#0`"));
        }
        let (field, index) = tail(kind, rest)?.ok_or_else(|| syntax("the index is no number in `[]`"))?;
        Ok(Self { kind, element, field, index })
    }
}

fn kind(given: &str) -> Result<Kind, SpecError> {
    KINDS.into_iter().find(|kind| kind.to_string() == given).ok_or_else(|| {
        let kinds: Vec<String> = KINDS.iter().map(ToString::to_string).collect();
        let nearest = nearest(given, kinds.iter().map(String::as_str)).map(str::to_owned);
        SpecError::UnknownKind { given: given.to_owned(), nearest, kinds }
    })
}

/// Where the field begins after a name without quotes, which may have dots itself: after the last dot, or the one before if
/// the last part is a component.
fn field_start(kind: Kind, rest: &str) -> Option<usize> {
    let last = rest.rfind('.')?;
    let before = rest[..last].rfind('.').map(|dot| dot + 1);
    let component = before.filter(|&start| {
        let field = fields(kind).iter().find(|field| field.name == &rest[start..last]);
        field.is_some_and(|field| component(field, &rest[last + 1..]).is_some())
    });
    Some(component.unwrap_or(last + 1))
}

fn component(field: &Field, letter: &str) -> Option<usize> {
    if letter.len() == 1 { field.letters.find(letter) } else { None }
}

/// The field and the index of `size[0]`, `pos.z` or `gear`. Nothing if brackets are wrong.
fn tail(kind: Kind, text: &str) -> Result<Option<(usize, usize)>, SpecError> {
    let name = text.split(['.', '[']).next().unwrap_or_default();
    let known = fields(kind);
    let place = known.iter().position(|field| field.name == name).ok_or_else(|| SpecError::UnknownField {
        kind,
        given: name.to_owned(),
        nearest: nearest(name, known.iter().map(|field| field.name)).map(str::to_owned),
        fields: known.iter().map(|field| field.name.to_owned()).collect(),
    })?;
    let field = &known[place];
    let wrong = SpecError::Index { kind, field: field.name.to_owned(), len: field.len };
    let after = &text[name.len()..];
    let index = if after.is_empty() {
        if !field.lone {
            return Err(wrong);
        }
        0
    } else if let Some(letter) = after.strip_prefix('.') {
        component(field, letter).ok_or(wrong)?
    } else {
        let digits = after.strip_prefix('[').and_then(|after| after.strip_suffix(']'));
        let Some(index) = digits.and_then(|digits| digits.parse::<usize>().ok()) else { return Ok(None) };
        if index >= field.len {
            return Err(wrong);
        }
        index
    };
    Ok(Some((place, index)))
}

/// The text up to the quote, and what follows.
fn unquoted(text: &str) -> Option<(String, &str)> {
    let mut name = String::new();
    let mut characters = text.char_indices();
    while let Some((at, character)) = characters.next() {
        match character {
            '"' => return Some((name, &text[at + 1..])),
            '\\' => name.push(characters.next()?.1),
            other => name.push(other),
        }
    }
    None
}

impl fmt::Display for Element {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Only => Ok(()),
            Self::Index(index) => write!(f, "#{index}"),
            Self::Name(name) => {
                let plain = |c: char| c.is_alphanumeric() || matches!(c, '_' | '-' | '/' | ':');
                if !name.is_empty() && name.chars().all(plain) {
                    f.write_str(name)
                } else {
                    write!(f, "\"{}\"", name.replace('\\', "\\\\").replace('"', "\\\""))
                }
            }
        }
    }
}

impl fmt::Display for FieldPath {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.without_index())?;
        if self.entry().len > 1 && !(self.entry().lone && self.index == 0) {
            write!(f, "[{}]", self.index)?;
        }
        Ok(())
    }
}
