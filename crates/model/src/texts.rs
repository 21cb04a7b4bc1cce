//! Formulas as settings: texts, lists and tables of them, as they are read and written.

use std::fmt::Write;
use std::ops::Range;

use hwasp_expr::{ExprError, LONGEST_TEXT};
use hwasp_settings::text::{shorten, show};
use hwasp_settings::{Item, Keys, Node, Section, Value};

/// The most entries of a list or table of formulas.
const MOST: usize = 1000;
/// The longest name in a table, bytes.
const LONGEST_NAME: usize = 200;

/// Names with formulas, in the order of the names.
pub(crate) type Named = Vec<(String, String)>;

/// A formula: a text, or a number that is one.
pub(crate) fn text(section: &Section<'_>, key: &str, node: &Node) -> Option<String> {
    match &node.value {
        Value::Text(text) if text.len() > LONGEST_TEXT => {
            section.wrong(key, node, &format!("is longer than {LONGEST_TEXT} bytes"), None);
        }
        Value::Text(text) => return Some(text.clone()),
        Value::Integer(value) => return Some(value.to_string()),
        Value::Float(value) if value.is_finite() => return Some(show(*value)),
        Value::Float(_) => section.wrong(key, node, "is not finite", None),
        _ => {
            let hint = "write a formula as a text: \"joint.knee.pos\"".to_owned();
            section.wrong(key, node, "is no formula", Some(hint));
        }
    }
    None
}

/// A list of formulas, or one.
pub(crate) fn list(section: &Section<'_>, key: &str, node: &Node) -> Option<Vec<String>> {
    match &node.value {
        Value::List(items) if items.len() <= MOST => {
            let texts: Vec<_> = items.iter().map(|item| text(section, key, item)).collect();
            texts.into_iter().collect()
        }
        Value::List(_) => {
            section.wrong(key, node, &format!("has more than {MOST} entries"), None);
            None
        }
        _ => text(section, key, node).map(|text| vec![text]),
    }
}

/// A table of formulas.
pub(crate) fn named(section: &Section<'_>, key: &str, node: &Node) -> Option<Named> {
    let Value::Table(table) = &node.value else {
        let hint = format!("write names with formulas below [{}]", section.path(key));
        section.wrong(key, node, "is no table", Some(hint));
        return None;
    };
    if table.len() > MOST {
        section.wrong(key, node, &format!("has more than {MOST} entries"), None);
        return None;
    }
    // What is wrong with one entry hides no fault of the others.
    let mut found = Vec::new();
    for (name, entry) in table {
        let inner = format!("{key}.{}", shorten(name, 60));
        if name.is_empty() || name.len() > LONGEST_NAME {
            let message = format!("{} has a name of {} bytes", section.path(&inner), name.len());
            section.fault_at(&entry.key, &inner, message, Some(format!("use 1 to {LONGEST_NAME}")));
            continue;
        }
        if let Value::Table(deeper) = &entry.node.value {
            // `joint.knee = ...` without quotes is a table in a table.
            let mut whole = name.clone();
            let mut at = Some(deeper);
            while let Some((part, below)) = at.and_then(|table| table.iter().next()) {
                whole = format!("{whole}.{part}");
                at = if let Value::Table(table) = &below.node.value { Some(table) } else { None };
            }
            let message = format!("{} is a table, where a name with its formula belongs", section.path(&inner));
            let hint = format!("a name with dots stands in quotes: \"{}\" = \"…\"", shorten(&whole, 60));
            section.fault_at(&entry.key, &inner, message, Some(hint));
            continue;
        }
        found.extend(text(section, &inner, &entry.node).map(|text| (name.clone(), text)));
    }
    Some(found)
}

/// As it is written; an empty table is not.
pub(crate) fn named_item(named: &Named) -> Option<Item> {
    let keys = named.iter().map(|(name, text)| (name.clone(), Item::from(text.as_str()))).collect();
    (!named.is_empty()).then_some(Item::Keys(Keys(keys)))
}

/// As it is written; an empty list is not.
pub(crate) fn list_item(texts: &[String]) -> Option<Item> {
    (!texts.is_empty()).then(|| Item::List(texts.iter().map(|text| Item::from(text.as_str())).collect()))
}

/// The node at the end of some keys below a section; list items are counted.
pub(crate) fn node_at<'r>(section: &Section<'r>, keys: &[&str]) -> Option<&'r Node> {
    let (first, rest) = keys.split_first()?;
    let mut node = section.node(first)?;
    for key in rest {
        node = match &node.value {
            Value::Table(table) => &table.get(*key)?.node,
            Value::List(items) => items.get(key.parse::<usize>().ok()?)?,
            // One formula in the place of a list.
            _ if *key == "0" => node,
            _ => return None,
        };
    }
    Some(node)
}

/// Keys as a message has them, `observe[0]`.
fn shown(keys: &[&str]) -> String {
    let mut text = String::new();
    for (i, key) in keys.iter().enumerate() {
        if i > 0 && key.parse::<usize>().is_ok() {
            let _ = write!(text, "[{key}]");
        } else {
            let dot = if i > 0 { "." } else { "" };
            let _ = write!(text, "{dot}{}", shorten(key, 60));
        }
    }
    text
}

/// Tells a fault of a formula at its place.
pub(crate) fn tell(section: &Section<'_>, keys: &[&str], offset: usize, error: &ExprError) {
    let part = error.span.start + offset..error.span.end + offset;
    tell_at(section, keys, &part, &error.message, error.hint.clone());
}

/// Tells a fault of a part of the text at the end of some keys.
pub(crate) fn tell_at(section: &Section<'_>, keys: &[&str], part: &Range<usize>, message: &str, hint: Option<String>) {
    let key = shown(keys);
    match node_at(section, keys) {
        Some(node) => section.wrong_within(&key, node, part, format!("{}: {message}", section.path(&key)), hint),
        None => section.clash(&key, format!("{}: {message}", section.path(&key)), &hint.unwrap_or_default()),
    }
}
