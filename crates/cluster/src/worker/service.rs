//! The queue's side: jobs are taken, kept alive, and given back.

use std::collections::BTreeMap;
use std::pin::pin;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use async_nats::jetstream::consumer::PullConsumer;
use async_nats::jetstream::{AckKind, Message};
use futures_util::StreamExt;
use hwasp_experiment::Catalogue;
use tokio::task::JoinHandle;

use super::card::{AtWork, Card};
use super::uploads::Ends;
use super::work::Work;
use super::{Served, WorkerOptions, lock};
use crate::error::ClusterError;
use crate::identity::Identity;
use crate::message::{Job, PROGRESS, pack, unpack};
use crate::store::Store;
use crate::subjects;

/// How long one request for a job waits at the server.
const PULL: Duration = Duration::from_secs(10);
/// Pause after something that failed.
const PAUSE: Duration = Duration::from_secs(1);
/// Programs of other identities that were told of, and are not told of again.
const STRANGERS: usize = 8;

/// Jobs at work by their numbers, when they began, and what ends them.
type Jobs = BTreeMap<u64, (AtWork, Instant, Arc<Ends>)>;

/// A worker at work.
pub(super) struct Service {
    name: String,
    threads: usize,
    pub(super) store: Store,
    work: Work,
    identity: Identity,
    digest: String,
    at_work: Mutex<Jobs>,
    draining: Arc<AtomicBool>,
    began: Instant,
    numbers: AtomicU64,
    jobs: AtomicU64,
    busy_ms: AtomicU64,
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
            work: Work::new(&options.name, store.clone(), catalogue),
            store,
            digest: identity.digest(),
            identity,
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
                    strangers.truncate(STRANGERS - 1);
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
                        ends.end(stop.payload == subjects::OVER);
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
            ends.end(false);
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
        let (began, connects) = (Instant::now(), self.store.connects());
        loop {
            match tokio::time::timeout(super::LOOK, batch.next()).await {
                Ok(None) => return Ok(None),
                Ok(Some(message)) => return message.map(Some).map_err(|error| error.to_string()),
                Err(_) if self.drains() => return Ok(None),
                // A server that went away has forgotten who waits, and does not say that the time is over.
                Err(_) if began.elapsed() > PULL + PAUSE || self.store.connects() != connects => {
                    return Err("the server does not answer".to_owned());
                }
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
        let ends = Arc::new(Ends::default());
        let (number, began) = (self.numbers.fetch_add(1, Ordering::Relaxed), Instant::now());
        let (name, run, kind) = (job.name.clone(), job.run.clone(), job.task.kind());
        let at_work = AtWork { job: name.clone(), run: run.clone(), kind: kind.to_owned(), seconds: 0.0 };
        lock(&self.at_work).insert(number, (at_work, began, Arc::clone(&ends)));
        if self.drains() {
            self.drain();
        }
        let done = {
            let work = pin!(self.work.finish(job, delivered, &ends));
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
                tracing::info!(
                    worker = self.name,
                    job = name,
                    run,
                    seconds,
                    "{kind} given up: whoever asked for it has stopped"
                );
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
}
