//! Numbers as people read them, and other people's text in Markdown.

use hwasp_core::unit;
use hwasp_settings::text::printable;

use crate::summary::DesignGroupSummary;

/// A count with its digits in threes: 4,000,000.
pub fn grouped(count: u64) -> String {
    let digits = count.to_string();
    let mut text = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

/// Text from files and arguments in Markdown: it ends no cell of a table, begins no tag and no line.
pub fn markdown(text: &str) -> String {
    printable(text).replace('\\', "\\\\").replace('|', "\\|").replace('<', "&lt;")
}

/// A value with its unit: four decimals, and as many more as small quantities need for three figures.
pub fn quantity(value: f64, unit: &str) -> String {
    let decimals = if value == 0.0 { 4 } else { (2 - value.abs().log10().floor() as i32).clamp(4, 9) as usize };
    format!("{value:.decimals$} {unit}").trim_end().to_owned()
}

/// The unit in which a group of design parameters reads well: mm and N·mm/rad for what is inside a finger.
#[derive(Clone, Debug, PartialEq)]
pub struct ReadableUnit {
    /// Its symbol, empty for pure numbers.
    pub unit: String,
    /// How many SI units it is.
    pub to_si: f64,
}

impl ReadableUnit {
    /// The unit of a group, by the most that it can come to in total.
    pub fn of(group: &DesignGroupSummary) -> Self {
        let most = group.limits[1] * group.values.len() as f64;
        let shown = unit(&group.unit).map(|unit| unit.readable(most));
        shown.map_or(Self { unit: group.unit.clone(), to_si: 1.0 }, |u| Self { unit: u.symbol.into(), to_si: u.to_si })
    }

    /// An SI value with its unit, to four decimals and more.
    pub fn long(&self, value: f64) -> String {
        quantity(value / self.to_si, &self.unit)
    }

    /// With its unit and without idle zeros.
    pub fn with_unit(&self, value: f64) -> String {
        format!("{} {}", self.short(value), self.unit).trim_end().to_owned()
    }

    /// Without either.
    pub fn short(&self, value: f64) -> String {
        let text = quantity(value / self.to_si, "");
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A part called `T1 | <script>` broke the table of parts.md.
    #[test]
    fn names_stay_in_their_cells() {
        assert_eq!(markdown("T1 | <script>\u{202e}\n"), "T1 \\| &lt;script>\u{fffd}\u{fffd}");
        assert_eq!(markdown("fixed:2 N·m/rad"), "fixed:2 N·m/rad");
    }
}
