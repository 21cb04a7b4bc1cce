//! The learning curve of a run, one row per iteration: `metrics.csv`.
//!
//! | column | meaning | unit |
//! |---|---|---|
//! | `iteration` | updates before this row, from 0 | - |
//! | `env_steps` | real simulator steps so far, everything counted | steps |
//! | `wall_s` | time since training began | s |
//! | `discounted_return` | mean over this iteration's training episodes | reward |
//! | `return` | the same, undiscounted | reward |
//! | `episodes` | training episodes that came to their end in this iteration: the returns are their means | - |
//! | `episode_steps` | their mean length | steps |
//! | `noise.command`, `noise.effort`, `noise.design` | how strongly the policy explores after the update: the mean standard deviation of commands, of efforts, of design parameters in the action; `NaN` where the action has none, and in a search | share of the range, SI, share of the range |
//! | one per metric of the learner, such as `learner.kl`; none in a search | what an update did, by the learner's own names | the learner's |
//! | one per named term of the reward, such as `reward.forward`; none where a search trains its candidates | its sum over an episode, a mean as `return` is | reward |
//! | one per design total, such as `stiffness_total` | the sum of a design group | SI |
//!
//! Tables of earlier versions are read, too: those without the columns from `episodes` to `noise.design` have `NaN` there. Tables that
//! were written before learners had names of their own have `kl`, `entropy` and `step_fraction` behind `return`;
//! they are read as metrics of these names.
//!
//! No field is ever quoted. Numbers are written in the shortest form that reads back to the same bits; what is not
//! known is `NaN`.

mod error;

use std::fmt::Write as _;
use std::io::{self, BufRead, Write};

use error::shorten;
use hwasp_core::{MOST_TERMS, NoiseSizes};
use hwasp_experiment::MOST_GROUPS;
use hwasp_training::MetricsRow;
use serde::{Deserialize, Serialize};

pub use error::MetricsError;

/// The columns that every table has, in order; the learner's metrics, the terms of the reward and the design totals
/// follow.
pub const FIXED_COLUMNS: [&str; 10] = [
    "iteration",
    "env_steps",
    "wall_s",
    "discounted_return",
    "return",
    "episodes",
    "episode_steps",
    "noise.command",
    "noise.effort",
    "noise.design",
];
/// How many of them tables of earlier versions have.
const EARLIER_FIXED: usize = 5;
/// What the column of a learner's metric begins with.
pub const LEARNER: &str = "learner.";
/// What the column of a term of the reward begins with.
pub const TERM: &str = "reward.";
/// The metrics behind the fixed columns of a table that has no column of a learner's own.
const EARLIER: [&str; 3] = ["kl", "entropy", "step_fraction"];
/// The most metrics of a learner in a table.
pub const MOST_METRICS: usize = 32;
/// The most design totals in a table.
pub const MOST_TOTALS: usize = MOST_GROUPS;
/// The most rows that are read.
pub const MOST_ROWS: usize = 2_000_000;
/// The longest line that is read, in bytes.
pub const LONGEST_LINE: usize = 16_384;
/// The longest name of a metric or a design total, in bytes.
pub const LONGEST_NAME: usize = 64;

/// Appends rows to a table; each row is flushed as one piece, so that a killed run leaves whole rows behind.
#[derive(Debug)]
pub struct MetricsWriter<W: Write> {
    out: W,
    learner: usize,
    terms: usize,
    totals: usize,
}

/// The columns of a table that depend on the experiment.
#[derive(Clone, Copy, Debug, Default)]
pub struct Columns<'a> {
    /// The names of the learner's metrics.
    pub learner: &'a [&'a str],
    /// The names of the reward's terms.
    pub terms: &'a [String],
    /// The names of the design totals.
    pub totals: &'a [String],
}

impl<W: Write> MetricsWriter<W> {
    /// Starts a table with these columns, in their order.
    pub fn new(out: W, columns: Columns<'_>) -> Result<Self, MetricsError> {
        let mut writer = Self::resume(out, columns)?;
        let learner = columns.learner.iter().map(|name| format!("{LEARNER}{name}"));
        let terms = columns.terms.iter().map(|name| format!("{TERM}{name}"));
        let names = FIXED_COLUMNS.iter().map(ToString::to_string).chain(learner).chain(terms);
        let names = names.chain(columns.totals.iter().cloned());
        writer.line(&names.collect::<Vec<_>>().join(","))?;
        Ok(writer)
    }

    /// Continues a table that has its header already; `out` stands at its end.
    pub fn resume(out: W, columns: Columns<'_>) -> Result<Self, MetricsError> {
        let Columns { learner, terms, totals } = columns;
        check_columns(learner, terms, totals)?;
        Ok(Self { out, learner: learner.len(), terms: terms.len(), totals: totals.len() })
    }

    /// Appends one row. Its metrics, terms and design totals must be as many as the table has; the error names line 0, where
    /// nothing has been written.
    pub fn append(&mut self, row: &MetricsRow) -> Result<(), MetricsError> {
        let found = [row.learner.len(), row.terms.len(), row.design_totals.len()];
        let expected = [self.learner, self.terms, self.totals];
        if found != expected {
            let all = |counts: [usize; 3]| FIXED_COLUMNS.len() + counts.iter().sum::<usize>();
            let (found, expected) = (all(found), all(expected));
            return Err(MetricsError::Fields { line: 0, found, expected });
        }
        let mut text = format!("{},{}", row.iteration, row.env_steps);
        for value in row.values() {
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
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct MetricsTable {
    /// The names of the learner's metrics, in the order of the rows' `learner`.
    pub learner: Vec<String>,
    /// The names of the reward's terms, in the order of the rows' `terms`.
    #[serde(default)]
    pub terms: Vec<String>,
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
        let (mut table, fixed) = read_header(lines.next()?.unwrap_or(""))?;
        let mut before = 0;
        while table.rows.last().map_or(0, |row| row.iteration.saturating_add(1)) < iteration {
            let Some(text) = lines.next()? else { break };
            let row = read_row(text, fixed, &table).map_err(|e| e.at(lines.number))?;
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

    /// The values of a learner's metric, one per row; none where the table does not have it.
    pub fn metric(&self, name: &str) -> Option<impl Iterator<Item = f64>> {
        let place = self.learner.iter().position(|known| known == name)?;
        Some(self.rows.iter().map(move |row| row.learner[place]))
    }

    /// The rows with the metrics and terms of these columns, in their order, NaN where the table does not have one: those of a
    /// table that another version wrote.
    pub(crate) fn rows_with(self, columns: Columns<'_>) -> Vec<MetricsRow> {
        let (learner, terms) = (places(&self.learner, columns.learner), places(&self.terms, columns.terms));
        let pick = |from: &[f64], places: &[Option<usize>]| {
            places.iter().map(|place| place.map_or(f64::NAN, |place| from[place])).collect()
        };
        let mut rows = self.rows;
        for row in &mut rows {
            (row.learner, row.terms) = (pick(&row.learner, &learner), pick(&row.terms, &terms));
        }
        rows
    }
}

/// Where wanted names are among those that there are.
fn places<S: AsRef<str>>(known: &[String], wanted: &[S]) -> Vec<Option<usize>> {
    wanted.iter().map(|name| known.iter().position(|known| known == name.as_ref())).collect()
}

/// Whether there are not too many columns, and each has a name that comes back.
fn check_columns<L: AsRef<str>>(learner: &[L], terms: &[String], totals: &[String]) -> Result<(), MetricsError> {
    for (what, found, most) in [
        ("metrics of a learner", learner.len(), MOST_METRICS),
        ("terms of a reward", terms.len(), MOST_TERMS),
        ("design totals", totals.len(), MOST_TOTALS),
    ] {
        if found > most {
            return Err(MetricsError::Columns { what, found, most });
        }
    }
    check_names(learner, |name| FIXED_COLUMNS.contains(&name))?;
    check_names(terms, |_| false)?;
    // Those of earlier tables are not free either: a damaged header would be read as one of other columns.
    let of_others = |name: &str| name.starts_with(LEARNER) || name.starts_with(TERM);
    let taken = |name: &str| FIXED_COLUMNS.contains(&name) || EARLIER.contains(&name) || of_others(name);
    check_names(totals, taken)
}

fn check_names<S: AsRef<str>>(names: &[S], taken: impl Fn(&str) -> bool) -> Result<(), MetricsError> {
    for (place, name) in names.iter().map(AsRef::as_ref).enumerate() {
        let plain = |c: char| c.is_alphanumeric() || matches!(c, '_' | '-' | '.');
        let twice = taken(name) || names[..place].iter().any(|n| n.as_ref() == name);
        if name.is_empty() || name.len() > LONGEST_NAME || !name.chars().all(plain) || twice {
            return Err(MetricsError::Name { name: shorten(name) });
        }
    }
    Ok(())
}

/// A table without rows that has the columns of this header, and how many of the fixed ones there are.
fn read_header(text: &str) -> Result<(MetricsTable, usize), MetricsError> {
    // A table saved by a spreadsheet may begin with a byte-order mark.
    let names: Vec<&str> = text.trim_start_matches('\u{feff}').split(',').collect();
    let earlier = names.get(EARLIER_FIXED) != Some(&FIXED_COLUMNS[EARLIER_FIXED]);
    let fixed = if earlier { EARLIER_FIXED } else { FIXED_COLUMNS.len() };
    for (place, expected) in FIXED_COLUMNS.into_iter().enumerate().take(fixed) {
        let found = names.get(place).copied().unwrap_or("");
        if found != expected {
            return Err(MetricsError::Header { column: place + 1, found: shorten(found), expected });
        }
    }
    let rest = &names[fixed..];
    let those_of = |prefix: &str, names: &[&str]| -> Vec<String> {
        names.iter().map_while(|name| name.strip_prefix(prefix)).map(str::to_owned).collect()
    };
    let earlier = rest.starts_with(&EARLIER);
    let learner = if earlier { EARLIER.map(str::to_owned).to_vec() } else { those_of(LEARNER, rest) };
    let rest = &rest[learner.len()..];
    let terms = those_of(TERM, rest);
    let design_totals: Vec<String> = rest[terms.len()..].iter().map(|&name| name.to_owned()).collect();
    check_columns(&learner, &terms, &design_totals)?;
    Ok((MetricsTable { learner, terms, design_totals, ..MetricsTable::default() }, fixed))
}

/// Reads one row; the errors name line 0 until [`MetricsError::at`] says which it was.
fn read_row(text: &str, fixed: usize, table: &MetricsTable) -> Result<MetricsRow, MetricsError> {
    let own = table.learner.iter().chain(&table.terms).chain(&table.design_totals);
    let names = FIXED_COLUMNS.into_iter().take(fixed).chain(own.map(String::as_str));
    let (found, expected) = (text.split(',').count(), names.clone().count());
    if found != expected {
        return Err(MetricsError::Fields { line: 0, found, expected });
    }
    let mut fields = names.zip(text.split(','));
    let mut field = || fields.next().expect("there are as many fields as names");
    let wrong = |(column, found): (&str, &str), expected| MetricsError::Number {
        line: 0,
        column: column.to_owned(),
        found: shorten(found),
        expected,
    };
    let mut count = || {
        let field = field();
        field.1.trim().parse::<u64>().map_err(|_| wrong(field, "a whole number from 0"))
    };
    let (iteration, env_steps) = (count()?, count()?);
    let mut real = || {
        let field = field();
        let value = field.1.trim().parse::<f64>().map_err(|_| wrong(field, "a number"));
        // `-NaN` can be read, but is never written: of what is not known there is but one kind.
        value.map(|value| if value.is_nan() { f64::NAN } else { value })
    };
    let (wall_s, discounted_return, undiscounted_return) = (real()?, real()?, real()?);
    let mut later = [f64::NAN; FIXED_COLUMNS.len() - EARLIER_FIXED];
    for value in later.iter_mut().take(fixed - EARLIER_FIXED) {
        *value = real()?;
    }
    let [episodes, episode_steps, command, effort, design] = later;
    Ok(MetricsRow {
        iteration,
        env_steps,
        wall_s,
        discounted_return,
        undiscounted_return,
        episodes,
        episode_steps,
        noise: NoiseSizes { command, effort, design },
        learner: table.learner.iter().map(|_| real()).collect::<Result<_, _>>()?,
        terms: table.terms.iter().map(|_| real()).collect::<Result<_, _>>()?,
        design_totals: table.design_totals.iter().map(|_| real()).collect::<Result<_, _>>()?,
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
