//! The work itself: a job becomes an answer that is kept.

use std::sync::{Arc, Mutex};
use std::time::Instant;

use bytes::Bytes;
use hwasp_experiment::Catalogue;
use hwasp_training::collect::{Answer, CandidateRequest, CollectError, EpisodesRequest, ExperimentText, Request};
use hwasp_training::{Checkpoint, TrainError, Worker};
use tokio::sync::mpsc::unbounded_channel;

use super::lock;
use super::uploads::{CandidateUploads, Ends, Pace, TrainingUploads, Uploads};
use crate::message::{
    Block, Class, Content, Envelope, Job, Kept, Named, Params, Payload, State, StateNote, Task, TrainingAnswer, pack,
    unpack,
};
use crate::store::{Store, StoreError};
use crate::subjects;

/// Workers that may begin a job and not come to its end, without a step forward.
const MOST_BEGINNINGS: u64 = 8;
/// Experiments and sets of parameters that are kept for the next job.
const REMEMBERED: usize = 8;

/// Does jobs, each on a thread of its own.
pub(super) struct Work {
    name: String,
    store: Store,
    catalogue: Catalogue,
    /// Another one after a panic.
    worker: Mutex<Arc<Worker>>,
    experiments: Mutex<Vec<(String, ExperimentText)>>,
    params: Mutex<Vec<(String, Arc<Vec<f32>>)>>,
}

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

impl Work {
    pub(super) fn new(name: &str, store: Store, catalogue: &Catalogue) -> Self {
        Self {
            name: name.to_owned(),
            store,
            worker: Mutex::new(Arc::new(Worker::new(catalogue.clone()))),
            catalogue: catalogue.clone(),
            experiments: Mutex::default(),
            params: Mutex::default(),
        }
    }

    /// Works, and keeps the answer. Whether there is one.
    pub(super) async fn finish(&self, job: Job, delivered: u64, ends: &Ends) -> Result<bool, String> {
        let (run, name) = (job.run.clone(), job.name.clone());
        let answer = subjects::said(&run, "answer", &name);
        let outcome = self.work(job, delivered, ends, &answer).await;
        if ends.is_over() {
            return Ok(true);
        }
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

    async fn work(&self, job: Job, delivered: u64, ends: &Ends, answer: &str) -> Result<Outcome, Outcome> {
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
        ends: &Ends,
    ) -> Result<Option<Result<Vec<u8>, String>>, Outcome> {
        let experiment = self.experiment(&job.run, &job.experiment).await?;
        // A state that is gone or no state has to be done again.
        let state = match &note {
            Some(note) => self.store.get(&job.run, &note.state).await.ok(),
            None => None,
        };
        let pace = Arc::new(Pace::new(ends.now()));
        let (sender, receiver) = unbounded_channel();
        let worker = Arc::clone(&lock(&self.worker));
        let notes = subjects::said(&job.run, "state", &job.name);
        let uploads = Uploads { store: &self.store, job, delivered, notes, old: note.map(|note| note.state) };
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
                let (stop, mut observer) = (ends.now(), TrainingUploads::new(pace, sender));
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
