//! Where remarks, warnings and errors go: standard error, and the log of a run.

use std::fmt;
use std::fs::{File, OpenOptions};
use std::io::{self, IsTerminal, Write};
use std::path::Path;
use std::sync::{Mutex, OnceLock, PoisonError};

use hwasp_settings::text::printable_lines;
use tracing::{Event, Level, Subscriber};
use tracing_subscriber::filter::{LevelFilter, filter_fn};
use tracing_subscriber::fmt::format::Writer;
use tracing_subscriber::fmt::time::{FormatTime, SystemTime};
use tracing_subscriber::fmt::{FmtContext, FormatEvent, FormatFields};
use tracing_subscriber::layer::{Layer, SubscriberExt};
use tracing_subscriber::registry::LookupSpan;
use tracing_subscriber::util::SubscriberInitExt;

use crate::args::{LogFormat, LogLevel};

/// Lines about how far a training is: on a terminal there is a bar for that.
pub(crate) const PROGRESS: &str = "progress";

static FILE: OnceLock<Mutex<File>> = OnceLock::new();

/// Whether lines begin with the time.
static TIMES: OnceLock<()> = OnceLock::new();

/// From now on lines begin with the time, as those of programs that run for days should.
#[cfg(feature = "cluster")]
pub(crate) fn with_times() {
    let _ = TIMES.set(());
}

/// To be called once, before anything is told.
pub(crate) fn begin(format: LogFormat, level: LogLevel, quiet: bool) {
    let level = match level {
        _ if quiet => LevelFilter::ERROR,
        LogLevel::Error => LevelFilter::ERROR,
        LogLevel::Warn => LevelFilter::WARN,
        LogLevel::Info => LevelFilter::INFO,
        LogLevel::Debug => LevelFilter::DEBUG,
    };
    let bar = has_terminal() && format == LogFormat::Text;
    // What the queue's client says of itself is said in our words, too.
    let ours = |event: &tracing::Metadata<'_>| !event.target().starts_with("async_nats");
    let shown = move |event: &tracing::Metadata<'_>| {
        *event.level() <= level && ours(event) && !(bar && event.target() == PROGRESS)
    };
    let base = || tracing_subscriber::fmt::layer().with_target(false).with_ansi(false).log_internal_errors(false);
    let all = move |event: &tracing::Metadata<'_>| *event.level() <= LevelFilter::DEBUG && ours(event);
    let (shown, all) = (filter_fn(shown), filter_fn(all));
    let layers = match format {
        LogFormat::Text => [
            base().event_format(Plain).with_writer(stderr).with_filter(shown).boxed(),
            base().with_writer(file).with_filter(all).boxed(),
        ],
        LogFormat::Json => [
            base().json().flatten_event(true).with_writer(stderr).with_filter(shown).boxed(),
            base().json().flatten_event(true).with_writer(file).with_filter(all).boxed(),
        ],
    };
    // It can fail only where it is called twice.
    let _ = tracing_subscriber::registry().with(Vec::from(layers)).try_init();
}

/// From now on everything goes into a file too, behind what is there already. Where that is not possible it does not.
pub(crate) fn to_file(path: &Path) {
    match OpenOptions::new().append(true).create(true).open(path) {
        Ok(file) => drop(FILE.set(Mutex::new(file))),
        Err(error) => tracing::warn!("cannot write {}: {error}", path.display()),
    }
}

/// Whether there is a terminal that can move its cursor; anything else gets lines.
pub(crate) fn has_terminal() -> bool {
    io::stderr().is_terminal() && std::env::var_os("TERM").is_some_and(|term| term != "dumb")
}

fn stderr() -> Patient<io::Stderr> {
    Patient(io::stderr())
}

fn file() -> impl Write {
    LogFile
}

/// A line of the log, which may quote other people's text, as a terminal may have it. Each comes in one piece.
fn printed(bytes: &[u8]) -> Vec<u8> {
    printable_lines(&String::from_utf8_lossy(bytes)).into_bytes()
}

/// The log of a run, once there is one.
struct LogFile;

impl Write for LogFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if let Some(file) = FILE.get() {
            // A log that cannot be written stops no training.
            let _ = file.lock().unwrap_or_else(PoisonError::into_inner).write_all(&printed(bytes));
        }
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// A reader that may have gone away: work does not stop because nobody listens.
struct Patient<W>(W);

impl<W: Write> Write for Patient<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let _ = self.0.write_all(&printed(bytes));
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// What a person reads: the words alone, behind the time where it is asked for.
struct Plain;

impl<S: Subscriber + for<'a> LookupSpan<'a>, N: for<'a> FormatFields<'a> + 'static> FormatEvent<S, N> for Plain {
    fn format_event(&self, context: &FmtContext<'_, S, N>, mut writer: Writer<'_>, event: &Event<'_>) -> fmt::Result {
        if TIMES.get().is_some() {
            SystemTime.format_time(&mut writer)?;
            writer.write_char(' ')?;
        }
        // Errors begin with the word themselves.
        match *event.metadata().level() {
            Level::WARN => writer.write_str("warning: ")?,
            Level::DEBUG => writer.write_str("debug: ")?,
            _ => {}
        }
        context.field_format().format_fields(writer.by_ref(), event)?;
        writeln!(writer)
    }
}
