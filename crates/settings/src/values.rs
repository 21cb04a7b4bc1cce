//! The kinds of values a [`Section`] can be asked for. Each returns the default where the value is absent or wrong.

use std::ops::RangeInclusive;

use hwasp_core::{Dimension, UnitError, parse_quantity};

use crate::section::Section;
use crate::suggest::{listed, nearest};
use crate::text::{is_unprintable, show};
use crate::tree::{Node, Value};

/// The greatest integer up to which every f64 is exact, 2^53.
const EXACT: f64 = 9_007_199_254_740_992.0;
/// Beyond all limits of whole numbers, 2^63.
const BEYOND: f64 = 9_223_372_036_854_775_808.0;

impl Section<'_> {
    /// A real number.
    pub fn number(&mut self, key: &str, default: f64, range: RangeInclusive<f64>) -> f64 {
        let Some(node) = self.take(key) else { return default };
        let hint = format!("the default is {}", show(default));
        self.checked_number(key, node, &range, hint).unwrap_or(default)
    }

    /// A real number, or none where the key is absent or "none".
    pub fn optional_number(&mut self, key: &str, range: RangeInclusive<f64>) -> Option<f64> {
        let node = self.take(key).filter(|node| !is_none(node))?;
        self.checked_number_of(key, node, &range)
    }

    fn checked_number(&self, key: &str, node: &Node, range: &RangeInclusive<f64>, hint: String) -> Option<f64> {
        let limits = format!("[{}, {}]", show(*range.start()), show(*range.end()));
        match node.number() {
            None => self.wrong(key, node, &format!("is not a number in {limits}"), Some(hint)),
            Some(value) if range.contains(&value) => return Some(value),
            Some(_) => self.wrong(key, node, &format!("is outside {limits}"), Some(hint)),
        }
        None
    }

    /// A real number at hand, or none where it is wrong: of a key that may say "none".
    pub fn checked_number_of(&self, key: &str, node: &Node, range: &RangeInclusive<f64>) -> Option<f64> {
        self.checked_number(key, node, range, "leave it out, or write \"none\", to do without".into())
    }

    /// A whole number; `4e6` is one too.
    pub fn integer(&mut self, key: &str, default: u64, range: RangeInclusive<u64>) -> u64 {
        let Some(node) = self.take(key) else { return default };
        let hint = Some(format!("the default is {default}"));
        let limits = format!("[{}, {}]", range.start(), range.end());
        match whole(node) {
            None => self.wrong(key, node, &format!("is not a whole number in {limits}"), hint),
            Some(value) => match u64::try_from(value) {
                Ok(value) if range.contains(&value) => return value,
                _ => self.wrong(key, node, &format!("is outside {limits}"), hint),
            },
        }
        default
    }

    /// A count of things.
    pub fn count(&mut self, key: &str, default: usize, range: RangeInclusive<usize>) -> usize {
        self.integer(key, default as u64, *range.start() as u64..=*range.end() as u64) as usize
    }

    /// True or false.
    pub fn flag(&mut self, key: &str, default: bool) -> bool {
        let Some(node) = self.take(key) else { return default };
        if let Value::Flag(value) = node.value {
            return value;
        }
        self.wrong(key, node, "is neither true nor false", Some(format!("the default is {default}")));
        default
    }

    /// A text of at most `most` characters, of one line or with `lines` of several.
    pub fn text(&mut self, key: &str, most: usize, lines: bool) -> Option<String> {
        let node = self.take(key)?;
        match &node.value {
            Value::Text(text) if text.chars().nth(most).is_some() => {
                self.wrong(key, node, &format!("is longer than {most} characters"), None);
            }
            Value::Text(text) if text.chars().any(|c| is_unprintable(c) && !(lines && c == '\n')) => {
                let hint = if lines { "leave them out; lines are parted by \\n" } else { "leave them out" }.to_owned();
                self.wrong(key, node, "has characters that cannot be printed", Some(hint));
            }
            Value::Text(text) => return Some(text.clone()),
            _ => self.wrong(key, node, "is not a text", Some("put it into double quotes".into())),
        }
        None
    }

    /// One of some names; none where the key is absent or wrong.
    pub fn choice<T: Copy>(&mut self, key: &str, choices: &[(&str, T)]) -> Option<T> {
        let node = self.take(key)?;
        self.chosen(key, node, choices)
    }

    /// The same for a value at hand.
    pub fn chosen<T: Copy>(&self, key: &str, node: &Node, choices: &[(&str, T)]) -> Option<T> {
        let names = || choices.iter().map(|(name, _)| *name);
        let typed = if let Value::Text(text) = &node.value { text.as_str() } else { "" };
        if let Some((_, choice)) = choices.iter().find(|(name, _)| *name == typed) {
            return Some(*choice);
        }
        let hint = nearest(typed, names()).map(|near| format!("did you mean \"{near}\"?"));
        self.wrong(key, node, &format!("is none of {}", listed(names())), hint);
        None
    }

    /// A quantity such as `"3 N"`; the default, the range and the result are in SI.
    pub fn quantity(&mut self, key: &str, dimension: Dimension, default: f64, range: &RangeInclusive<f64>) -> f64 {
        let Some(node) = self.take(key) else { return default };
        self.checked_quantity(key, node, dimension, default, range).unwrap_or(default)
    }

    /// A quantity, or none where the key is absent or "none".
    pub fn optional_quantity(
        &mut self,
        key: &str,
        dimension: Dimension,
        example: f64,
        range: &RangeInclusive<f64>,
    ) -> Option<f64> {
        let node = self.take(key).filter(|node| !is_none(node))?;
        self.checked_quantity(key, node, dimension, example, range)
    }

    /// A quantity at hand, in SI, if it is one of the dimension and inside of the range.
    pub fn checked_quantity(
        &self,
        key: &str,
        node: &Node,
        dimension: Dimension,
        example: f64,
        range: &RangeInclusive<f64>,
    ) -> Option<f64> {
        let example = with_unit(example, dimension);
        let units = dimension.symbols().join(", ");
        let hint = Some(match dimension {
            Dimension::None => "it is a pure number".to_owned(),
            _ => format!("write it like \"{example}\", in one of the units {units}"),
        });
        let value = match &node.value {
            Value::Text(text) => match parse_quantity(text, dimension) {
                Ok(value) => value,
                Err(error) => {
                    let rest = match error {
                        _ if text.contains(',') => "has a comma, where numbers have a point",
                        UnitError::Number { .. } => "does not begin with a number",
                        UnitError::Unknown { .. } => "has a unit that is not known",
                        UnitError::Dimension { .. } => "has a unit that measures something else",
                        UnitError::Missing { .. } => "names no unit",
                    };
                    self.wrong(key, node, rest, hint);
                    return None;
                }
            },
            _ => match node.number() {
                Some(value) if dimension == Dimension::None => value,
                Some(_) => {
                    self.wrong(key, node, "names no unit", hint);
                    return None;
                }
                None => {
                    self.wrong(key, node, "is not a quantity", hint);
                    return None;
                }
            },
        };
        if range.contains(&value) {
            return Some(value);
        }
        let (lo, hi) = (with_unit(*range.start(), dimension), with_unit(*range.end(), dimension));
        self.wrong(key, node, &format!("is outside [{lo}, {hi}]"), None);
        None
    }

    /// As many real numbers as the default has.
    pub fn numbers(&mut self, key: &str, default: &[f64], range: &RangeInclusive<f64>) -> Vec<f64> {
        let (length, default) = (default.len(), default.to_vec());
        let Some(node) = self.take(key) else { return default };
        let hint = || Some(format!("the default is {}", show_list(&default)));
        match &node.value {
            Value::List(items) if items.len() == length => {
                let checked =
                    items.iter().map(|item| self.checked_number(key, item, range, hint().unwrap_or_default()));
                // All items are looked at before the first wrong one ends it.
                checked.collect::<Vec<_>>().into_iter().collect::<Option<_>>().unwrap_or(default)
            }
            Value::List(_) => {
                self.wrong(key, node, &format!("is not of length {length}: one number per observation"), hint());
                default
            }
            _ => {
                self.wrong(key, node, "is not a list of numbers", hint());
                default
            }
        }
    }

    /// A real number for each of so many commands, or one for all; none where the key is absent, "none" or wrong.
    pub fn each(&mut self, key: &str, length: usize, range: &RangeInclusive<f64>) -> Option<Vec<f64>> {
        let node = self.take(key).filter(|node| !is_none(node))?;
        let hint = || match length {
            1 => "one number: the task has one command".to_owned(),
            _ => format!("one number, or a list of one for each of the {length} commands"),
        };
        match &node.value {
            Value::List(items) if items.len() == length => {
                let checked = items.iter().map(|item| self.checked_number(key, item, range, hint()));
                checked.collect::<Vec<_>>().into_iter().collect()
            }
            Value::List(_) => {
                self.wrong(key, node, &format!("is not of length {length}"), Some(hint()));
                None
            }
            _ => self.checked_number(key, node, range, hint()).map(|value| vec![value; length]),
        }
    }

    /// Two fractions of training, in order.
    pub fn fractions(&mut self, key: &str, default: [f64; 2]) -> [f64; 2] {
        let Some(node) = self.take(key) else { return default };
        if let Value::List(items) = &node.value
            && let [Some(begin), Some(end)] = items.iter().map(Node::number).collect::<Vec<_>>()[..]
            && 0.0 <= begin
            && begin <= end
            && end <= 1.0
        {
            return [begin, end];
        }
        let rest = "is not a pair [begin, end] with 0 <= begin <= end <= 1";
        self.wrong(key, node, rest, Some(format!("fractions of training; the default is {default:?}")));
        default
    }

    /// Sizes of layers.
    pub fn counts(&mut self, key: &str, default: &[usize], most: usize, range: &RangeInclusive<usize>) -> Vec<usize> {
        let Some(node) = self.take(key) else { return default.to_vec() };
        let hint = || Some(format!("the default is {default:?}"));
        match &node.value {
            Value::List(items) if items.len() <= most => {
                let limits = format!("[{}, {}]", range.start(), range.end());
                let mut counts = Vec::with_capacity(items.len());
                for item in items {
                    match whole(item).map(usize::try_from) {
                        Some(Ok(count)) if range.contains(&count) => counts.push(count),
                        None => self.wrong(key, item, &format!("is not a whole number in {limits}"), hint()),
                        Some(_) => self.wrong(key, item, &format!("is outside {limits}"), hint()),
                    }
                }
                counts
            }
            Value::List(items) => {
                self.wrong(key, node, &format!("has {} items, but at most {most} are possible", items.len()), hint());
                default.to_vec()
            }
            _ => {
                self.wrong(key, node, "is not a list of whole numbers", hint());
                default.to_vec()
            }
        }
    }

    /// Names from 1 to `most`; none where the key is absent or wrong.
    pub fn choices<T: Copy>(&mut self, key: &str, choices: &[(&str, T)], most: usize) -> Option<Vec<T>> {
        let node = self.take(key)?;
        let example = || {
            let names: Vec<String> = choices.iter().take(2).map(|(name, _)| format!("\"{name}\"")).collect();
            Some(format!("write it like [{}]", names.join(", ")))
        };
        let Value::List(items) = &node.value else {
            self.wrong(key, node, "is not a list", example());
            return None;
        };
        if items.len() > most {
            let rest = format!("has {} items, but at most {most} are possible", items.len());
            self.wrong(key, node, &rest, Some("one that stands there twice is drawn twice as often".to_owned()));
            return None;
        }
        if items.is_empty() {
            self.wrong(key, node, "is empty", Some("leave it out for the default".into()));
            return None;
        }
        let chosen: Vec<T> = items
            .iter()
            .enumerate()
            .filter_map(|(i, item)| self.chosen(&format!("{key}[{i}]"), item, choices))
            .collect();
        (chosen.len() == items.len()).then_some(chosen)
    }

    /// A pair of quantities, the smaller one first, or one for both; all in SI.
    pub fn span(
        &mut self,
        key: &str,
        dimension: Dimension,
        default: [f64; 2],
        range: &RangeInclusive<f64>,
    ) -> [f64; 2] {
        let Some(node) = self.take(key) else { return default };
        self.span_of(key, node, dimension, default, range)
    }

    /// The same of a value at hand.
    pub fn span_of(
        &self,
        key: &str,
        node: &Node,
        dimension: Dimension,
        default: [f64; 2],
        range: &RangeInclusive<f64>,
    ) -> [f64; 2] {
        let ends = match &node.value {
            Value::List(items) => &items[..],
            _ => std::slice::from_ref(node),
        };
        let hint = || {
            let shown = default.map(|end| match dimension {
                Dimension::None => show(end),
                dimension => format!("\"{}\"", with_unit(end, dimension)),
            });
            Some(format!("write [from, to], such as [{}]", shown.join(", ")))
        };
        if !(1..=2).contains(&ends.len()) {
            self.wrong(key, node, "is not a pair", hint());
            return default;
        }
        let read: Vec<f64> =
            ends.iter().filter_map(|end| self.checked_quantity(key, end, dimension, default[0], range)).collect();
        if read.len() < ends.len() {
            return default;
        }
        let (from, to) = (read[0], read[read.len() - 1]);
        if from > to {
            self.wrong(key, node, "begins above its end", hint());
            return default;
        }
        [from, to]
    }
}

/// Whether a value says that there is none.
fn is_none(node: &Node) -> bool {
    matches!(&node.value, Value::Text(text) if text == "none")
}

/// A whole number, also where it is written as a real one.
fn whole(node: &Node) -> Option<i128> {
    match node.value {
        Value::Integer(value) => Some(value.into()),
        // Beyond 64 bits it is outside of any limits; how far does not matter.
        Value::Huge(ref digits) => Some(if digits.starts_with('-') { i128::MIN } else { i128::MAX }),
        // Between the two it may not be the number that was meant.
        Value::Float(value) if value.fract() == 0.0 && (value.abs() <= EXACT || value.abs() >= BEYOND) => {
            Some(value as i128)
        }
        _ => None,
    }
}

/// An SI value with its unit, for messages and files: both read it back to the same bits.
pub fn with_unit(value: f64, dimension: Dimension) -> String {
    format!("{} {}", show(value), dimension.si()).trim_end().to_owned()
}

fn show_list(values: &[f64]) -> String {
    format!("[{}]", values.iter().map(|&v| show(v)).collect::<Vec<_>>().join(", "))
}
