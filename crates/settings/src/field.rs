//! What is known of a setting without any file: for the reference and the JSON Schema.

use hwasp_core::Dimension;

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
    /// A text of at most so many characters.
    Text(usize),
    /// One of these names.
    Choice(Vec<&'static str>),
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
    /// Something of several forms, as the meaning says.
    Open,
}

impl Kind {
    /// The limits in words.
    pub(crate) fn limits(&self) -> String {
        match self {
            Self::Number([lo, hi]) => format!("{} to {}", show(*lo), show(*hi)),
            Self::Integer([lo, hi]) => format!("{} to {}", spaced(*lo), spaced(*hi)),
            Self::Quantity(dimension, [lo, hi]) => {
                format!("{} to {} {}", show(*lo), show(*hi), dimension.si()).trim_end().to_owned()
            }
            Self::Text(most) => format!("up to {most} characters"),
            Self::Choice(names) => names.iter().map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", "),
            Self::Optional(kind) => kind.limits(),
            Self::List { of, length: [_, most], .. } if *most < usize::MAX => {
                format!("up to {most} of {}", of.limits())
            }
            Self::List { of, .. } => of.limits(),
            Self::Flag | Self::Open => String::new(),
        }
    }
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
        let limits = if limits.is_empty() { " ".to_owned() } else { format!(" {limits} ") };
        format!("| `{key}` | {default} | {meaning} |{limits}|")
    }
}
