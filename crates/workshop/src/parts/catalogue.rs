//! Catalogues of springs: a row each, as spreadsheets write them.

use std::collections::BTreeSet;
use std::fmt;
use std::fs::File;
use std::io::{self, Read};
use std::ops::RangeInclusive;
use std::path::Path;

use csv::{ReaderBuilder, StringRecord, Trim};
use hwasp_settings::text::shorten;
use hwasp_settings::{listed, nearest};
use thiserror::Error;

use super::spring::{MUSIC_WIRE_MODULUS, TorsionSpring, music_wire_strength};

/// The catalogue that comes with the program.
pub const BUILT_IN: &str = include_str!("catalogue.csv");
/// The largest file that is read, bytes.
const LARGEST: u64 = 4 << 20;
/// The most springs.
const MOST: usize = 20_000;
/// Faults that are told.
const MOST_SHOWN: usize = 20;
/// The longest name of a part, bytes.
const LONGEST_NAME: usize = 60;

/// A column, what a row may have there, and whether it can be left out.
struct Column {
    name: &'static str,
    limits: RangeInclusive<f64>,
    optional: bool,
}

const fn column(name: &'static str, limits: RangeInclusive<f64>) -> Column {
    Column { name, limits, optional: false }
}

/// The columns of numbers, beside `part`.
const COLUMNS: [Column; 7] = [
    column("wire_mm", 0.05..=10.0),
    column("outer_mm", 0.2..=200.0),
    column("turns", 1.0..=100.0),
    column("leg_angle_deg", 0.0..=360.0),
    column("leg_mm", 0.0..=200.0),
    Column { name: "modulus_gpa", limits: 10.0..=400.0, optional: true },
    Column { name: "strength_mpa", limits: 50.0..=5000.0, optional: true },
];

/// Least and greatest mean diameter over wire diameter: springs beyond cannot be wound or do not hold their shape.
const INDICES: RangeInclusive<f64> = 3.0..=40.0;

/// A spring of a catalogue.
#[derive(Clone, Debug, PartialEq)]
pub struct CatalogueSpring {
    /// What it is ordered by.
    pub part: String,
    /// The spring.
    pub spring: TorsionSpring,
    /// Angle between its legs when it is free, rad.
    pub leg_angle: f64,
}

/// Springs that can be had.
#[derive(Clone, Debug, PartialEq)]
pub struct SpringCatalogue {
    /// Where it comes from: a file's name, or `built in`.
    pub name: String,
    /// The springs, in the order of the rows, at least one.
    pub springs: Vec<CatalogueSpring>,
    /// Columns that say nothing here: a supplier's prices and stocks.
    pub ignored: Vec<String>,
}

/// Why a catalogue is of no use.
#[derive(Debug, Error)]
pub enum SpringCatalogueError {
    /// The file.
    #[error("cannot read the catalogue {path}: {source}\n  = hint: name a CSV file that may be read")]
    Read {
        /// Its name.
        path: String,
        /// What the system says.
        source: io::Error,
    },
    /// What is in it.
    #[error("{}", told(name, faults))]
    Faults {
        /// The catalogue.
        name: String,
        /// What is wrong, in the order of the lines.
        faults: Vec<CatalogueFault>,
    },
}

/// Something that is wrong with a line of a catalogue.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CatalogueFault {
    /// The line, from 1.
    pub line: u64,
    /// What is wrong with it.
    pub message: String,
}

impl fmt::Display for CatalogueFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "line {}: {}", self.line, self.message)
    }
}

fn told(name: &str, faults: &[CatalogueFault]) -> String {
    let shown = faults.iter().take(MOST_SHOWN);
    let lines = shown.fold(String::new(), |lines, fault| format!("{lines}\n  {fault}"));
    let more = faults.len().saturating_sub(MOST_SHOWN);
    let rest = if more > 0 { format!("\n  and {more} more") } else { String::new() };
    format!("the catalogue {name} is wrong:{lines}{rest}\n  = hint: docs/parts.md has the columns and their limits")
}

impl SpringCatalogue {
    /// The catalogue that comes with the program.
    ///
    /// # Errors
    /// Never, which a test checks.
    pub fn built_in() -> Result<Self, SpringCatalogueError> {
        Self::parse("built in", BUILT_IN.as_bytes())
    }

    /// Reads a file, which is taken for hostile.
    pub fn open(path: &Path) -> Result<Self, SpringCatalogueError> {
        let name = path.display().to_string();
        let mut bytes = Vec::new();
        let read = File::open(path).and_then(|file| file.take(LARGEST + 1).read_to_end(&mut bytes));
        let read = read.and_then(|_| {
            let large = || io::Error::new(io::ErrorKind::FileTooLarge, format!("it is larger than {LARGEST} bytes"));
            if bytes.len() as u64 > LARGEST { Err(large()) } else { Ok(()) }
        });
        read.map_err(|source| SpringCatalogueError::Read { path: name.clone(), source })?;
        Self::parse(&name, &bytes)
    }

    /// What to tell of columns that are ignored, if there are any.
    pub fn remark(&self) -> Option<String> {
        let names = listed(self.ignored.iter().take(MOST_SHOWN).map(String::as_str));
        let more = self.ignored.len().saturating_sub(MOST_SHOWN);
        let rest = if more > 0 { format!(" and {more} more") } else { String::new() };
        (!self.ignored.is_empty()).then(|| format!("columns of {} that are not needed: {names}{rest}", self.name))
    }

    /// Reads the text of a catalogue, a header with the columns' names first; `name`: what errors call it. All wrong rows are
    /// told at once.
    pub fn parse(name: &str, text: &[u8]) -> Result<Self, SpringCatalogueError> {
        let (mut springs, mut ignored, mut faults) = (Vec::new(), Vec::new(), Vec::new());
        read(text, &mut springs, &mut ignored, &mut faults);
        if springs.is_empty() && faults.is_empty() {
            faults.push(CatalogueFault { line: 1, message: "there are no springs below the header".into() });
        }
        if faults.is_empty() {
            return Ok(Self { name: name.to_owned(), springs, ignored });
        }
        Err(SpringCatalogueError::Faults { name: name.to_owned(), faults })
    }
}

fn read(text: &[u8], springs: &mut Vec<CatalogueSpring>, ignored: &mut Vec<String>, faults: &mut Vec<CatalogueFault>) {
    // Spreadsheets begin a file with a mark of its encoding.
    let text = text.strip_prefix(b"\xef\xbb\xbf").unwrap_or(text);
    let mut reader = ReaderBuilder::new().comment(Some(b'#')).trim(Trim::All).flexible(true).from_reader(text);
    let mut fault = |line, message| faults.push(CatalogueFault { line, message });
    let header = match reader.headers() {
        Ok(header) => header.clone(),
        Err(error) => return fault(1, error.to_string()),
    };
    let first = header.position().map_or(1, csv::Position::line);
    let places = match places(&header) {
        Ok((places, others)) => {
            *ignored = others;
            places
        }
        Err(message) => return fault(first, message),
    };
    let mut known = BTreeSet::new();
    for row in reader.records() {
        let row = match row {
            Ok(row) => row,
            Err(error) => return fault(error.position().map_or(first, csv::Position::line), error.to_string()),
        };
        let line = row.position().map_or(first, csv::Position::line);
        if springs.len() == MOST {
            return fault(line, format!("more than {MOST} springs"));
        }
        match spring(&row, &header, &places) {
            Ok(spring) if !known.insert(spring.part.clone()) => {
                fault(line, format!("part {} stands there twice", spring.part));
            }
            Ok(spring) => springs.push(spring),
            Err(message) => fault(line, message),
        }
    }
}

/// Where the part and each of [`COLUMNS`] are.
type Places = (usize, [Option<usize>; 7]);

/// Where they are in a header, and the columns that are none of them. A slip in a name is told: a column that is not there and is
/// nearly called so.
fn places(header: &StringRecord) -> Result<(Places, Vec<String>), String> {
    let names = || std::iter::once("part").chain(COLUMNS.iter().map(|column| column.name));
    let absent = || names().filter(|name| header.iter().all(|found| found != *name));
    let mut ignored = Vec::new();
    for (i, found) in header.iter().enumerate() {
        let shown = shown(found);
        if !names().any(|name| name == found) {
            if absent().count() > COLUMNS.len() && found.contains([';', '\t']) {
                return Err("columns are parted by commas".into());
            }
            if let Some(near) = nearest(found, absent()) {
                let known = names().collect::<Vec<_>>().join(", ");
                return Err(format!("column `{shown}` is none of {known}; did you mean `{near}`?"));
            }
            ignored.push(shown);
            continue;
        }
        if header.iter().take(i).any(|before| before == found) {
            return Err(format!("column `{shown}` stands there twice"));
        }
    }
    let place = |name| header.iter().position(|found| found == name);
    let missing = names()
        .find(|&name| place(name).is_none() && !COLUMNS.iter().any(|column| column.name == name && column.optional));
    match (missing, place("part")) {
        (None, Some(part)) => Ok(((part, COLUMNS.each_ref().map(|column| place(column.name))), ignored)),
        (missing, _) => {
            let missing = missing.unwrap_or("part");
            let others = if ignored.is_empty() {
                String::new()
            } else {
                format!("; unknown: {}", listed(ignored.iter().take(MOST_SHOWN).map(String::as_str)))
            };
            Err(format!("column `{missing}` is missing{others}"))
        }
    }
}

fn spring(row: &StringRecord, header: &StringRecord, (part, places): &Places) -> Result<CatalogueSpring, String> {
    if row.len() != header.len() {
        return Err(format!("{} fields, and the header has {}", row.len(), header.len()));
    }
    let part = &row[*part];
    if part.is_empty() || part.len() > LONGEST_NAME {
        return Err(format!("part `{}` is not a name of 1 to {LONGEST_NAME} bytes", shown(part)));
    }
    let mut values = [None; 7];
    for ((value, place), Column { name, limits, optional }) in values.iter_mut().zip(places).zip(&COLUMNS) {
        let Some(text) = place.map(|place| &row[place]).filter(|text| !(*optional && text.is_empty())) else {
            continue;
        };
        let number = text.parse().ok().filter(|number| limits.contains(number));
        let between =
            || format!("{name} is `{}`, which is no number from {} to {}", shown(text), limits.start(), limits.end());
        *value = Some(number.ok_or_else(between)?);
    }
    let [wire, outer, turns, leg_angle, leg, modulus, strength] = values;
    // What is not optional is there: the header has it, and it was read.
    let of = |value: Option<f64>| value.unwrap_or_default();
    let wire = 1e-3 * of(wire);
    let spring = TorsionSpring {
        wire,
        outer: 1e-3 * of(outer),
        turns: of(turns),
        leg: 1e-3 * of(leg),
        modulus: modulus.map_or(MUSIC_WIRE_MODULUS, |gpa| 1e9 * gpa),
        strength: strength.map_or_else(|| music_wire_strength(wire), |mpa| 1e6 * mpa),
    };
    if !INDICES.contains(&spring.index()) {
        return Err(format!(
            "a coil of {} mm outside of a wire of {} mm has the spring index {:.1}, and {} to {} can be wound",
            1e3 * spring.outer,
            1e3 * spring.wire,
            spring.index(),
            INDICES.start(),
            INDICES.end()
        ));
    }
    Ok(CatalogueSpring { part: part.to_owned(), spring, leg_angle: of(leg_angle).to_radians() })
}

/// The beginning of a text from outside, fit for an error message.
fn shown(text: &str) -> String {
    shorten(text, 40)
}
