//! What is kept of a run: an MCAP file, which Foxglove and Rerun open, and a CSV file beside it, which everything opens.
//!
//! The loop waits for no disk: steps go to a thread through a queue of fixed length. A log that cannot be written, and a queue that
//! overflows, are told to the rules, which put the object down: a grasp of which nothing is kept teaches nothing, and hides its
//! faults. Nothing is dangerous about it, so nothing is stopped abruptly.

mod channels;
mod csv;
mod mcap;
mod read;
mod text;

use std::fs::{self, File};
use std::io::{BufWriter, Seek, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, SyncSender, TrySendError, sync_channel};
use std::thread::JoinHandle;
use std::time::{SystemTime, UNIX_EPOCH};

use serde::{Deserialize, Serialize};

use crate::error::{DeployError, file};
use crate::record::{Event, Sink, Step};

pub use read::{Logged, LoggedObject, Row, read};

/// Steps that may wait for the disk: ten seconds.
const QUEUE: usize = 1000;

/// What a log is of.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct About {
    /// What the program was asked to do: "run", "dry-run", "shadow".
    pub what: String,
    /// The run folder.
    pub run: String,
    /// Its experiment.
    pub experiment: String,
    /// The names of what the controller sees, in order.
    pub observation: Vec<String>,
    /// The names of what it commands.
    pub command: Vec<String>,
    /// The controller's period, s.
    pub period: f64,
    /// The design as built, SI.
    pub design: Vec<f64>,
    /// Torque of the motor per current as it was calibrated, N·m/A.
    pub torque_per_current: f64,
    /// Of the spool, m.
    pub spool_radius: f64,
    /// Which way the motor winds, 1 or -1.
    pub winding_sign: f64,
    /// How it is known where the object is.
    pub object: String,
    /// SHA-256 of what the rig says of its motor.
    pub motor: String,
    /// The program's version.
    pub version: String,
}

/// Something to be kept.
#[allow(clippy::large_enum_variant, reason = "nearly all are steps, and the queue has its room once and for all")]
#[derive(Clone, Copy, Debug)]
enum Entry {
    Step(Step),
    Event(f64, u32, Event),
}

/// A file that can be written to.
pub trait Output: Write + Seek + Send {}

impl<T: Write + Seek + Send> Output for T {}

/// Writes a log on a thread of its own.
#[derive(Debug)]
pub struct LogWriter {
    queue: Option<SyncSender<Entry>>,
    lost: Arc<AtomicBool>,
    thread: Option<JoinHandle<Result<(), String>>>,
    path: PathBuf,
}

impl LogWriter {
    /// Begins `NAME.mcap` and `NAME.csv` in a folder, which is made where it is missing. Files that are there are not overwritten.
    ///
    /// # Errors
    /// Where they cannot be written.
    pub fn create(folder: &Path, name: &str, about: &About) -> Result<Self, DeployError> {
        fs::create_dir_all(folder).map_err(file("made", folder))?;
        let new = |extension: &str| {
            let path = folder.join(format!("{name}.{extension}"));
            let opened = File::create_new(&path).map_err(file("written", &path))?;
            Ok::<_, DeployError>((path, Box::new(BufWriter::new(opened)) as Box<dyn Output>))
        };
        let (path, mcap) = new("mcap")?;
        let (_, csv) = new("csv")?;
        Self::to(mcap, csv, about, path)
    }

    /// The same, to these outputs; messages name `path`.
    ///
    /// # Errors
    /// Where they cannot be begun.
    pub fn to(mcap: Box<dyn Output>, csv: Box<dyn Output>, about: &About, path: PathBuf) -> Result<Self, DeployError> {
        let unwritten =
            |error: std::io::Error| DeployError::File { action: "written", path: path.clone(), source: error };
        let mut mcap = mcap::McapLog::begin(mcap, about, epoch()).map_err(unwritten)?;
        let mut csv = csv::CsvLog::begin(csv, about).map_err(unwritten)?;
        let (queue, entries) = sync_channel(QUEUE);
        let lost = Arc::new(AtomicBool::new(false));
        let own = Arc::clone(&lost);
        let work = move || {
            let written = write(&entries, &mut mcap, &mut csv);
            own.fetch_or(written.is_err(), Ordering::Relaxed);
            written.map_err(|error| error.to_string())
        };
        let thread = std::thread::Builder::new().name("log".to_owned()).spawn(work).map_err(unwritten)?;
        Ok(Self { queue: Some(queue), lost, thread: Some(thread), path })
    }

    /// The MCAP file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Waits until all is written.
    ///
    /// # Errors
    /// Where it is not: the disk's word.
    pub fn finish(mut self) -> Result<PathBuf, DeployError> {
        self.queue = None;
        let ended = self.thread.take().map(JoinHandle::join);
        let error = match ended {
            Some(Ok(Err(text))) => text,
            Some(Err(_)) => "the thread that writes ended".to_owned(),
            _ if self.lost.load(Ordering::Relaxed) => "the disk is too slow, and steps were lost".to_owned(),
            _ => return Ok(self.path.clone()),
        };
        Err(DeployError::File { action: "written", path: self.path.clone(), source: std::io::Error::other(error) })
    }

    #[allow(clippy::large_types_passed_by_value, reason = "it goes into the queue")]
    fn send(&self, entry: Entry) {
        let Some(queue) = &self.queue else { return };
        if let Err(TrySendError::Full(_) | TrySendError::Disconnected(_)) = queue.try_send(entry) {
            self.lost.store(true, Ordering::Relaxed);
        }
    }
}

impl Drop for LogWriter {
    fn drop(&mut self) {
        self.queue = None;
        if let Some(thread) = self.thread.take() {
            // Whoever wanted to know how it went called `finish`.
            let _ = thread.join();
        }
    }
}

impl Sink for LogWriter {
    fn step(&mut self, step: &Step) {
        self.send(Entry::Step(*step));
    }

    fn event(&mut self, time: f64, episode: u32, event: Event) {
        self.send(Entry::Event(time, episode, event));
    }

    fn lost(&self) -> bool {
        self.lost.load(Ordering::Relaxed)
    }
}

/// Steps after which what is written goes to the disk: a second.
const FLUSH: u32 = 100;

fn write(entries: &Receiver<Entry>, mcap: &mut mcap::McapLog, csv: &mut csv::CsvLog) -> std::io::Result<()> {
    let mut steps = 0_u32;
    while let Ok(entry) = entries.recv() {
        match entry {
            Entry::Step(step) => {
                mcap.step(&step)?;
                csv.step(&step)?;
                steps += 1;
                if steps.is_multiple_of(FLUSH) {
                    mcap.flush()?;
                    csv.flush()?;
                }
            }
            Entry::Event(time, episode, event) => mcap.event(time, episode, event)?,
        }
    }
    csv.flush()?;
    mcap.finish()
}

/// Nanoseconds since 1970: what times in MCAP files count from.
fn epoch() -> u64 {
    SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |since| since.as_nanos() as u64)
}
