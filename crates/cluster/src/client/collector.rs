//! Episodes and candidates from workers.

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};
use std::time::Duration;

use hwasp_core::{Batch, Executor};
use hwasp_training::collect::{
    Answer, CandidateAnswer, CandidateRequest, CollectError, EpisodeAnswer, EpisodesRequest, Watch,
};
use hwasp_training::{Assembly, Collector, LocalCollector};

use super::ask::{Asker, Need, Reply, unanswered};
use super::run::forget_state;
use super::{Cluster, long};
use crate::message::{Block, Class, Content, Params, Payload, Task, pack, unpack};

/// Work of less time than this is done here: the way to a worker and back takes as long. Seconds.
const NOT_WORTH_IT: f64 = 0.004;
/// A job of episodes should take so long at least, s: then the way there and back does not count.
const BLOCK: f64 = 0.03;
/// Calls of `each` at once, at most: threads that wait.
const MOST_AT_ONCE: usize = 512;
/// Sets of parameters that are remembered.
const REMEMBERED: usize = 4;
/// How often it is looked whether somebody wants a candidate to end.
const LOOK: Duration = Duration::from_millis(100);

/// Answers requests with workers. Its answers have the bits of a [`LocalCollector`].
pub struct RemoteCollector<'a> {
    cluster: &'a Cluster,
    /// Somebody wants it to end.
    stop: Option<&'a AtomicBool>,
    near: LocalCollector<'a>,
    /// Parameters that are kept, those of the last requests.
    kept: Mutex<Vec<KeptParams>>,
    /// Whether it was told that episodes run here.
    told: AtomicBool,
    /// Seconds of an episode or a step of lanes, as measured; 0 as long as nothing is known.
    pace: Mutex<f64>,
}

/// Parameters that are kept.
struct KeptParams {
    params: Arc<[f32]>,
    payload: Payload,
    need: Option<Need>,
}

/// What a request is about, and how long it takes.
fn amount(request: &EpisodesRequest) -> u64 {
    let indices = &request.episodes.indices;
    request.lanes.map_or(indices.end - indices.start, |lanes| lanes.steps)
}

impl<'a> RemoteCollector<'a> {
    pub(super) fn new(
        cluster: &'a Cluster,
        assembly: &Assembly,
        executor: &'a dyn Executor,
        stop: Option<&'a AtomicBool>,
    ) -> Result<Self, CollectError> {
        let near = LocalCollector::new(assembly, executor)?;
        Ok(Self { cluster, stop, near, kept: Mutex::default(), told: AtomicBool::new(false), pace: Mutex::new(0.0) })
    }

    fn pace(&self) -> f64 {
        self.pace.lock().map_or(0.0, |pace| *pace)
    }

    fn measured(&self, seconds: f64, amount: u64) {
        if let (Ok(mut pace), true) = (self.pace.lock(), amount > 0) {
            *pace = seconds / amount as f64;
        }
    }

    /// Asks for a request in parts, and puts the answers together in order.
    fn parts(
        &self,
        request: &EpisodesRequest,
        task: fn(Block) -> Task,
        alone: bool,
    ) -> Result<Vec<Answer>, CollectError> {
        let slots = self.cluster.workers().1;
        let episode = self.pace() * amount(request) as f64 / (request.episodes.indices.clone().count().max(1) as f64);
        let least = if episode > 0.0 { (BLOCK / episode).ceil() as u64 } else { 1 };
        let parts = if alone { vec![request.clone()] } else { request.shared_by(slots, least) };
        let (params, need) = self.params(&request.params, parts.len())?;
        let asker = Arc::clone(&self.cluster.asker);
        let text = request.experiment.clone();
        let work = async move {
            let (experiment, text) = asker.experiment(&text).await?;
            let needs: Vec<Need> = std::iter::once(text).chain(need).collect();
            let ask = |part: EpisodesRequest| {
                let block = Block {
                    stage: part.stage,
                    params: params.clone(),
                    episodes: part.episodes,
                    steps: part.steps,
                    lanes: part.lanes,
                };
                let (asker, needs) = (&asker, &needs);
                let job = asker.job(experiment.clone(), task(block));
                async move { asker.ask(&job?, needs).await }
            };
            futures_util::future::join_all(parts.into_iter().map(ask))
                .await
                .into_iter()
                .collect::<Result<Vec<_>, CollectError>>()
        };
        let answers = self.cluster.wait_unless(self.stop, work).unwrap_or(Err(CollectError::Interrupted))?;
        self.measured(answers.iter().map(|reply| reply.seconds).sum(), amount(request));
        answers.into_iter().map(|reply| unpack::<Content>(&reply.content).map_err(unanswered)?).collect()
    }

    /// Keeps the parameters of a request, where several jobs need them; those of one job travel with it.
    fn params(&self, params: &[f32], jobs: usize) -> Result<(Payload, Option<Need>), CollectError> {
        // By their bits: what is no number is no other one.
        let same =
            |one: &[f32]| one.len() == params.len() && one.iter().zip(params).all(|(a, b)| a.to_bits() == b.to_bits());
        let known = |kept: &Vec<KeptParams>| {
            kept.iter().find(|kept| same(&kept.params)).map(|kept| (kept.payload.clone(), kept.need.clone()))
        };
        let shared = jobs > 1;
        if shared
            && let Ok(kept) = self.kept.lock()
            && let Some(found) = known(&kept)
        {
            return Ok(found);
        }
        let bytes = pack(&Params(params.to_vec())).map_err(unanswered)?;
        let asker = Arc::clone(&self.cluster.asker);
        let put = async move { asker.put(Class::Iteration, bytes).await };
        let (payload, need) = self.cluster.wait_unless(self.stop, put).unwrap_or(Err(CollectError::Interrupted))?;
        if shared && let Ok(mut kept) = self.kept.lock() {
            kept.truncate(REMEMBERED - 1);
            kept.insert(0, KeptParams { params: params.into(), payload: payload.clone(), need: need.clone() });
        }
        Ok((payload, need))
    }

    /// Whether a request takes less time here than its way to a worker.
    fn is_near(&self, request: &EpisodesRequest) -> bool {
        let pace = self.pace();
        let near = pace > 0.0 && pace * (amount(request) as f64) < NOT_WORTH_IT;
        if near && !self.told.swap(true, Ordering::Relaxed) {
            tracing::info!("its episodes take less time than the way to a worker: they run here");
        }
        near
    }

    fn rows(&self, request: &EpisodesRequest, alone: bool) -> Result<Batch, CollectError> {
        if self.is_near(request) {
            return self.near.rows(request);
        }
        let rows = |answer| match answer {
            Answer::Rows(batch) => Ok(batch),
            _ => Err(unanswered("an answer has no rows")),
        };
        let parts = self.parts(request, Task::Rows, alone)?;
        Ok(Batch::join(parts.into_iter().map(rows).collect::<Result<_, _>>()?))
    }

    fn results(&self, request: &EpisodesRequest, alone: bool) -> Result<Vec<EpisodeAnswer>, CollectError> {
        if self.is_near(request) {
            return self.near.results(request);
        }
        let results = |answer| match answer {
            Answer::Results(results) => Ok(results),
            _ => Err(unanswered("an answer has no results")),
        };
        let parts = self.parts(request, Task::Results, alone)?;
        Ok(parts.into_iter().map(results).collect::<Result<Vec<_>, _>>()?.concat())
    }
}

impl Collector for RemoteCollector<'_> {
    fn rows(&self, request: &EpisodesRequest) -> Result<Batch, CollectError> {
        self.rows(request, false)
    }

    fn results(&self, request: &EpisodesRequest) -> Result<Vec<EpisodeAnswer>, CollectError> {
        self.results(request, false)
    }

    fn candidate(&self, request: &CandidateRequest, watch: &dyn Watch) -> Result<CandidateAnswer, CollectError> {
        let asker: Arc<Asker> = Arc::clone(&self.cluster.asker);
        let request = request.clone();
        let (sender, receiver) = std::sync::mpsc::channel();
        let task = self.cluster.handle.spawn(async move {
            let asked: Result<(String, Reply), CollectError> = async {
                let CandidateRequest { experiment, design, seed, env_steps, from } = request;
                let from = from.as_ref().map(pack).transpose().map_err(unanswered)?;
                let task = |from| Task::Candidate { design, seed, env_steps, from };
                let (job, needs) = long::job(&asker, &experiment, from, task).await?;
                let answer = asker.ask(&job, &needs).await;
                Ok((job.name, answer?))
            }
            .await;
            let (name, answer) = match asked {
                Ok((name, reply)) => (Some(name), Ok(reply)),
                // Its state is there for whoever asks again.
                Err(error) => (None, Err(error)),
            };
            // Who asked may be gone.
            let _ = sender.send(answer);
            if let Some(name) = name {
                forget_state(&asker.store, &asker.run, &name).await;
            }
        });
        loop {
            match receiver.recv_timeout(LOOK) {
                Ok(answer) => {
                    return match unpack::<Content>(&answer?.content).map_err(unanswered)?? {
                        Answer::Candidate(answer) => Ok(answer),
                        _ => Err(unanswered("an answer is of no candidate")),
                    };
                }
                Err(std::sync::mpsc::RecvTimeoutError::Timeout) if watch.stopped() => {
                    task.abort();
                    return Err(CollectError::Interrupted);
                }
                Err(std::sync::mpsc::RecvTimeoutError::Timeout) => {}
                Err(std::sync::mpsc::RecvTimeoutError::Disconnected) => return Err(CollectError::Interrupted),
            }
        }
    }

    fn each(&self, count: usize, job: &(dyn Fn(usize, &dyn Collector) + Sync)) {
        let (next, alone) = (AtomicUsize::new(0), Alone(self));
        std::thread::scope(|scope| {
            for _ in 0..count.min(MOST_AT_ONCE) {
                scope.spawn(|| {
                    loop {
                        let i = next.fetch_add(1, Ordering::Relaxed);
                        if i >= count {
                            return;
                        }
                        job(i, &alone);
                    }
                });
            }
        });
    }
}

/// Answers each request on one worker.
struct Alone<'a>(&'a RemoteCollector<'a>);

impl Collector for Alone<'_> {
    fn rows(&self, request: &EpisodesRequest) -> Result<Batch, CollectError> {
        self.0.rows(request, true)
    }

    fn results(&self, request: &EpisodesRequest) -> Result<Vec<EpisodeAnswer>, CollectError> {
        self.0.results(request, true)
    }

    fn candidate(&self, request: &CandidateRequest, watch: &dyn Watch) -> Result<CandidateAnswer, CollectError> {
        self.0.candidate(request, watch)
    }

    fn each(&self, count: usize, job: &(dyn Fn(usize, &dyn Collector) + Sync)) {
        (0..count).for_each(|i| job(i, self));
    }
}
