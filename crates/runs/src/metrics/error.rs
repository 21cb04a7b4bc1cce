//! What can be wrong with a metrics table.

use std::io;

use thiserror::Error;

use super::{LONGEST_LINE, LONGEST_NAME, MOST_ROWS};

/// Why a metrics table cannot be written or read. Lines count from 1, the header among them.
#[derive(Debug, Error)]
pub enum MetricsError {
    /// The file itself.
    #[error("metrics cannot be read or written: {0}")]
    Io(#[from] io::Error),
    /// A name of a metric or a design total that would not survive in a header.
    #[error(
        "`{name}` cannot name a column: use 1 to {LONGEST_NAME} letters, digits, `_`, `-` and `.`, and no name twice"
    )]
    Name {
        /// The name, cut to a readable length.
        name: String,
    },
    /// More columns than a table may have.
    #[error("{found} {what} are more than {most}")]
    Columns {
        /// Of which kind.
        what: &'static str,
        /// How many there are.
        found: usize,
        /// How many there may be.
        most: usize,
    },
    /// The first line is not a header of this table.
    #[error("line 1 is not a header of metrics: column {column} is `{found}`, expected `{expected}`")]
    Header {
        /// Its place, from 1.
        column: usize,
        /// What is there, cut to a readable length.
        found: String,
        /// What belongs there.
        expected: &'static str,
    },
    /// A row with another number of fields than the header.
    #[error("line {line} has {found} fields, the header has {expected}")]
    Fields {
        /// The line.
        line: usize,
        /// How many fields it has.
        found: usize,
        /// How many the header has.
        expected: usize,
    },
    /// A field that is no number.
    #[error("line {line}: `{found}` in column `{column}` is not {expected}")]
    Number {
        /// The line.
        line: usize,
        /// The column's name.
        column: String,
        /// What is there, cut to a readable length.
        found: String,
        /// What belongs there.
        expected: &'static str,
    },
    /// Steps that go backwards: two runs in one file, or a damaged one.
    #[error("line {line}: env_steps falls from {before} to {after}; a table holds one run, in order")]
    Backwards {
        /// The line.
        line: usize,
        /// The steps of the row before.
        before: u64,
        /// The steps of this row.
        after: u64,
    },
    /// A line too long to be a row.
    #[error("line {line} is longer than {LONGEST_LINE} bytes, so this is not a metrics table")]
    Long {
        /// The line.
        line: usize,
    },
    /// Text that is not UTF-8.
    #[error("line {line} is not UTF-8 text")]
    Text {
        /// The line.
        line: usize,
    },
    /// A table of something else.
    #[error("its columns are those of another experiment")]
    Another,
    /// Too many rows.
    #[error("the table has more than {MOST_ROWS} rows")]
    Rows,
}

impl MetricsError {
    /// The same fault with the line it was found in.
    pub(super) fn at(mut self, number: usize) -> Self {
        if let Self::Fields { line, .. } | Self::Number { line, .. } = &mut self {
            *line = number;
        }
        self
    }
}

/// The beginning of a text from outside, fit for an error message.
pub(super) fn shorten(text: &str) -> String {
    let mut cut: String = text.chars().take(40).flat_map(char::escape_debug).collect();
    if text.chars().nth(40).is_some() {
        cut.push('…');
    }
    cut
}
