//! Asking: a job goes into the queue, and its answer is waited for, whatever happens to workers and server meanwhile.

use std::collections::{BTreeMap, BTreeSet};
use std::pin::pin;
use std::sync::atomic::AtomicU64;
use std::sync::{Arc, Mutex, MutexGuard};
use std::time::{Duration, Instant};

use bytes::Bytes;
use futures_util::StreamExt;
use futures_util::future::{Either, select};
use hwasp_training::collect::{CollectError, ExperimentText};
use tokio::sync::Notify;

use super::crew::{Crew, call};
use super::run::{self, RunName};
use super::waiting::Waiting;
use crate::error::ClusterError;
use crate::identity::Identity;
use crate::message::{Class, Envelope, Job, Kept, Named, Payload, Task, pack, unpack};
use crate::store::{INLINE, Store};
use crate::subjects;

/// Time between two looks after an answer that does not come, at first and at last.
const LOOKS: [Duration; 2] = [Duration::from_secs(2), Duration::from_secs(30)];
/// Time between two calls of workers while somebody waits.
const CALLS: Duration = Duration::from_secs(3);
/// When a job is late: so many times what others of its kind take, and so long at least.
const LATE: (f64, Duration) = (4.0, Duration::from_secs(10));
/// How long the server may take to hear that a run is over, or stopped. What it does not hear ages.
const FAREWELL: Duration = Duration::from_secs(10);
/// How long nobody may be there before it is told.
const ALONE: Duration = Duration::from_secs(5);
/// Why no lock is poisoned.
const UNPOISONED: &str = "nothing panics while a list is locked";

/// An answer: its bytes, and the seconds that it took.
pub(crate) struct Reply {
    pub(crate) content: Bytes,
    pub(crate) seconds: f64,
}

/// What a job names, and for how long it is kept.
#[derive(Clone)]
pub(crate) struct Need {
    class: Class,
    bytes: Bytes,
}

/// Asks workers about one run.
pub(crate) struct Asker {
    pub(crate) store: Store,
    pub(crate) identity: Identity,
    digest: String,
    pub(crate) run: String,
    /// How the server is named on a command line.
    options: String,
    patience: Duration,
    /// Who waits for which job.
    waiting: Waiting,
    /// Who waits for news of which job.
    news: Mutex<BTreeMap<String, Arc<Notify>>>,
    /// Jobs whose answers were there before we began.
    before: BTreeSet<String>,
    /// Experiments that are kept.
    experiments: Mutex<Vec<(ExperimentText, Kept, Need)>>,
    /// Seconds of each kind of job, a running mean.
    times: Mutex<BTreeMap<&'static str, f64>>,
    crew: Mutex<Crew>,
    /// When somebody was heard of.
    sign: Mutex<Instant>,
    /// What was told already.
    told: Mutex<BTreeSet<String>>,
    /// Told when the connection is there again: answers may have been missed.
    back: Notify,
    /// The number of the stream up to which answers are in the checkpoint before the last.
    mark: AtomicU64,
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().expect(UNPOISONED)
}

pub(super) fn unanswered(why: impl std::fmt::Display) -> CollectError {
    CollectError::Unanswered(why.to_string())
}

impl Asker {
    pub(super) async fn new(
        store: Store,
        identity: Identity,
        run: RunName,
        patience: Duration,
        (address, options): (&str, &str),
    ) -> Result<Arc<Self>, ClusterError> {
        let queue = |why: String| ClusterError::Queue { address: address.to_owned(), why };
        let run = run.as_str().to_owned();
        let before = run::answered(&store, &run).await.map_err(queue)?;
        let asker = Arc::new(Self {
            digest: identity.digest(),
            identity,
            options: options.to_owned(),
            patience,
            waiting: Waiting::default(),
            news: Mutex::default(),
            before,
            experiments: Mutex::default(),
            times: Mutex::default(),
            crew: Mutex::default(),
            sign: Mutex::new(Instant::now()),
            told: Mutex::default(),
            back: Notify::new(),
            mark: AtomicU64::new(0),
            store,
            run,
        });
        asker.listen().await.map_err(queue)?;
        asker.look_round().await;
        let called = Arc::clone(&asker);
        tokio::spawn(async move {
            let mut before = called.store.connects();
            loop {
                tokio::time::sleep(CALLS).await;
                let now = called.store.connects();
                if std::mem::replace(&mut before, now) != now {
                    called.back.notify_waiters();
                }
                if !called.waiting.is_empty() {
                    called.look_round().await;
                }
            }
        });
        Ok(asker)
    }

    pub(super) fn crew(&self) -> Crew {
        lock(&self.crew).clone()
    }

    /// Hands answers and news on as they come. Those that get lost on the way are looked for later.
    async fn listen(self: &Arc<Self>) -> Result<(), String> {
        let said = |what| subjects::said(&self.run, what, "*");
        let subscribe = |subject| self.store.client.subscribe(subject);
        let mut answers = subscribe(said("answer")).await.map_err(|error| error.to_string())?;
        let mut news = subscribe(said("news")).await.map_err(|error| error.to_string())?;
        let asker = Arc::clone(self);
        tokio::spawn(async move {
            while let Some(message) = answers.next().await {
                asker.take(&message.payload);
            }
        });
        let asker = Arc::clone(self);
        tokio::spawn(async move {
            while let Some(message) = news.next().await {
                let job = message.subject.as_str().rsplit('.').next().unwrap_or_default();
                *lock(&asker.sign) = Instant::now();
                if let Some(notify) = lock(&asker.news).get(job) {
                    notify.notify_one();
                }
            }
        });
        Ok(())
    }

    /// Takes an answer.
    fn take(&self, bytes: &Bytes) {
        let envelope: Envelope = match unpack(bytes) {
            Ok(envelope) => envelope,
            Err(why) => {
                return self.tell_once("stranger", || {
                    tracing::warn!("a message among the answers is none ({why}); it is dropped");
                });
            }
        };
        *lock(&self.sign) = Instant::now();
        self.waiting.hand(&envelope);
    }

    fn tell_once(&self, what: &str, tell: impl FnOnce()) {
        if lock(&self.told).insert(what.to_owned()) {
            tell();
        }
    }

    /// Calls the workers.
    async fn look_round(&self) {
        let Ok(cards) = call(&self.store, Some(&self.identity)).await else { return };
        let crew = Crew::of(&cards, &self.identity, &self.run);
        for (name, differs) in &crew.refused {
            self.tell_once(&format!("refused {name}"), || {
                tracing::warn!("the worker {name} gets no jobs, for it would not give the same bits: it has {differs}");
            });
        }
        if crew.workers > 0 || !crew.at_work.is_empty() {
            *lock(&self.sign) = Instant::now();
            lock(&self.told).remove("alone");
        }
        *lock(&self.crew) = crew;
    }

    /// The mean time of jobs of a kind, s.
    pub(super) fn time(&self, kind: &str) -> Option<f64> {
        lock(&self.times).get(kind).copied()
    }

    fn timed(&self, kind: &'static str, seconds: f64) {
        let mut times = lock(&self.times);
        let mean = times.entry(kind).or_insert(seconds);
        *mean += 0.2 * (seconds - *mean);
    }

    /// Keeps an experiment, once.
    pub(super) async fn experiment(&self, text: &ExperimentText) -> Result<(Kept, Need), CollectError> {
        let known = lock(&self.experiments).iter().find(|known| known.0 == *text).cloned();
        if let Some((_, kept, need)) = known {
            return Ok((kept, need));
        }
        let bytes = pack(&Named(text.clone())).map_err(unanswered)?;
        let (kept, need) = self.put_always(Class::Run, bytes).await?;
        lock(&self.experiments).push((text.clone(), kept.clone(), need.clone()));
        Ok((kept, need))
    }

    async fn keep(&self, need: &Need) -> Result<Kept, CollectError> {
        let kept = self.store.keep(&self.run, need.class, need.bytes.clone()).await;
        kept.map_err(unanswered)
    }

    /// Keeps bytes that a job needs, unless they are few.
    pub(super) async fn put(&self, class: Class, bytes: Vec<u8>) -> Result<(Payload, Option<Need>), CollectError> {
        if bytes.len() <= INLINE {
            return Ok((Payload::Here(bytes), None));
        }
        let (kept, need) = self.put_always(class, bytes).await?;
        Ok((Payload::Kept(kept), Some(need)))
    }

    /// Keeps bytes that a job needs.
    pub(super) async fn put_always(&self, class: Class, bytes: Vec<u8>) -> Result<(Kept, Need), CollectError> {
        let need = Need { class, bytes: bytes.into() };
        Ok((self.keep(&need).await?, need))
    }

    /// A job.
    pub(super) fn job(&self, experiment: Kept, task: Task) -> Result<Job, CollectError> {
        let name = task.name(&self.digest, &experiment).map_err(unanswered)?;
        Ok(Job { identity: self.digest.clone(), run: self.run.clone(), name, experiment, task })
    }

    /// Asks for a job, and waits for the bytes of its answer. `needs`: what the job names, to be kept once more should the server have
    /// lost it.
    pub(super) async fn ask(&self, job: &Job, needs: &[Need]) -> Result<Reply, CollectError> {
        let reply = self.asked(job, needs).await;
        self.waiting.tidy(&job.name);
        reply
    }

    async fn asked(&self, job: &Job, needs: &[Need]) -> Result<Reply, CollectError> {
        let (kind, began) = (job.task.kind(), Instant::now());
        let mut receiver = self.waiting.wait_for(&job.name);
        if self.before.contains(&job.name)
            && let Some(reply) = self.look(job).await?
        {
            return Ok(reply);
        }
        // Whoever asked before us may be gone, and a worker be at it still.
        let mut sequence = if self.is_at_work(job) { None } else { Some(self.publish(job, 0).await?) };
        let (mut look, mut asked) = (LOOKS[0], 1_u32);
        loop {
            let back = pin!(self.back.notified());
            let found = match tokio::time::timeout(look, select(&mut receiver, back)).await {
                Ok(Either::Left((Ok(envelope), _))) => {
                    let reply = self.reply(&envelope).await;
                    if reply.is_none() {
                        // Its bytes are lost; it is asked for once more.
                        receiver = self.waiting.wait_for(&job.name);
                    }
                    reply
                }
                // Nobody hands an envelope on any more: the list was cleared.
                Ok(Either::Left((Err(_), _))) => return Err(CollectError::Interrupted),
                Ok(Either::Right(_)) | Err(_) => self.look(job).await?,
            };
            if let Some(reply) = found {
                self.timed(kind, reply.seconds);
                return Ok(reply);
            }
            self.check_patience(job)?;
            // One who is slow may not answer a call in time: then the queue says that somebody has the job.
            let there = self.is_at_work(job) || self.queued(sequence).await;
            if there && !self.late(kind, began, asked) {
                look = (2 * look).min(LOOKS[1]);
                continue;
            }
            // It is lost, or somebody slow has it while others are idle.
            for need in needs {
                self.keep(need).await?;
            }
            sequence = Some(self.publish(job, asked).await?);
            (look, asked) = (LOOKS[0], asked + 1);
            tracing::debug!(job = job.name, "{kind} asked for again");
        }
    }

    fn is_at_work(&self, job: &Job) -> bool {
        lock(&self.crew).at_work.contains(&job.name)
    }

    /// Looks whether the answer of a job is kept.
    async fn look(&self, job: &Job) -> Result<Option<Reply>, CollectError> {
        let subject = subjects::said(&self.run, "answer", &job.name);
        let Some(bytes) = self.store.last(&subject).await.map_err(unanswered)? else { return Ok(None) };
        let Ok(envelope) = unpack::<Envelope>(&bytes) else { return Ok(None) };
        Ok(self.reply(&envelope).await)
    }

    /// An answer; none where its bytes are not kept any more.
    async fn reply(&self, envelope: &Envelope) -> Option<Reply> {
        match self.store.get(&self.run, &envelope.content).await {
            Ok(content) => Some(Reply { content, seconds: envelope.seconds }),
            Err(error) => {
                tracing::debug!(job = envelope.job, worker = envelope.worker, "an answer cannot be read: {error}");
                None
            }
        }
    }

    /// Wakes who is returned when news of a job come.
    pub(super) fn announce(&self, job: &str) -> Arc<Notify> {
        Arc::clone(lock(&self.news).entry(job.to_owned()).or_default())
    }

    pub(super) fn silence(&self, job: &str) {
        lock(&self.news).remove(job);
    }

    async fn publish(&self, job: &Job, asked: u32) -> Result<u64, CollectError> {
        let subject = subjects::jobs(&self.digest, &self.run);
        let bytes = Bytes::from(pack(job).map_err(unanswered)?);
        let id = format!("{}-{}-{asked}", self.run, job.name);
        let mut sent = self.store.publish(&subject, bytes.clone(), Some(&id)).await.map_err(unanswered)?;
        // Somebody asked for it a moment ago, and since then it was done and forgotten.
        if sent.duplicate && !self.queued(Some(sent.sequence)).await {
            sent = self.store.publish(&subject, bytes, None).await.map_err(unanswered)?;
        }
        Ok(sent.sequence)
    }

    /// Whether a job still waits in the queue, or is handed out.
    async fn queued(&self, sequence: Option<u64>) -> bool {
        let Some(sequence) = sequence else { return false };
        let Ok(jobs) = self.store.jobs().await else { return true };
        match jobs.get_raw_message(sequence).await {
            Ok(_) => true,
            Err(error) => {
                use async_nats::jetstream::stream::LastRawMessageErrorKind as Kind;
                !matches!(error.kind(), Kind::NoMessageFound)
            }
        }
    }

    /// Whether somebody has had a job for so long that others may try.
    fn late(&self, kind: &'static str, began: Instant, asked: u32) -> bool {
        let usual = self.time(kind).unwrap_or(f64::INFINITY) * LATE.0 * f64::from(asked);
        let idle = lock(&self.crew).idle > 0;
        idle && began.elapsed().as_secs_f64() > usual.max(LATE.1.as_secs_f64())
    }

    /// Ends the wait where nobody was heard of for too long.
    fn check_patience(&self, job: &Job) -> Result<(), CollectError> {
        let silent = lock(&self.sign).elapsed();
        if silent >= self.patience {
            return Err(unanswered(format!(
                "no worker was heard of for {:.0} s, and a job waits ({}); `hwasp cluster status {}` says who is there",
                silent.as_secs_f64(),
                job.task.kind(),
                self.options
            )));
        }
        if silent >= ALONE {
            self.tell_once("alone", || {
                tracing::warn!(
                    "no worker is there; `hwasp worker {}` starts one. It is waited for, for {:.0} s",
                    self.options,
                    self.patience.as_secs_f64()
                );
            });
        }
        Ok(())
    }

    /// Removes answers that were in a checkpoint already when this was called before.
    pub(super) async fn settle(&self) {
        run::settle(&self.store, &self.run, &self.mark).await;
    }

    pub(super) async fn stop_run(self: Arc<Self>) {
        let _ = tokio::time::timeout(FAREWELL, run::end(&self.store, &self.digest, &self.run, &[])).await;
        self.waiting.clear();
    }

    pub(super) async fn forget_run(self: Arc<Self>) {
        let _ = tokio::time::timeout(FAREWELL, run::forget(&self.store, &self.digest, &self.run)).await;
    }
}
