//! What is known of a setting without any file: for the reference and the JSON Schema.

use hwasp_core::{Dimension, unit};

use crate::text::show;

/// A setting.
#[derive(Clone, Debug, PartialEq)]
pub struct Field {
    /// Its key.
    pub key: String,
    /// What its value is.
    pub kind: Kind,
    /// Its default in words or as it is written in files.
    pub default: String,
    /// Its limits in words; empty where the kind says all.
    pub limits: String,
    /// What it means.
    pub meaning: String,
}

/// What a setting's value is.
#[derive(Clone, Debug, PartialEq)]
pub enum Kind {
    /// A real number within limits.
    Number([f64; 2]),
    /// A whole number within limits.
    Integer([u64; 2]),
    /// True or false.
    Flag,
    /// A text of at most so many characters, of one line or several.
    Text(usize),
    /// The same of one line.
    Line(usize),
    /// One of these names.
    Choice(Vec<&'static str>),
    /// One of these names, which are known when the program runs.
    Names(Vec<String>),
    /// A text such as `"3 N"`, within limits in SI.
    Quantity(Dimension, [f64; 2]),
    /// The same, or "none".
    Optional(Box<Kind>),
    /// A list of some length, of at most so many items, or one item for all where `single`.
    List {
        /// What an item is.
        of: Box<Kind>,
        /// The fewest and the most items.
        length: [usize; 2],
        /// Whether one item without brackets will do.
        single: bool,
    },
    /// A text such as `"3 N"` of a dimension that depends on the rest of the file.
    AnyQuantity,
    /// A table of keys of any name, with values of one kind.
    Table(Box<Kind>),
    /// One of these kinds.
    AnyOf(Vec<Kind>),
    /// Whatever its owner reads.
    Open,
}

impl Kind {
    /// The limits in words.
    pub fn limits(&self) -> String {
        match self {
            Self::Number([lo, hi]) => format!("{} to {}", short(*lo), short(*hi)),
            Self::Integer([lo, hi]) => format!("{} to {}", spaced(*lo), spaced(*hi)),
            Self::Quantity(dimension, [lo, hi]) => {
                let unit = readable(*dimension, *hi);
                format!("{} to {} {}", unit.short(*lo), unit.short(*hi), unit.symbol).trim_end().to_owned()
            }
            Self::Text(most) | Self::Line(most) => format!("up to {most} characters"),
            Self::Choice(names) => names.iter().map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", "),
            Self::Names(names) => names.iter().map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", "),
            Self::Optional(kind) => kind.limits(),
            Self::List { of, length: [_, most], single: false } if *most < usize::MAX => {
                format!("up to {most} of {}", of.limits())
            }
            Self::List { of, .. } => of.limits(),
            Self::Flag | Self::AnyQuantity | Self::Table(_) | Self::AnyOf(_) | Self::Open => String::new(),
        }
    }
}

/// A unit in which a row of the reference reads well.
pub(crate) struct RowUnit {
    pub(crate) symbol: &'static str,
    to_si: f64,
}

/// The unit for values up to `most`, SI, of either sign: the thousandth of the SI unit below half of one. One unit is for all of a
/// row, so that limits and default can be compared at a glance.
pub(crate) fn readable(dimension: Dimension, most: f64) -> RowUnit {
    let symbols = dimension.symbols().into_iter().filter_map(unit);
    let thousandth = symbols.into_iter().find(|unit| unit.to_si == 1e-3).filter(|_| most.abs() < 0.5);
    thousandth.map_or(RowUnit { symbol: dimension.si(), to_si: 1.0 }, |u| RowUnit { symbol: u.symbol, to_si: u.to_si })
}

impl RowUnit {
    /// An SI value in it, without the symbol.
    pub(crate) fn short(&self, value: f64) -> String {
        short(value / self.to_si)
    }
}

/// A number as a person writes it: without the last digits that a change of units leaves, and in powers of ten where that is shorter.
pub(crate) fn short(value: f64) -> String {
    // Twelve digits: no default and no limit has as many.
    let plain = format!("{value:.11e}").parse().map_or_else(|_| show(value), |value: f64| show(value));
    let power = plain.parse().map_or_else(|_| plain.clone(), |value: f64| format!("{value:e}"));
    if value.abs() >= 1e4 && power.len() < plain.len() { power } else { plain }
}

/// A count with its digits in threes where there are many.
fn spaced(count: u64) -> String {
    let digits = count.to_string();
    if count >= 10_u64.pow(10) && count.is_power_of_two() || count == i64::MAX as u64 {
        return "2^63 - 1".to_owned();
    }
    if digits.trim_end_matches('0') == "1" && digits.len() > 7 {
        return format!("1e{}", digits.len() - 1);
    }
    if digits.len() <= 4 {
        return digits;
    }
    let mut text = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            text.push(' ');
        }
        text.push(digit);
    }
    text
}

impl Field {
    /// A row of the reference: key, default, meaning, limits.
    pub fn row(&self) -> String {
        let Self { key, default, meaning, limits, .. } = self;
        // What stands between bars ends a column of a Markdown table.
        let [default, meaning, limits] = [default, meaning, limits].map(|text| text.replace('|', "\\|"));
        let limits = if limits.is_empty() { " ".to_owned() } else { format!(" {limits} ") };
        format!("| `{key}` | {default} | {meaning} |{limits}|")
    }
}
