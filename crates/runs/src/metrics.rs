//! The learning curve of a run, one row per iteration: `metrics.csv`.
//!
//! | column | meaning | unit |
//! |---|---|---|
//! | `iteration` | updates before this row, from 0 | - |
//! | `env_steps` | real simulator steps so far, everything counted | steps |
//! | `wall_s` | time since training began | s |
//! | `discounted_return` | mean over this iteration's training episodes | reward |
//! | `return` | the same, undiscounted | reward |
//! | `kl` | mean KL divergence of the policy before and after the update | nat |
//! | `entropy` | entropy of the policy | nat |
//! | `step_fraction` | share of TRPO's full step that was taken, 0 for none; 1 for PPO | - |
//! | one per design total, such as `stiffness_total` | the sum of a design group | SI |
//!
//! No field is ever quoted. Numbers are written in the shortest form that reads back to the same bits; what is not
//! known is `NaN`.

mod error;

use std::fmt::Write as _;
use std::io::{self, BufRead, Write};

use error::shown;
use hwasp_training::MetricsRow;

pub use error::MetricsError;

/// The columns that every table has, in order; the design totals follow.
pub const FIXED_COLUMNS: [&str; 8] =
    ["iteration", "env_steps", "wall_s", "discounted_return", "return", "kl", "entropy", "step_fraction"];
/// The most design totals in a table.
pub const MOST_TOTALS: usize = 64;
/// The most rows that are read.
pub const MOST_ROWS: usize = 2_000_000;
/// The longest line that is read, in bytes.
pub const LONGEST_LINE: usize = 8192;
/// The longest name of a design total, in bytes.
pub const LONGEST_NAME: usize = 64;

/// Appends rows to a table; each row is flushed as one piece, so that a killed run leaves whole rows behind.
#[derive(Debug)]
pub struct MetricsWriter<W: Write> {
    out: W,
    totals: usize,
}

impl<W: Write> MetricsWriter<W> {
    /// Starts a table with one column for each design total, in this order.
    pub fn new<S: AsRef<str>>(out: W, design_totals: &[S]) -> Result<Self, MetricsError> {
        let mut writer = Self::resume(out, design_totals)?;
        let names = FIXED_COLUMNS.into_iter().chain(design_totals.iter().map(AsRef::as_ref));
        writer.line(&names.collect::<Vec<_>>().join(","))?;
        Ok(writer)
    }

    /// Continues a table that has its header already; `out` stands at its end.
    pub fn resume<S: AsRef<str>>(out: W, design_totals: &[S]) -> Result<Self, MetricsError> {
        check_names(design_totals)?;
        Ok(Self { out, totals: design_totals.len() })
    }

    /// Appends one row. Its design totals must be as many as the table has; the error names line 0, where nothing has
    /// been written.
    pub fn append(&mut self, row: &MetricsRow) -> Result<(), MetricsError> {
        if row.design_totals.len() != self.totals {
            let fixed = FIXED_COLUMNS.len();
            let (found, expected) = (fixed + row.design_totals.len(), fixed + self.totals);
            return Err(MetricsError::Fields { line: 0, found, expected });
        }
        let mut text = format!("{},{}", row.iteration, row.env_steps);
        let fixed =
            [row.wall_s, row.discounted_return, row.undiscounted_return, row.kl, row.entropy, row.step_fraction];
        for value in fixed.iter().chain(&row.design_totals) {
            // `Debug` is the shortest text that reads back to the same bits, with an exponent where that is shorter.
            let _ = write!(text, ",{value:?}");
        }
        self.line(&text)
    }

    /// Gives the writer back.
    pub fn into_inner(self) -> W {
        self.out
    }

    /// The writer.
    pub fn get_ref(&self) -> &W {
        &self.out
    }

    /// The writer, to take away what is in it.
    pub fn get_mut(&mut self) -> &mut W {
        &mut self.out
    }

    fn line(&mut self, text: &str) -> Result<(), MetricsError> {
        self.out.write_all(format!("{text}\n").as_bytes())?;
        Ok(self.out.flush()?)
    }
}

/// A table read back.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MetricsTable {
    /// The names of the design totals, in the order of the rows' `design_totals`.
    pub design_totals: Vec<String>,
    /// The rows in order; `env_steps` never falls.
    pub rows: Vec<MetricsRow>,
    /// The last line (from 1) if it does not end and was therefore left out: the run was cut off while writing it, or is
    /// writing it now.
    pub unfinished_line: Option<usize>,
}

impl MetricsTable {
    /// Reads a table. The input is not trusted: its lines, columns and rows are limited, and whatever is wrong is an
    /// error with its line.
    pub fn read(input: impl io::Read) -> Result<Self, MetricsError> {
        Self::read_before(input, u64::MAX)
    }

    /// Reads the rows before an iteration, and nothing of what comes behind the last of them.
    pub fn read_before(input: impl io::Read, iteration: u64) -> Result<Self, MetricsError> {
        let mut lines = Lines { input: io::BufReader::new(input), number: 0, unfinished: None, buffer: Vec::new() };
        let mut table = Self { design_totals: read_header(lines.next()?.unwrap_or(""))?, ..Self::default() };
        let mut before = 0;
        while table.rows.last().map_or(0, |row| row.iteration.saturating_add(1)) < iteration {
            let Some(text) = lines.next()? else { break };
            let row = read_row(text, &table.design_totals).map_err(|e| e.at(lines.number))?;
            if row.env_steps < before {
                return Err(MetricsError::Backwards { line: lines.number, before, after: row.env_steps });
            }
            if row.iteration >= iteration {
                break;
            }
            if table.rows.len() == MOST_ROWS {
                return Err(MetricsError::Rows);
            }
            before = row.env_steps;
            table.rows.push(row);
        }
        table.unfinished_line = lines.unfinished;
        Ok(table)
    }
}

fn check_names<S: AsRef<str>>(names: &[S]) -> Result<(), MetricsError> {
    if names.len() > MOST_TOTALS {
        return Err(MetricsError::Totals { found: names.len() });
    }
    for (place, name) in names.iter().map(AsRef::as_ref).enumerate() {
        let plain = |c: char| c.is_alphanumeric() || matches!(c, '_' | '-' | '.');
        let twice = FIXED_COLUMNS.contains(&name) || names[..place].iter().any(|n| n.as_ref() == name);
        if name.is_empty() || name.len() > LONGEST_NAME || !name.chars().all(plain) || twice {
            return Err(MetricsError::Name { name: shown(name) });
        }
    }
    Ok(())
}

fn read_header(text: &str) -> Result<Vec<String>, MetricsError> {
    // A table saved by a spreadsheet may begin with a byte-order mark.
    let mut names = text.trim_start_matches('\u{feff}').split(',');
    for (place, expected) in FIXED_COLUMNS.into_iter().enumerate() {
        let found = names.next().unwrap_or("");
        if found != expected {
            return Err(MetricsError::Header { column: place + 1, found: shown(found), expected });
        }
    }
    let totals: Vec<String> = names.map(str::to_owned).collect();
    check_names(&totals)?;
    Ok(totals)
}

/// Reads one row; the errors name line 0 until [`MetricsError::at`] says which it was.
fn read_row(text: &str, totals: &[String]) -> Result<MetricsRow, MetricsError> {
    let (found, expected) = (text.split(',').count(), FIXED_COLUMNS.len() + totals.len());
    if found != expected {
        return Err(MetricsError::Fields { line: 0, found, expected });
    }
    let mut fields = FIXED_COLUMNS.into_iter().chain(totals.iter().map(String::as_str)).zip(text.split(','));
    let wrong = |(column, found): (&str, &str), expected| MetricsError::Number {
        line: 0,
        column: column.to_owned(),
        found: shown(found),
        expected,
    };
    // The count of fields is checked above, so the default is never taken.
    let mut count = || {
        let field = fields.next().unwrap_or_default();
        field.1.trim().parse::<u64>().map_err(|_| wrong(field, "a whole number from 0"))
    };
    let (iteration, env_steps) = (count()?, count()?);
    let mut real = || {
        let field = fields.next().unwrap_or_default();
        let value = field.1.trim().parse::<f64>().map_err(|_| wrong(field, "a number"));
        // `-NaN` can be read, but is never written: of what is not known there is but one kind.
        value.map(|value| if value.is_nan() { f64::NAN } else { value })
    };
    Ok(MetricsRow {
        iteration,
        env_steps,
        wall_s: real()?,
        discounted_return: real()?,
        undiscounted_return: real()?,
        kl: real()?,
        entropy: real()?,
        step_fraction: real()?,
        design_totals: totals.iter().map(|_| real()).collect::<Result<_, _>>()?,
    })
}

/// Whole lines of bounded length, counted.
struct Lines<R> {
    input: R,
    number: usize,
    unfinished: Option<usize>,
    buffer: Vec<u8>,
}

impl<R: BufRead> Lines<R> {
    fn next(&mut self) -> Result<Option<&str>, MetricsError> {
        self.number += 1;
        self.buffer.clear();
        let mut limited = io::Read::take(&mut self.input, LONGEST_LINE as u64 + 1);
        limited.read_until(b'\n', &mut self.buffer)?;
        if self.buffer.len() > LONGEST_LINE {
            return Err(MetricsError::Long { line: self.number });
        }
        if self.buffer.pop_if(|last| *last == b'\n').is_none() {
            self.unfinished = (!self.buffer.is_empty()).then_some(self.number);
            return Ok(None);
        }
        self.buffer.pop_if(|last| *last == b'\r');
        let line = self.number;
        std::str::from_utf8(&self.buffer).map(Some).map_err(|_| MetricsError::Text { line })
    }
}
