//! The work itself.

use std::collections::BTreeMap;
use std::pin::pin;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard};
use std::time::{Duration, Instant};

use async_nats::jetstream::consumer::PullConsumer;
use async_nats::jetstream::{AckKind, Message};
use bytes::Bytes;
use futures_util::StreamExt;
use hwasp_experiment::Catalogue;
use hwasp_training::collect::{Answer, CandidateRequest, CollectError, EpisodesRequest, ExperimentText, Request};
use hwasp_training::{Checkpoint, TrainError, Worker};
use tokio::sync::mpsc::{UnboundedReceiver, unbounded_channel};
use tokio::task::JoinHandle;

use super::card::{AtWork, Card};
use super::uploads::{CandidateUploads, Pace, TrainingUploads, Upload};
use super::{Served, WorkerOptions};
use crate::error::ClusterError;
use crate::identity::Identity;
use crate::message::{
    Block, Class, Content, Envelope, Job, Kept, Named, News, PROGRESS, Params, Payload, State, StateNote, Task, Told,
    TrainingAnswer, pack, unpack,
};
use crate::store::{Store, StoreError};
use crate::subjects;

/// How long one request for a job waits at the server.
const PULL: Duration = Duration::from_secs(10);
/// Pause after something that failed.
const PAUSE: Duration = Duration::from_secs(1);
/// Workers that may begin a job and not come to its end, without a step forward.
const MOST_BEGINNINGS: u64 = 8;
/// Experiments and sets of parameters that are kept for the next job.
const REMEMBERED: usize = 8;
/// Why no lock is poisoned.
const UNPOISONED: &str = "nothing panics while a list is locked";

/// A worker at work.
pub(super) struct Service {
    name: String,
    threads: usize,
    pub(super) store: Store,
    identity: Identity,
    digest: String,
    catalogue: Catalogue,
    /// Another one after a panic.
    worker: Mutex<Arc<Worker>>,
    experiments: Mutex<Vec<(String, ExperimentText)>>,
    params: Mutex<Vec<(String, Arc<Vec<f32>>)>>,
    at_work: Mutex<BTreeMap<u64, Running>>,
    draining: Arc<AtomicBool>,
    began: Instant,
    numbers: AtomicU64,
    jobs: AtomicU64,
    busy_ms: AtomicU64,
}

/// A job at work: what is said of it, since when, and what ends it.
type Running = (AtWork, Instant, Arc<AtomicBool>);

/// What became of a job.
enum Outcome {
    /// This is to be kept.
    Answered(Envelope),
    /// Its answer is there already.
    There,
    /// Somebody wants it to end here.
    Interrupted,
    /// What it needs is gone, or cannot be read.
    Lost(String),
    /// The server keeps nothing, or says nothing.
    Away(String),
}

impl From<StoreError> for Outcome {
    fn from(error: StoreError) -> Self {
        match error {
            StoreError::Away { .. } => Self::Away(error.to_string()),
            StoreError::Gone | StoreError::Other => Self::Lost(error.to_string()),
        }
    }
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().expect(UNPOISONED)
}

/// Remembers the last few.
fn remember<T: Clone>(list: &Mutex<Vec<(String, T)>>, hash: &str, value: T) {
    let mut list = lock(list);
    list.retain(|known| known.0 != hash);
    list.truncate(REMEMBERED - 1);
    list.insert(0, (hash.to_owned(), value));
}

fn remembered<T: Clone>(list: &Mutex<Vec<(String, T)>>, hash: &str) -> Option<T> {
    lock(list).iter().find(|known| known.0 == hash).map(|known| known.1.clone())
}

impl Service {
    pub(super) fn new(
        options: &WorkerOptions,
        store: Store,
        catalogue: &Catalogue,
        identity: Identity,
        draining: Arc<AtomicBool>,
    ) -> Arc<Self> {
        Arc::new(Self {
            name: options.name.clone(),
            threads: options.threads.get(),
            store,
            digest: identity.digest(),
            identity,
            worker: Mutex::new(Arc::new(Worker::new(catalogue.clone()))),
            catalogue: catalogue.clone(),
            experiments: Mutex::default(),
            params: Mutex::default(),
            at_work: Mutex::default(),
            draining,
            began: Instant::now(),
            numbers: AtomicU64::new(0),
            jobs: AtomicU64::new(0),
            busy_ms: AtomicU64::new(0),
        })
    }

    pub(super) fn served(&self) -> Served {
        let seconds = self.busy_ms.load(Ordering::Relaxed) as f64 / 1e3;
        Served { jobs: self.jobs.load(Ordering::Relaxed), seconds }
    }

    /// Answers those who call, and hears of runs that are stopped.
    pub(super) async fn listen(self: &Arc<Self>) -> Result<[JoinHandle<()>; 2], ClusterError> {
        let queue = |why: &dyn std::fmt::Display| ClusterError::Queue { address: String::new(), why: why.to_string() };
        let client = &self.store.client;
        let mut calls = client.subscribe(subjects::CALL).await.map_err(|error| queue(&error))?;
        let mut stops = client.subscribe(subjects::STOPS).await.map_err(|error| queue(&error))?;
        let service = Arc::clone(self);
        let answers = tokio::spawn(async move {
            let mut strangers = Vec::new();
            while let Some(call) = calls.next().await {
                if let Ok(Some(caller)) = unpack::<Option<Identity>>(&call.payload)
                    && let Some(differs) = service.identity.differs(&caller)
                    && !strangers.contains(&caller)
                {
                    tracing::warn!(
                        worker = service.name,
                        "somebody asks whose jobs this worker refuses: it has {differs}"
                    );
                    strangers.truncate(REMEMBERED - 1);
                    strangers.insert(0, caller);
                }
                if let (Some(to), Ok(card)) = (call.reply, pack(&service.card())) {
                    let _ = service.store.client.publish(to, card.into()).await;
                }
            }
        });
        let service = Arc::clone(self);
        let ends = tokio::spawn(async move {
            while let Some(stop) = stops.next().await {
                let run = stop.subject.as_str().rsplit('.').next().unwrap_or_default();
                for (at_work, _, ends) in lock(&service.at_work).values() {
                    if at_work.run == run {
                        ends.store(true, Ordering::Relaxed);
                    }
                }
            }
        });
        Ok([answers, ends])
    }

    fn card(&self) -> Card {
        let at_work = lock(&self.at_work);
        let at_work = at_work
            .values()
            .map(|(at_work, since, _)| AtWork { seconds: since.elapsed().as_secs_f64(), ..at_work.clone() });
        let Served { jobs, seconds } = self.served();
        Card {
            name: self.name.clone(),
            identity: self.identity.clone(),
            threads: self.threads,
            up_s: self.began.elapsed().as_secs_f64(),
            jobs,
            busy_s: seconds,
            draining: self.drains(),
            at_work: at_work.collect(),
        }
    }

    /// Ends what can be ended with its state.
    pub(super) fn drain(&self) {
        for (_, _, ends) in lock(&self.at_work).values() {
            ends.store(true, Ordering::Relaxed);
        }
    }

    fn drains(&self) -> bool {
        self.draining.load(Ordering::Relaxed)
    }

    /// Takes one job after the other.
    pub(super) async fn slot(self: Arc<Self>) {
        let mut consumer: Option<PullConsumer> = None;
        while !self.drains() {
            let taken = match &consumer {
                Some(consumer) => self.take(consumer).await,
                None => match self.store.consumer(&self.digest).await {
                    Ok(made) => {
                        consumer = Some(made);
                        continue;
                    }
                    Err(why) => Err(why),
                },
            };
            match taken {
                Ok(Some(message)) => self.job(message).await,
                Ok(None) => {}
                Err(why) => {
                    tracing::debug!(worker = self.name, "no job can be had: {why}");
                    // The server may have come back without it.
                    consumer = None;
                    tokio::time::sleep(PAUSE).await;
                }
            }
        }
    }

    /// Waits for a job for a while.
    async fn take(&self, consumer: &PullConsumer) -> Result<Option<Message>, String> {
        let batch = consumer.fetch().max_messages(1).expires(PULL).messages().await;
        let mut batch = batch.map_err(|error| error.to_string())?;
        let began = Instant::now();
        loop {
            match tokio::time::timeout(super::LOOK, batch.next()).await {
                Ok(None) => return Ok(None),
                Ok(Some(message)) => return message.map(Some).map_err(|error| error.to_string()),
                Err(_) if self.drains() => return Ok(None),
                // A server that went away does not say that the time is over.
                Err(_) if began.elapsed() > PULL + PAUSE => return Err("the server does not answer".to_owned()),
                Err(_) => {}
            }
        }
    }

    /// Does a job.
    async fn job(&self, message: Message) {
        let delivered = message.info().map_or(1, |info| u64::try_from(info.delivered).unwrap_or(1));
        let job: Job = match unpack(&message.payload) {
            Ok(job) => job,
            Err(why) => return self.refuse(&message, &why).await,
        };
        if let Err(why) = self.sound(&job) {
            return self.refuse(&message, &why).await;
        }
        let ends = Arc::new(AtomicBool::new(false));
        let (number, began) = (self.numbers.fetch_add(1, Ordering::Relaxed), Instant::now());
        let (name, run, kind) = (job.name.clone(), job.run.clone(), job.task.kind());
        let at_work = AtWork { job: name.clone(), run: run.clone(), kind: kind.to_owned(), seconds: 0.0 };
        lock(&self.at_work).insert(number, (at_work, began, Arc::clone(&ends)));
        if self.drains() {
            self.drain();
        }
        let done = {
            let work = pin!(self.finish(job, delivered, &ends));
            self.keep_alive(&message, work).await
        };
        lock(&self.at_work).remove(&number);
        let seconds = began.elapsed().as_secs_f64();
        let ended = match done {
            Ok(true) => {
                self.jobs.fetch_add(1, Ordering::Relaxed);
                self.busy_ms.fetch_add(began.elapsed().as_millis() as u64, Ordering::Relaxed);
                tracing::debug!(worker = self.name, job = name, run, seconds, "{kind} done");
                AckKind::Ack
            }
            Ok(false) if !self.drains() => {
                tracing::info!(worker = self.name, job = name, run, seconds, "{kind} stopped: its run was");
                AckKind::Ack
            }
            Ok(false) => {
                tracing::info!(worker = self.name, job = name, run, seconds, "{kind} given back, with its state");
                AckKind::Nak(None)
            }
            Err(why) => {
                tracing::warn!(worker = self.name, job = name, run, seconds, "{kind} given back: {why}");
                AckKind::Nak(Some(PAUSE))
            }
        };
        // One that is lost is delivered again, and finds its answer.
        let _ = message.ack_with(ended).await;
    }

    /// Tells the queue every few seconds that a job is at work.
    async fn keep_alive<F: Future + Unpin>(&self, message: &Message, mut work: F) -> F::Output {
        loop {
            match tokio::time::timeout(PROGRESS, &mut work).await {
                Ok(output) => return output,
                Err(_) => {
                    let _ = message.ack_with(AckKind::Progress).await;
                }
            }
        }
    }

    /// Whether a job is one for this worker.
    fn sound(&self, job: &Job) -> Result<(), String> {
        if job.identity != self.digest {
            return Err(format!("it is for programs of the identity {}, and this is {}", job.identity, self.digest));
        }
        let words = [&job.run, &job.name, &job.experiment.hash];
        if words.iter().any(|word| !subjects::is_word(word)) {
            return Err("it has names that are none".to_owned());
        }
        match job.task.name(&job.identity, &job.experiment) {
            Ok(name) if name == job.name => Ok(()),
            _ => Err("its name is not that of what it asks for".to_owned()),
        }
    }

    /// Drops what is no job for this worker, and tells of it.
    async fn refuse(&self, message: &Message, why: &str) {
        let printable: String = why.chars().filter(|c| !c.is_control()).take(300).collect();
        tracing::warn!(worker = self.name, "a message on {} is dropped: {printable}", message.subject);
        let _ = message.ack_with(AckKind::Term).await;
    }

    /// Works, and keeps the answer. Whether there is one.
    async fn finish(&self, job: Job, delivered: u64, ends: &Arc<AtomicBool>) -> Result<bool, String> {
        let (run, name) = (job.run.clone(), job.name.clone());
        let answer = subjects::said(&run, "answer", &name);
        let outcome = self.work(job, delivered, ends, &answer).await;
        let envelope = match outcome.unwrap_or_else(|outcome| outcome) {
            Outcome::Answered(envelope) => envelope,
            Outcome::There => return Ok(true),
            Outcome::Interrupted => return Ok(false),
            Outcome::Away(why) => return Err(why),
            Outcome::Lost(why) => {
                // Whoever asks notices that it is gone, and asks again with all that it takes.
                tracing::warn!(worker = self.name, job = name, run, "dropped: {why}");
                return Ok(true);
            }
        };
        let bytes = pack(&envelope)?;
        self.store.publish(&answer, bytes.into(), None).await.map(|_| true).map_err(|error| error.to_string())
    }

    async fn work(&self, job: Job, delivered: u64, ends: &Arc<AtomicBool>, answer: &str) -> Result<Outcome, Outcome> {
        let long = matches!(job.task, Task::Candidate { .. } | Task::Training { .. });
        if (long || delivered > 1) && self.is_answered(&job, answer).await? {
            return Ok(Outcome::There);
        }
        let note = if long { self.note(&job).await? } else { None };
        let mut seconds = 0.0;
        let content = match job.task {
            _ if delivered.saturating_sub(note.as_ref().map_or(0, |note| note.delivered)) > MOST_BEGINNINGS => {
                let why = format!("{MOST_BEGINNINGS} workers began it, one after the other, and none came to its end");
                Some(match job.task {
                    Task::Training { .. } => pack(&TrainingAnswer::Setup(why)),
                    _ => pack(&Content::Err(CollectError::Unanswered(why))),
                })
            }
            Task::Nothing(_) => Some(pack(&Content::Ok(Answer::Results(Vec::new())))),
            Task::Rows(ref block) => {
                let request = Request::Rows(self.request(&job, block).await?);
                Some(self.episodes(request, &mut seconds).await)
            }
            Task::Results(ref block) => {
                let request = Request::Results(self.request(&job, block).await?);
                Some(self.episodes(request, &mut seconds).await)
            }
            Task::Candidate { .. } | Task::Training { .. } => {
                let began = Instant::now();
                let content = self.long(&job, delivered, note, ends).await?;
                seconds = began.elapsed().as_secs_f64();
                content
            }
        };
        let Some(content) = content else { return Ok(Outcome::Interrupted) };
        let content = content.map_err(Outcome::Lost)?;
        let class = if matches!(job.task, Task::Training { .. }) { Class::Run } else { Class::Iteration };
        let content = self.store.put(&job.run, class, content).await?;
        Ok(Outcome::Answered(Envelope { job: job.name, worker: self.name.clone(), seconds, content }))
    }

    /// Whether the answer of a job is kept, and can be read.
    async fn is_answered(&self, job: &Job, answer: &str) -> Result<bool, StoreError> {
        let Some(bytes) = self.store.last(answer).await? else { return Ok(false) };
        let Ok(envelope) = unpack::<Envelope>(&bytes) else { return Ok(false) };
        Ok(self.store.get(&job.run, &envelope.content).await.is_ok())
    }

    /// Where a job stood when somebody kept its state.
    async fn note(&self, job: &Job) -> Result<Option<StateNote>, StoreError> {
        let bytes = self.store.last(&subjects::said(&job.run, "state", &job.name)).await?;
        Ok(bytes.and_then(|bytes| unpack(&bytes).ok()))
    }

    /// Runs a request on a thread of its own, and packs the answer there.
    async fn episodes(&self, request: Request, seconds: &mut f64) -> Result<Vec<u8>, String> {
        let worker = Arc::clone(&lock(&self.worker));
        let answered = tokio::task::spawn_blocking(move || {
            let began = Instant::now();
            let content = worker.answer(&request, &());
            (began.elapsed().as_secs_f64(), pack(&content))
        });
        match answered.await {
            Ok((took, content)) => {
                *seconds = took;
                content
            }
            Err(_) => pack(&Content::Err(self.panicked())),
        }
    }

    /// A panic leaves a worker with which nothing goes on: the next job has another one.
    fn panicked(&self) -> CollectError {
        *lock(&self.worker) = Arc::new(Worker::new(self.catalogue.clone()));
        CollectError::Setup(format!("the program of {} broke off in it (a panic); its log says where", self.name))
    }

    async fn request(&self, job: &Job, block: &Block) -> Result<EpisodesRequest, Outcome> {
        let experiment = self.experiment(&job.run, &job.experiment).await?;
        let params = self.params(&job.run, &block.params).await?;
        Ok(EpisodesRequest {
            experiment,
            stage: block.stage.clone(),
            params: params.to_vec(),
            episodes: block.episodes.clone(),
            steps: block.steps,
            lanes: block.lanes,
        })
    }

    async fn experiment(&self, run: &str, kept: &Kept) -> Result<ExperimentText, Outcome> {
        if let Some(known) = remembered(&self.experiments, &kept.hash) {
            return Ok(known);
        }
        let bytes = self.store.kept(run, kept).await?;
        let Named(text) = unpack(&bytes).map_err(Outcome::Lost)?;
        remember(&self.experiments, &kept.hash, text.clone());
        Ok(text)
    }

    async fn params(&self, run: &str, payload: &Payload) -> Result<Arc<Vec<f32>>, Outcome> {
        let hash = match payload {
            Payload::Kept(kept) => Some(&kept.hash),
            Payload::Here(_) => None,
        };
        if let Some(known) = hash.and_then(|hash| remembered(&self.params, hash)) {
            return Ok(known);
        }
        let bytes = self.store.get(run, payload).await?;
        let Params(params) = unpack(&bytes).map_err(Outcome::Lost)?;
        let params = Arc::new(params);
        if let Some(hash) = hash {
            remember(&self.params, hash, Arc::clone(&params));
        }
        Ok(params)
    }

    /// A training, of a candidate or a whole one; no content where it was interrupted.
    async fn long(
        &self,
        job: &Job,
        delivered: u64,
        note: Option<StateNote>,
        ends: &Arc<AtomicBool>,
    ) -> Result<Option<Result<Vec<u8>, String>>, Outcome> {
        let experiment = self.experiment(&job.run, &job.experiment).await?;
        // A state that is gone or no state has to be done again.
        let state = match &note {
            Some(note) => self.store.get(&job.run, &note.state).await.ok(),
            None => None,
        };
        let pace = Arc::new(Pace::new(Arc::clone(ends)));
        let (sender, receiver) = unbounded_channel();
        let worker = Arc::clone(&lock(&self.worker));
        let notes = subjects::said(&job.run, "state", &job.name);
        let uploads = Uploads { service: self, job, delivered, notes, old: note.map(|note| note.state) };
        let waiting = pace.waiting();
        match &job.task {
            Task::Candidate { design, seed, env_steps, from } => {
                let given = self.given(job, from.as_ref()).await?;
                let from = state.and_then(|bytes| unpack::<State>(&bytes).ok()).or(read(given)?);
                let (design, seed, env_steps) = (design.clone(), *seed, *env_steps);
                let request = Request::Candidate(CandidateRequest { experiment, design, seed, env_steps, from });
                let watch = CandidateUploads { pace, sender };
                let done = tokio::task::spawn_blocking(move || worker.answer(&request, &watch));
                let sent = uploads.send(receiver, &waiting, ends).await;
                let done = done.await;
                sent?;
                let content = done.unwrap_or_else(|_| Err(self.panicked()));
                Ok(if content == Err(CollectError::Interrupted) { None } else { Some(pack(&content)) })
            }
            Task::Training { from } => {
                let given: Option<Checkpoint> = read(self.given(job, from.as_ref()).await?)?;
                let kept = state.and_then(|bytes| unpack::<Checkpoint>(&bytes).ok());
                // Whichever is further; both are of the same training.
                let from = kept.into_iter().chain(given).max_by_key(|checkpoint| checkpoint.iteration);
                let (stop, mut observer) = (Arc::clone(ends), TrainingUploads::new(pace, sender));
                let done =
                    tokio::task::spawn_blocking(move || worker.train(&experiment, from.as_ref(), &mut observer, &stop));
                let sent = uploads.send(receiver, &waiting, ends).await;
                let done = done.await;
                sent?;
                let answer = match done {
                    Ok(Ok(trained)) => TrainingAnswer::Trained(Box::new(trained)),
                    Ok(Err(TrainError::Interrupted { .. })) => return Ok(None),
                    Ok(Err(error @ TrainError::Assemble(_))) => TrainingAnswer::Setup(error.to_string()),
                    Ok(Err(error)) => TrainingAnswer::Failed(error.to_string()),
                    Err(_) => TrainingAnswer::Setup(self.panicked().to_string()),
                };
                Ok(Some(pack(&answer)))
            }
            Task::Rows(_) | Task::Results(_) | Task::Nothing(_) => unreachable!("short jobs are done elsewhere"),
        }
    }

    async fn given(&self, job: &Job, from: Option<&Payload>) -> Result<Option<Bytes>, Outcome> {
        match from {
            Some(payload) => Ok(Some(self.store.get(&job.run, payload).await?)),
            None => Ok(None),
        }
    }
}

fn read<T: serde::de::DeserializeOwned>(bytes: Option<Bytes>) -> Result<Option<T>, Outcome> {
    bytes.map(|bytes| unpack(&bytes).map_err(Outcome::Lost)).transpose()
}

/// What a long job sends on the way.
struct Uploads<'a> {
    service: &'a Service,
    job: &'a Job,
    delivered: u64,
    /// The subject of its states.
    notes: String,
    /// The last state that is kept.
    old: Option<Payload>,
}

impl Uploads<'_> {
    /// Sends until the job is over. Where the server keeps nothing, the job is ended: another worker goes on from what is kept.
    async fn send(
        mut self,
        mut receiver: UnboundedReceiver<Upload>,
        waiting: &AtomicBool,
        ends: &AtomicBool,
    ) -> Result<(), StoreError> {
        while let Some(upload) = receiver.recv().await {
            let sent = match upload {
                Upload::News(news) => self.news(news).await,
                Upload::State(iteration, bytes) => self.state(iteration, bytes).await,
            };
            waiting.store(false, Ordering::Relaxed);
            if sent.is_err() {
                ends.store(true, Ordering::Relaxed);
                return sent;
            }
        }
        Ok(())
    }

    async fn news(&self, news: Vec<Told>) -> Result<(), StoreError> {
        let (store, run) = (&self.service.store, &self.job.run);
        let Ok(bytes) = pack(&News(news)) else { return Ok(()) };
        let payload = store.put(run, Class::Run, bytes).await?;
        let Ok(bytes) = pack(&payload) else { return Ok(()) };
        let subject = subjects::said(run, "news", &self.job.name);
        store.publish(&subject, bytes.into(), None).await.map(drop)
    }

    async fn state(&mut self, iteration: u64, bytes: Vec<u8>) -> Result<(), StoreError> {
        let (store, run) = (&self.service.store, &self.job.run);
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
