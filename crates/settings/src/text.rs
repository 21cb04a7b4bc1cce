//! Text from outside, made fit for messages, terminals and tables.

/// Whether a character moves a cursor, turns the direction of writing or is not seen at all.
pub fn is_unprintable(c: char) -> bool {
    c.is_control()
        || matches!(c, '\u{61c}' | '\u{200b}'..='\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2060}'..='\u{206f}' | '\u{feff}')
}

/// The text with a mark (U+FFFD) in the place of every character that [`is_unprintable`].
pub fn printable(text: &str) -> String {
    text.chars().map(|c| if is_unprintable(c) { '\u{fffd}' } else { c }).collect()
}

/// The same of a text of several lines, whose line ends and tabs stay.
pub fn printable_lines(text: &str) -> String {
    text.chars().map(|c| if is_unprintable(c) && !matches!(c, '\n' | '\t') { '\u{fffd}' } else { c }).collect()
}

/// The beginning of a text, [`printable`]: at most `most` characters, and an ellipsis where there are more.
pub fn shorten(text: &str, most: usize) -> String {
    let mut out: String = text.chars().take(most).map(|c| if is_unprintable(c) { '\u{fffd}' } else { c }).collect();
    if text.chars().nth(most).is_some() {
        out.push('…');
    }
    out
}

/// The longest name of what has a column in a learning curve, bytes.
const LONGEST_COLUMN: usize = 58;

/// Why what is called so cannot have a column in a learning curve; none where it can.
pub fn column_fault(name: &str) -> Option<String> {
    let plain = |c: char| c.is_alphanumeric() || matches!(c, '_' | '-');
    let sound = !name.is_empty() && name.len() <= LONGEST_COLUMN && name.chars().all(plain);
    (!sound).then(|| format!("use 1 to {LONGEST_COLUMN} letters, digits, `_` and `-`"))
}

/// A number for a message or a file: plain where that is readable, in powers of ten where it is not. It is read back to the
/// same bits.
pub fn show(value: f64) -> String {
    let size = value.abs();
    if value == 0.0 || (1e-3..1e7).contains(&size) { value.to_string() } else { format!("{value:e}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A name with U+202E reached the terminal raw, and what followed it was read from right to left.
    #[test]
    fn nothing_moves_the_cursor_or_turns_the_writing() {
        assert_eq!(printable("a\nb\u{1b}[31m\u{202e}c"), "a\u{fffd}b\u{fffd}[31m\u{fffd}c");
        assert_eq!(printable_lines("a\n\tb\r\u{2066}c"), "a\n\tb\u{fffd}\u{fffd}c");
        assert_eq!(shorten("N·m/rad – ü", 20), "N·m/rad – ü");
    }
}
