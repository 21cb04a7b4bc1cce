//! Where values come from: a file's lines or an option of the command line.

use std::ops::Range;
use std::sync::Arc;

use crate::fault::{Excerpt, Fault};
use crate::text::{is_unprintable, shorten};

/// Characters of a line shown on either side of a fault.
const WINDOW: usize = 60;

/// A place in one of the sources.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Origin {
    /// Index of the source.
    pub source: usize,
    /// Bytes of its text; meaningless for the command line.
    pub span: Range<usize>,
}

/// A text that values were read from.
#[derive(Clone, Debug)]
pub(crate) enum Source {
    /// A file, or the part of it that is one method's.
    File {
        /// What the file is called.
        name: Arc<str>,
        /// All of it.
        text: Arc<str>,
    },
    /// An option as it was typed: `--set ppo.clip_ratio=2`.
    Option(String),
}

/// A fault before it is known where it stands.
pub(crate) struct Finding {
    pub(crate) key: String,
    pub(crate) message: String,
    pub(crate) hint: Option<String>,
}

impl Source {
    /// The fault at `span` of this source, which is number `index`.
    pub(crate) fn fault(&self, index: usize, span: &Range<usize>, finding: Finding) -> Fault {
        let Finding { key, message, hint } = finding;
        match self {
            Self::Option(typed) => {
                let place = shorten(typed, 120);
                Fault { place, line: None, key, message, hint, excerpt: None, rank: (2, index, 0), source: Some(index) }
            }
            Self::File { name, text } => {
                let start = floor(text, span.start);
                let before = &text[..start];
                let line = before.matches('\n').count() + 1;
                let line_start = before.rfind('\n').map_or(0, |i| i + 1);
                let line_end = text[start..].find('\n').map_or(text.len(), |i| start + i);
                let end = floor(text, span.end.clamp(start, line_end));
                let column = text[line_start..start].chars().count();
                let width = text[start..end.max(start)].chars().count().max(1);
                let excerpt = excerpt(&text[line_start..line_end], column, width);
                let place = format!("{}:{line}:{}", shorten(name, 120), column + 1);
                let (line_shown, excerpt, rank) = (Some(line), Some(excerpt), (1, line, column));
                Fault { place, line: line_shown, key, message, hint, excerpt, rank, source: Some(index) }
            }
        }
    }

    /// Where bytes `part` of a text stand that was written at `origin`; all of it where escapes have moved them.
    pub(crate) fn within(&self, origin: &Origin, part: &Range<usize>) -> Origin {
        let Self::File { text, .. } = self else { return origin.clone() };
        let written = text.get(origin.span.clone()).unwrap_or_default();
        let mut quotes = ["\"\"\"\n", "'''\n", "\"\"\"", "'''", "\"", "'"].into_iter();
        match quotes.find(|quotes| written.starts_with(quotes)) {
            Some(quotes) if !(quotes.starts_with('"') && written.contains('\\')) => {
                let start = origin.span.start + quotes.len();
                // A place at the end of the text is shown at the closing quotes.
                let from = (start + part.start).min(origin.span.end.saturating_sub(1));
                Origin { source: origin.source, span: from..(start + part.end).max(from) }
            }
            _ => origin.clone(),
        }
    }

    /// What to call it where something is missing in it.
    pub(crate) fn name(&self) -> String {
        match self {
            Self::File { name, .. } => shorten(name, 120),
            Self::Option(typed) => shorten(typed, 120),
        }
    }
}

/// The greatest character boundary that is not beyond `at`.
fn floor(text: &str, at: usize) -> usize {
    (0..=at.min(text.len())).rev().find(|&i| text.is_char_boundary(i)).unwrap_or(0)
}

/// The part of a line around its columns `column..column + width`.
fn excerpt(line: &str, column: usize, width: usize) -> Excerpt {
    let clean = |c: char| if is_unprintable(c) { ' ' } else { c };
    let skipped = if column > 2 * WINDOW { column - WINDOW } else { 0 };
    let line = line.trim_end();
    let mut text: String = if skipped > 0 { "…".into() } else { String::new() };
    text.extend(line.chars().skip(skipped).take(3 * WINDOW).map(clean));
    if line.chars().nth(skipped + 3 * WINDOW).is_some() {
        text.push('…');
    }
    Excerpt { text, start: column - skipped + usize::from(skipped > 0), width: width.min(2 * WINDOW) }
}
