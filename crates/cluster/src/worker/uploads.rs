//! What a long job sends on the way: states, so that others can go on with it, and news.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use hwasp_algos::Archive;
use hwasp_training::collect::Watch;
use hwasp_training::{Checkpoint, Event, Observer, ObserverError};
use tokio::sync::mpsc::{UnboundedReceiver, UnboundedSender};

use crate::message::{Class, Job, News, Payload, StateNote, Task, Told, pack};
use crate::store::{Store, StoreError};
use crate::subjects;

/// Time between two states, at least.
const STATE_EVERY: Duration = Duration::from_secs(20);
/// Time between two lots of news, at least.
const NEWS_EVERY: Duration = Duration::from_secs(1);
/// Rows of a learning curve in one lot, at most.
const MOST_ROWS: usize = 1000;
/// Why no lock is poisoned.
const UNPOISONED: &str = "nothing panics while the time is looked at";

/// Something to be sent.
pub(super) enum Upload {
    /// A state: iterations done, and its bytes.
    State(u64, Vec<u8>),
    /// News without states.
    News(Vec<Told>),
}

/// What ends a job before its time.
#[derive(Default)]
pub(super) struct Ends {
    now: Arc<AtomicBool>,
    over: AtomicBool,
}

impl Ends {
    /// Ends it. `over`: nobody will go on with it, so that nothing of it is kept.
    pub(super) fn end(&self, over: bool) {
        self.over.fetch_or(over, Ordering::Relaxed);
        self.now.store(true, Ordering::Relaxed);
    }

    /// Set as soon as somebody wants it to end.
    pub(super) fn now(&self) -> Arc<AtomicBool> {
        Arc::clone(&self.now)
    }

    pub(super) fn is_over(&self) -> bool {
        self.over.load(Ordering::Relaxed)
    }
}

/// When states are sent, and what ends the job.
pub(super) struct Pace {
    /// Somebody wants it to end.
    ends: Arc<AtomicBool>,
    last: Mutex<Instant>,
    /// States on the way.
    waiting: Arc<AtomicBool>,
}

impl Pace {
    pub(super) fn new(ends: Arc<AtomicBool>) -> Self {
        Self { ends, last: Mutex::new(Instant::now()), waiting: Arc::default() }
    }

    /// Set while a state is on the way: whoever has sent it clears it.
    pub(super) fn waiting(&self) -> Arc<AtomicBool> {
        Arc::clone(&self.waiting)
    }

    fn due(&self) -> bool {
        let rested = self.last.lock().expect(UNPOISONED).elapsed() >= STATE_EVERY;
        rested && !self.waiting.load(Ordering::Relaxed)
    }

    fn sent(&self) {
        *self.last.lock().expect(UNPOISONED) = Instant::now();
        self.waiting.store(true, Ordering::Relaxed);
    }
}

/// Sends the states of a candidate's training.
pub(super) struct CandidateUploads {
    pub(super) pace: Arc<Pace>,
    pub(super) sender: UnboundedSender<Upload>,
}

impl Watch for CandidateUploads {
    fn stopped(&self) -> bool {
        self.pace.ends.load(Ordering::Relaxed)
    }

    fn due(&self) -> bool {
        self.pace.due()
    }

    fn keep(&self, state: &Archive) {
        // At the end of a training nobody needs its state. What cannot be packed or sent has to be done again after an interruption.
        if !self.due() && !self.stopped() {
            return;
        }
        if let Ok(bytes) = pack(state) {
            self.pace.sent();
            let _ = self.sender.send(Upload::State(0, bytes));
        }
    }
}

/// Sends the events of a training.
pub(super) struct TrainingUploads {
    pub(super) pace: Arc<Pace>,
    pub(super) sender: UnboundedSender<Upload>,
    news: Vec<Told>,
    last: Instant,
}

impl TrainingUploads {
    pub(super) fn new(pace: Arc<Pace>, sender: UnboundedSender<Upload>) -> Self {
        Self { pace, sender, news: Vec::new(), last: Instant::now() }
    }

    fn send(&mut self) {
        self.last = Instant::now();
        if !self.news.is_empty() {
            let _ = self.sender.send(Upload::News(std::mem::take(&mut self.news)));
        }
    }

    fn state(&mut self, checkpoint: &Checkpoint) {
        // What leads up to a state is known before it.
        self.send();
        if let Ok(bytes) = pack(checkpoint) {
            self.pace.sent();
            let _ = self.sender.send(Upload::State(checkpoint.iteration, bytes));
        }
    }
}

impl Observer for TrainingUploads {
    fn on(&mut self, event: Event<'_>) -> Result<(), ObserverError> {
        let told = match event {
            Event::Checkpoint(checkpoint) => {
                self.state(checkpoint);
                return Ok(());
            }
            Event::Iteration(row) => Told::Iteration(Box::new(row.clone())),
            Event::Started { env_steps, learner, terms, totals, .. } => Told::Started {
                env_steps,
                learner: learner.iter().map(|&name| name.to_owned()).collect(),
                terms: terms.to_vec(),
                totals: totals.to_vec(),
            },
            Event::Failed(failed) => Told::Failed {
                checkpoint: Box::new(failed.checkpoint.clone()),
                batch: failed.batch.cloned().map(Box::new),
                what: failed.what.to_owned(),
            },
            Event::Evaluating => Told::Evaluating,
            Event::Evaluated(evaluation) => Told::Evaluated(Box::new(evaluation.clone())),
        };
        let row = matches!(told, Told::Iteration(_));
        self.news.push(told);
        if !row || self.last.elapsed() >= NEWS_EVERY || self.news.len() >= MOST_ROWS {
            self.send();
        }
        Ok(())
    }

    fn due(&self) -> bool {
        self.pace.due()
    }
}

/// What a long job sends on the way.
pub(super) struct Uploads<'a> {
    pub(super) store: &'a Store,
    pub(super) job: &'a Job,
    /// How often the job was handed out.
    pub(super) delivered: u64,
    /// The subject of its states.
    pub(super) notes: String,
    /// The last state that is kept.
    pub(super) old: Option<Payload>,
}

impl Uploads<'_> {
    /// Sends until the job is over. Where the server keeps nothing, the job is ended: another worker goes on from what is kept.
    pub(super) async fn send(
        mut self,
        mut receiver: UnboundedReceiver<Upload>,
        waiting: &AtomicBool,
        ends: &Ends,
    ) -> Result<(), StoreError> {
        while let Some(upload) = receiver.recv().await {
            let sent = match upload {
                _ if ends.is_over() => Ok(()),
                Upload::News(news) => self.news(news).await,
                Upload::State(iteration, bytes) => {
                    let sent = self.state(iteration, bytes).await;
                    waiting.store(false, Ordering::Relaxed);
                    sent
                }
            };
            if sent.is_err() {
                ends.end(false);
                return sent;
            }
        }
        Ok(())
    }

    async fn news(&self, news: Vec<Told>) -> Result<(), StoreError> {
        let (store, run) = (self.store, &self.job.run);
        let Ok(bytes) = pack(&News(news)) else { return Ok(()) };
        let payload = store.put(run, Class::Run, bytes).await?;
        let Ok(bytes) = pack(&payload) else { return Ok(()) };
        let subject = subjects::said(run, "news", &self.job.name);
        store.publish(&subject, bytes.into(), None).await.map(drop)
    }

    async fn state(&mut self, iteration: u64, bytes: Vec<u8>) -> Result<(), StoreError> {
        let (store, run) = (self.store, &self.job.run);
        let state = store.put(run, Class::Run, bytes).await?;
        let note = StateNote { delivered: self.delivered, iteration, state: state.clone() };
        let Ok(bytes) = pack(&note) else { return Ok(()) };
        let sequence = store.publish(&self.notes, bytes.into(), None).await?.sequence;
        if matches!(self.job.task, Task::Training { .. }) {
            self.news(vec![Told::Checkpoint { iteration, state: state.clone() }]).await?;
        }
        // The one before is not needed any more.
        store.remove_before(&self.notes, sequence).await;
        if let Some(old) = self.old.replace(state).filter(|old| Some(old) != self.old.as_ref()) {
            store.drop(run, &old).await;
        }
        Ok(())
    }
}
