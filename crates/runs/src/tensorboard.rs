//! Learning curves as TensorBoard reads them: an event file of scalars.
//!
//! The file is a sequence of records (`TFRecord`; TensorFlow's documentation of it gives the framing and the mask):
//!
//! | bytes | what |
//! |---|---|
//! | 8 | length of the data, little endian |
//! | 4 | masked CRC-32C of these 8 bytes |
//! | length | the data |
//! | 4 | masked CRC-32C of the data |
//!
//! Each record is an `Event` in protocol buffers, of whose fields (TensorFlow's `event.proto`, `summary.proto`) these are
//! written: `wall_time` (double, 1), `step` (int64, 2), and either `file_version` (string, 3; the first record) or `summary`
//! (message, 5) with a `value` (message, 1) per scalar: `tag` (string, 1) and `simple_value` (float, 2).
//!
//! | tag | meaning | steps |
//! |---|---|---|
//! | `train/return`, `train/discounted_return` | as in [`metrics`](crate::metrics) | every iteration |
//! | `train/episodes`, `train/episode_steps`, `noise/command`, `noise/effort`, `noise/design` | as there; those that are not known are left out | every iteration |
//! | `train/…`, such as `train/kl` | the learner's metrics, by its own names | every iteration |
//! | `reward/…`, such as `reward/forward` | the terms of the reward | every iteration |
//! | `design/…`, such as `design/stiffness_total` | the design totals, SI | every iteration |
//! | `evaluation/return`, `evaluation/discounted_return` | the means of the evaluation | the last |
//! | `evaluation/median_discounted_return`, `evaluation/worst_discounted_return` | over its episodes | the last |
//!
//! In a folder that has event files already, a training begins with a `session_log` (message, 7) whose `status` (enum, 1) is
//! `START`: readers then drop from the older files what comes behind the checkpoint that it goes on from, or all of it where
//! it begins anew.
//!
//! The step of a scalar is the number of simulator steps so far. A value that is not finite is left out.

use std::fs::{self, File};
use std::io::{self, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::time::{SystemTime, UNIX_EPOCH};

use hwasp_training::{Event, Observer, ObserverError};
use thiserror::Error;

/// How the name of an event file begins; the time follows.
const PREFIX: &str = "events.out.tfevents.";

/// Why an event file cannot be written.
#[derive(Debug, Error)]
#[error("cannot write {path}: {source}")]
pub struct TensorBoardError {
    /// The file or its folder.
    path: PathBuf,
    /// What the system says.
    source: io::Error,
}

/// An [`Observer`] that writes `events.out.tfevents.<unix seconds>.hwasp`. What cannot be written is left out.
#[derive(Debug)]
pub struct TensorBoard {
    path: PathBuf,
    file: File,
    /// Bytes of whole records.
    length: u64,
    /// Tags of the learner's metrics and of the design totals.
    tags: Vec<String>,
    /// Whether there are older files in the folder.
    has_older: bool,
    env_steps: u64,
    /// When the last record was written, s since 1970: never before the one before it, wherever the clock is set.
    wall_time: f64,
    /// Whether the last record could not be written.
    failing: bool,
}

impl TensorBoard {
    /// Begins a file in `folder`, which is created where it is missing.
    pub fn create(folder: &Path) -> Result<Self, TensorBoardError> {
        fs::create_dir_all(folder).map_err(|source| TensorBoardError { path: folder.to_owned(), source })?;
        // Readers take the files of a folder in the order of their names, and the clock may have been set back since the last.
        let latest = latest(folder).map_err(|source| TensorBoardError { path: folder.to_owned(), source })?;
        let now = if latest < now() { now() } else { latest + 1.0 };
        let path = folder.join(format!("{PREFIX}{now:.6}.hwasp"));
        let file = File::create_new(&path).map_err(|source| TensorBoardError { path: path.clone(), source })?;
        let has_older = latest > 0.0;
        let (tags, wall_time) = (Vec::new(), now);
        let mut board = Self { path, file, length: 0, tags, has_older, env_steps: 0, wall_time, failing: false };
        board.write(&version(now))?;
        Ok(board)
    }

    /// The file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// One record in one piece, so that a killed run leaves whole records behind.
    fn write(&mut self, event: &[u8]) -> Result<(), TensorBoardError> {
        let record = record(event);
        let written = self.file.write_all(&record);
        if written.is_ok() {
            self.length += record.len() as u64;
        } else {
            // Half a record would be taken for the beginning of the next.
            let _ = self.file.set_len(self.length).and_then(|()| self.file.seek(SeekFrom::Start(self.length)));
        }
        written.map_err(|source| TensorBoardError { path: self.path.clone(), source })
    }

    /// The time of a record.
    fn tick(&mut self) -> f64 {
        self.wall_time = now().max(self.wall_time);
        self.wall_time
    }

    fn scalars<'a>(&mut self, scalars: impl Iterator<Item = (&'a str, f64)>) -> Result<(), TensorBoardError> {
        let now = self.tick();
        match summary(now, self.env_steps, scalars) {
            Some(event) => self.write(&event),
            None => Ok(()),
        }
    }
}

impl Observer for TensorBoard {
    fn on(&mut self, event: Event<'_>) -> Result<(), ObserverError> {
        let written = match event {
            Event::Started { learner, terms, totals, resumed, .. } => {
                let learner = learner.iter().map(|name| format!("train/{name}"));
                let terms = terms.iter().map(|name| format!("reward/{name}"));
                self.tags = learner.chain(terms).chain(totals.iter().map(|name| format!("design/{name}"))).collect();
                let now = self.tick();
                // A training that was killed before its first checkpoint is not resumed, it begins anew; its points are there.
                match resumed.map(|env_steps| env_steps + 1).or(self.has_older.then_some(0)) {
                    Some(first) => self.write(&session(now, first)),
                    None => Ok(()),
                }
            }
            Event::Iteration(row) => {
                self.env_steps = row.env_steps;
                let train = [
                    ("train/return", row.undiscounted_return),
                    ("train/discounted_return", row.discounted_return),
                    ("train/episodes", row.episodes),
                    ("train/episode_steps", row.episode_steps),
                    ("noise/command", row.noise.command),
                    ("noise/effort", row.noise.effort),
                    ("noise/design", row.noise.design),
                ];
                let tags = self.tags.clone();
                let values = row.learner.iter().chain(&row.terms).chain(&row.design_totals).copied();
                self.scalars(train.into_iter().chain(tags.iter().map(String::as_str).zip(values)))
            }
            Event::Evaluated(evaluation) => self.scalars(
                [
                    ("evaluation/return", evaluation.undiscounted_return.mean),
                    ("evaluation/discounted_return", evaluation.discounted_return.mean),
                    ("evaluation/median_discounted_return", evaluation.median_discounted_return),
                    ("evaluation/worst_discounted_return", evaluation.worst_discounted_return),
                ]
                .into_iter(),
            ),
            Event::Checkpoint(_) | Event::Failed(_) | Event::Evaluating => Ok(()),
        };
        if let Err(error) = &written
            && !self.failing
        {
            tracing::warn!("{error}; training goes on, what belongs there is left out");
        }
        self.failing = written.is_err();
        Ok(())
    }
}

/// The latest time of the event files of a folder: when one was begun, which its name says, or last written to. 1970 where there
/// is none.
fn latest(folder: &Path) -> io::Result<f64> {
    let mut latest = 0.0_f64;
    for entry in fs::read_dir(folder)? {
        let entry = entry?;
        let name = entry.file_name();
        let stamp =
            name.to_str().and_then(|name| name.strip_prefix(PREFIX)?.strip_suffix(".hwasp")?.parse::<f64>().ok());
        // Other files say nothing about this training.
        let Some(begun) = stamp.filter(|stamp| stamp.is_finite()) else { continue };
        let written = entry.metadata()?.modified().ok().and_then(|time| time.duration_since(UNIX_EPOCH).ok());
        latest = latest.max(begun).max(written.map_or(0.0, |since| since.as_secs_f64()));
    }
    Ok(latest)
}

/// Seconds since 1970, UTC.
fn now() -> f64 {
    SystemTime::now().duration_since(UNIX_EPOCH).map_or(0.0, |since| since.as_secs_f64())
}

/// CRC-32C as the format wants it: of data that may itself hold checksums, turned and shifted.
fn masked_crc(bytes: &[u8]) -> u32 {
    crc32c::crc32c(bytes).rotate_right(15).wrapping_add(0xa282_ead8)
}

/// The data in its frame.
fn record(data: &[u8]) -> Vec<u8> {
    let length = (data.len() as u64).to_le_bytes();
    let mut bytes = Vec::with_capacity(data.len() + 16);
    bytes.extend(length);
    bytes.extend(masked_crc(&length).to_le_bytes());
    bytes.extend(data);
    bytes.extend(masked_crc(data).to_le_bytes());
    bytes
}

/// The event that every file begins with.
fn version(wall_time: f64) -> Vec<u8> {
    let mut event = Vec::new();
    double(&mut event, 1, wall_time);
    bytes(&mut event, 3, b"brain.Event:2");
    event
}

/// The event that says: what other files have from this step on is not true any more.
fn session(wall_time: f64, step: u64) -> Vec<u8> {
    let mut event = Vec::new();
    double(&mut event, 1, wall_time);
    key(&mut event, 2, Wire::Varint);
    varint(&mut event, step);
    // `SessionLog { status: START }`.
    bytes(&mut event, 7, &[1 << 3, 1]);
    event
}

/// An event of all scalars that are finite as `f32`; none if there are none.
fn summary<'a>(wall_time: f64, step: u64, scalars: impl Iterator<Item = (&'a str, f64)>) -> Option<Vec<u8>> {
    let mut values = Vec::new();
    for (tag, value) in scalars {
        let value = value as f32;
        if value.is_finite() {
            let mut message = Vec::new();
            bytes(&mut message, 1, tag.as_bytes());
            float(&mut message, 2, value);
            bytes(&mut values, 1, &message);
        }
    }
    if values.is_empty() {
        return None;
    }
    let mut event = Vec::new();
    double(&mut event, 1, wall_time);
    key(&mut event, 2, Wire::Varint);
    varint(&mut event, step);
    bytes(&mut event, 5, &values);
    Some(event)
}

/// How a field of a message is written (protocol buffers, "encoding").
#[derive(Clone, Copy)]
enum Wire {
    Varint = 0,
    Fixed64 = 1,
    Length = 2,
    Fixed32 = 5,
}

fn key(out: &mut Vec<u8>, field: u64, wire: Wire) {
    varint(out, field << 3 | wire as u64);
}

/// Seven bits per byte, the lowest first; the highest bit says that there is more.
fn varint(out: &mut Vec<u8>, mut value: u64) {
    while value >= 0x80 {
        out.push(value as u8 | 0x80);
        value >>= 7;
    }
    out.push(value as u8);
}

fn double(out: &mut Vec<u8>, field: u64, value: f64) {
    key(out, field, Wire::Fixed64);
    out.extend(value.to_le_bytes());
}

fn float(out: &mut Vec<u8>, field: u64, value: f32) {
    key(out, field, Wire::Fixed32);
    out.extend(value.to_le_bytes());
}

fn bytes(out: &mut Vec<u8>, field: u64, value: &[u8]) {
    key(out, field, Wire::Length);
    varint(out, value.len() as u64);
    out.extend(value);
}

#[cfg(test)]
mod tests;
