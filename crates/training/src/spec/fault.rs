//! What is wrong with an experiment, told all at once.

use std::fmt;

/// Faults that are kept; a file of nothing but faults is no reason to hold a million of them.
const MOST_KEPT: usize = 1000;
/// Faults that are printed.
const MOST_SHOWN: usize = 30;

/// The line of a file that a fault is about, for printing.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Excerpt {
    /// The line, shortened around the fault where it is very long; one column per character.
    pub text: String,
    /// Columns before the marked part.
    pub start: usize,
    /// Columns of the marked part, at least 1.
    pub width: usize,
}

/// One fault of an experiment.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fault {
    /// Where it stands: `my.toml:12:3`, or the option of the command line: `--set ppo.clip_ratio=2`.
    pub place: String,
    /// The line in the file, from 1; none for the command line and for what is missing.
    pub line: Option<usize>,
    /// The dotted path of the key, `ppo.clip_ratio`; empty where the fault is not about a key.
    pub key: String,
    /// What is wrong: the value and its limits.
    pub message: String,
    /// The way out.
    pub hint: Option<String>,
    /// The line itself.
    pub excerpt: Option<Excerpt>,
    /// Sorts faults as they stand: what is missing, the file from its top, the command line from its left.
    pub(super) rank: (usize, usize, usize),
    /// Index of the source it stands in, if it stands anywhere.
    pub(super) source: Option<usize>,
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let gutter = self.line.map_or(1, |line| line.to_string().len());
        write!(f, "error: {}", self.message)?;
        write!(f, "\n{:gutter$}--> {}", "", self.place)?;
        if let (Some(line), Some(excerpt)) = (self.line, &self.excerpt) {
            let (start, mark) = (excerpt.start, "^".repeat(excerpt.width));
            write!(f, "\n{:gutter$} |\n{line} | {}\n{:gutter$} | {:start$}{mark}", "", excerpt.text, "", "")?;
        }
        if let Some(hint) = &self.hint {
            write!(f, "\n{:gutter$} = hint: {hint}", "")?;
        }
        Ok(())
    }
}

/// Everything that is wrong with an experiment, in the order of its lines.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct SpecErrors {
    faults: Vec<Fault>,
    /// Faults found beyond those kept.
    dropped: usize,
}

impl SpecErrors {
    /// A single fault that belongs to no line: an unreadable file, say.
    pub(super) fn single(place: &str, message: String, hint: Option<String>) -> Self {
        let mut errors = Self::default();
        errors.push(Fault {
            place: shorten(place, 120),
            line: None,
            key: String::new(),
            message,
            hint,
            excerpt: None,
            rank: (0, 0, 0),
            source: None,
        });
        errors
    }

    /// The faults, in the order of their lines, those of the command line last.
    pub fn faults(&self) -> &[Fault] {
        &self.faults
    }

    /// How many there are, those too many to be kept included.
    pub fn count(&self) -> usize {
        self.faults.len() + self.dropped
    }

    pub(super) fn push(&mut self, fault: Fault) {
        // Two layers may show the same place twice: a base table is read once for every method.
        if self.faults.len() < MOST_KEPT && !self.faults.contains(&fault) {
            self.faults.push(fault);
        } else if self.is_full() {
            self.count_one();
        }
    }

    /// The same, where to make the fault costs something: those beyond the kept ones are not made.
    pub(super) fn push_with(&mut self, fault: impl FnOnce() -> Fault) {
        if self.is_full() { self.count_one() } else { self.push(fault()) }
    }

    /// Counts a fault that there is no room for.
    pub(super) fn count_one(&mut self) {
        self.dropped += 1;
    }

    /// Whether further faults are only counted.
    pub(super) fn is_full(&self) -> bool {
        self.faults.len() >= MOST_KEPT
    }

    /// Sorted, as an error where there is a fault at all.
    pub(super) fn into_result(mut self) -> Result<(), Self> {
        if self.faults.is_empty() {
            return Ok(());
        }
        self.faults.sort_by_key(|fault| fault.rank);
        Err(self)
    }
}

impl fmt::Display for SpecErrors {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let shown = self.faults.len().min(MOST_SHOWN);
        for (i, fault) in self.faults[..shown].iter().enumerate() {
            write!(f, "{}{fault}", if i == 0 { "" } else { "\n\n" })?;
        }
        match self.count() {
            0 | 1 => Ok(()),
            count if count > shown => write!(f, "\n\n{count} faults, the first {shown} of which are shown"),
            count => write!(f, "\n\n{count} faults"),
        }
    }
}

impl std::error::Error for SpecErrors {}

/// Text from outside for a message: at most `most` characters, and nothing that could move a terminal's cursor.
pub fn shorten(text: &str, most: usize) -> String {
    let mut out: String = text.chars().take(most).map(|c| if c.is_control() { '\u{fffd}' } else { c }).collect();
    if text.chars().nth(most).is_some() {
        out.push('…');
    }
    out
}

/// A number for a message: plain where that is readable, in powers of ten where it is not.
pub(super) fn show(value: f64) -> String {
    let size = value.abs();
    if value == 0.0 || (1e-3..1e7).contains(&size) { value.to_string() } else { format!("{value:e}") }
}
