//! Trainings: they run on a thread of their own, while the caller's thread hears of them and of signals.

use std::any::Any;
use std::num::NonZeroUsize;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, sync_channel};
use std::thread;
use std::time::Duration;

use hwasp_runs::metrics::{LEARNER, TERM};
use hwasp_session::{Session, Training, What};
use hwasp_training::{Event, Observer, ObserverError};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::catalogue::catalogue;
use crate::environment::Raised;
use crate::error::{self, Wrong};
use crate::value::kind;
use crate::{command, log};

/// The most threads that one may ask for.
const MOST_THREADS: usize = 1024;
/// How often signals are looked for where nothing happens.
const PATIENCE: Duration = Duration::from_millis(50);

/// What there is to tell.
enum News {
    /// It begins: steps that it may take, and the names of the columns of a row.
    Began { env_steps: u64, path: PathBuf, names: Vec<String> },
    /// An iteration is done. The training goes on when the answer has come.
    Row(Vec<f64>, SyncSender<()>),
}

/// Tells what happens to whoever watches from another thread.
struct Teller {
    news: Option<SyncSender<News>>,
    path: PathBuf,
}

impl Observer for Teller {
    fn on(&mut self, event: Event<'_>) -> Result<(), ObserverError> {
        let news = match event {
            Event::Started { env_steps, learner, terms, totals, .. } => {
                let fixed = hwasp_runs::metrics::FIXED_COLUMNS.iter().map(|&name| name.to_owned());
                let learner = learner.iter().map(|name| format!("{LEARNER}{name}"));
                let terms = terms.iter().map(|name| format!("{TERM}{name}"));
                let names = fixed.chain(learner).chain(terms).chain(totals.iter().cloned()).collect();
                News::Began { env_steps, path: self.path.clone(), names }
            }
            Event::Iteration(row) => {
                let mut values = vec![row.iteration as f64, row.env_steps as f64];
                values.extend(row.values());
                let (answer, answered) = sync_channel(1);
                if let Some(there) = &self.news
                    && there.send(News::Row(values, answer)).is_ok()
                {
                    // Whoever watches has gone where none comes.
                    let _ = answered.recv();
                }
                return Ok(());
            }
            _ => return Ok(()),
        };
        // A watcher that has gone stops the training by its flag, not by an error.
        if self.news.as_ref().is_some_and(|there| there.send(news).is_err()) {
            self.news = None;
        }
        Ok(())
    }
}

/// So many threads, where that may be.
pub(crate) fn sound_threads(threads: usize) -> Result<NonZeroUsize, Wrong> {
    let sound = NonZeroUsize::new(threads).filter(|threads| threads.get() <= MOST_THREADS);
    sound.ok_or_else(|| Wrong::input(format!("threads = {threads}; it is from 1 to {MOST_THREADS}")))
}

/// A training as keywords ask for it.
pub(crate) fn asked(
    py: Python<'_>,
    what: What,
    threads: usize,
    checkpoint_every: f64,
    tensorboard: bool,
) -> PyResult<Training> {
    let threads = sound_threads(threads)?;
    let checkpoint_every = Duration::try_from_secs_f64(checkpoint_every)
        .map_err(|_| error::input(format!("checkpoint_every is a time in s, not {checkpoint_every}")))?;
    Ok(Training { what, threads, elsewhere: None, checkpoint_every, tensorboard, command_line: command::line(py) })
}

/// Trains to the end. Whoever watches is called with a dict for each row, on the calling thread; where the answer is `False`
/// the training stops, and can be resumed. Returns the run folder.
pub(crate) fn train(py: Python<'_>, training: Training, watch: Option<Py<PyAny>>) -> PyResult<PathBuf> {
    log::begin();
    let session = py.detach(|| Session::begin(training, &catalogue()).map_err(Wrong::from))?;
    session.warn();
    let path = session.path().to_owned();
    let raised = Raised::of(session.assembly().experiment().task.name());
    let stop = Arc::new(AtomicBool::new(false));
    let (sender, news) = sync_channel(1);
    let teller = Teller { news: watch.is_some().then(|| sender.clone()), path: path.clone() };
    let stopped = Arc::clone(&stop);
    let work = thread::Builder::new().name("hwasp-train".to_owned()).spawn(move || {
        let (mut teller, alive) = (teller, sender);
        let ended = known_to_python(|| session.run(&mut teller, &stopped).map(drop).map_err(Wrong::from));
        drop((teller, alive));
        ended
    })?;
    let listened = listen(py, news, watch.as_ref(), Some(&stop), &raised);
    if let Err(Unheard { error, at_once: true }) = listened {
        // It finishes its iteration and its checkpoint by itself.
        return Err(error);
    }
    let ended = py.detach(|| work.join());
    // What an environment raised is the cause of whatever followed.
    if let Some(error) = raised.take() {
        return Err(error);
    }
    let ended = ended.map_err(broken)?;
    match (listened, ended) {
        (Err(Unheard { error, .. }), _) => Err(error),
        (Ok(Heard::Stopped), Err(_)) | (_, Ok(())) => Ok(path),
        (Ok(Heard::ToTheEnd), Err(error)) => Err(error.into()),
    }
}

/// How listening ended.
enum Heard {
    ToTheEnd,
    /// The watcher had enough.
    Stopped,
}

/// A signal or an exception of the watcher.
struct Unheard {
    error: PyErr,
    /// Whether the caller will not wait for the training to end.
    at_once: bool,
}

/// Hears of a training until it ends.
fn listen(
    py: Python<'_>,
    mut news: Receiver<News>,
    watch: Option<&Py<PyAny>>,
    stop: Option<&AtomicBool>,
    raised: &Raised,
) -> Result<Heard, Unheard> {
    let (mut names, mut first, mut enough) = (Vec::new(), None, false);
    loop {
        let received;
        (received, news) = py.detach(move || (news.recv_timeout(PATIENCE), news));
        let told = match received {
            Err(RecvTimeoutError::Disconnected) => break,
            Err(RecvTimeoutError::Timeout) => Ok(()),
            // Nobody is told any more of what is about to stop.
            Ok(_) if stop.is_some_and(|stop| stop.load(Ordering::Relaxed)) => Ok(()),
            Ok(News::Began { env_steps, path, names: columns }) => {
                names = columns;
                let call = || -> PyResult<()> {
                    let began = PyDict::new(py);
                    began.set_item("path", path)?;
                    began.set_item("total_env_steps", env_steps)?;
                    watch.map_or(Ok(()), |watch| watch.call1(py, (began,)).map(drop))
                };
                call()
            }
            Ok(News::Row(values, answer)) => {
                let told = watch.map_or(Ok(false), |watch| tell(py, watch, &names, &values)).map(|stops| {
                    enough |= stops;
                });
                if let (Some(stop), true) = (stop, enough || told.is_err()) {
                    stop.store(true, Ordering::Relaxed);
                }
                // The one who asked may have gone.
                let _ = answer.send(());
                told
            }
        };
        let end = || stop.map(|stop| stop.store(true, Ordering::Relaxed));
        if enough || raised.waits() {
            end();
        }
        if let Err(error) = told.and_then(|()| py.check_signals()) {
            // Nobody waits for work that cannot be stopped.
            if end().is_none() || first.is_some() {
                return Err(Unheard { error, at_once: true });
            }
            first = Some(error);
        }
    }
    match first {
        Some(error) => Err(Unheard { error, at_once: false }),
        None if enough => Ok(Heard::Stopped),
        None => Ok(Heard::ToTheEnd),
    }
}

/// Does work on a thread of its own while signals are looked for: a signal sets `stop`, and is raised when the work has ended. Work
/// that cannot be stopped is left to end by itself.
pub(crate) fn attended<T: Send + 'static>(
    py: Python<'_>,
    stop: Option<&AtomicBool>,
    raised: &Raised,
    work: impl FnOnce() -> T + Send + 'static,
) -> PyResult<T> {
    let (alive, news) = sync_channel(1);
    let work = thread::Builder::new().name("hwasp-work".to_owned()).spawn(move || {
        let _alive: SyncSender<News> = alive;
        known_to_python(work)
    })?;
    match listen(py, news, None, stop, raised) {
        Err(Unheard { error, at_once: true }) => return Err(error),
        Err(Unheard { error, .. }) => {
            let _ = py.detach(|| work.join());
            return Err(error);
        }
        Ok(_) => {}
    }
    let done = py.detach(|| work.join()).map_err(broken)?;
    raised.take().map_or(Ok(done), Err)
}

/// Does work on a thread that Python keeps its notes of: to make them anew for each call of an environment takes longer than the call.
fn known_to_python<T: Send>(work: impl FnOnce() -> T + Send) -> T {
    Python::attach(|py| py.detach(work))
}

/// A thread that panicked: a fault of the program.
fn broken(panic: Box<dyn Any + Send>) -> Wrong {
    let said = panic.downcast_ref::<String>().map(String::as_str).or_else(|| panic.downcast_ref::<&str>().copied());
    Wrong::failed(std::io::Error::other(format!("the work broke off: {}", said.unwrap_or("a panic"))))
}

/// Tells one row; whether the watcher wants the training to stop.
fn tell(py: Python<'_>, watch: &Py<PyAny>, names: &[String], values: &[f64]) -> PyResult<bool> {
    let row = PyDict::new(py);
    for (name, value) in names.iter().zip(values) {
        match &**name {
            "iteration" | "env_steps" => row.set_item(name, *value as u64)?,
            _ => row.set_item(name, value)?,
        }
    }
    let answer = watch.bind(py).call1((row,))?;
    // Python's own, or numpy's.
    Ok(matches!(&*kind(&answer), "bool" | "bool_") && !answer.is_truthy()?)
}
