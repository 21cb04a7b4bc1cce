//! Whoever answers requests: it puts experiments together again from their texts, and keeps the last of them.

use std::sync::{Arc, Mutex, MutexGuard};

use hwasp_algos::{LearnError, StateError};
use hwasp_core::{Batch, Executor, Policy, Sampler, Serial};
use hwasp_experiment::{Catalogue, resolve};
use hwasp_problem::World;

use crate::assemble::{AssembleError, Assembly};
use crate::collect::{
    Answer, CandidateAnswer, CandidateFailure, CandidateRequest, CollectError, Collector, EpisodeAnswer,
    EpisodesRequest, ExperimentText, Request, Stage, Watch,
};
use crate::error::TrainError;
use crate::gradient::gradient;
use crate::learned::{Clock, LoopContext};
use crate::observer::{Event, Observer, ObserverError};

/// Experiments, and samplers of one experiment, that are kept for the next request.
const KEPT: usize = 4;
/// Why no lock is poisoned.
const UNPOISONED: &str = "nothing goes on with a worker that has panicked";

/// Answers requests about experiments of a catalogue.
pub struct Worker {
    catalogue: Catalogue,
    /// The last one first.
    experiments: Mutex<Vec<Arc<Prepared>>>,
}

impl Worker {
    /// One that knows these problems and learners.
    pub fn new(catalogue: Catalogue) -> Self {
        Self { catalogue, experiments: Mutex::new(Vec::new()) }
    }

    /// Answers a request on one thread. `watch` is of use to the training of a candidate.
    ///
    /// # Errors
    /// Where the experiment cannot be set up here, or an episode gave a number that is none;
    /// [`CollectError::Interrupted`] where `watch` asked for it.
    pub fn answer(&self, request: &Request, watch: &dyn Watch) -> Result<Answer, CollectError> {
        Ok(match request {
            Request::Rows(request) => Answer::Rows(self.rows(request, &Serial)?),
            Request::Results(request) => Answer::Results(self.results(request, &Serial)?),
            Request::Candidate(request) => Answer::Candidate(self.candidate(request, watch)?),
        })
    }

    fn rows(&self, request: &EpisodesRequest, executor: &dyn Executor) -> Result<Batch, CollectError> {
        let prepared = self.prepared(&request.experiment)?;
        let sampler = prepared.sampler(&request.stage, request.steps, &request.params)?;
        Ok(match request.lanes {
            None => sampler.collect_part(executor, &request.params, &request.episodes)?,
            Some(steps) => sampler.collect_lanes(executor, &request.params, &request.episodes, steps)?,
        })
    }

    fn results(&self, request: &EpisodesRequest, executor: &dyn Executor) -> Result<Vec<EpisodeAnswer>, CollectError> {
        let prepared = self.prepared(&request.experiment)?;
        let sampler = prepared.sampler(&request.stage, request.steps, &request.params)?;
        let discount = prepared.assembly.experiment().discount();
        Ok(sampler.outcomes_part(executor, &request.params, &request.episodes, discount)?)
    }

    fn candidate(&self, request: &CandidateRequest, watch: &dyn Watch) -> Result<CandidateAnswer, CollectError> {
        let outer = self.prepared(&request.experiment)?;
        let inner =
            outer.assembly.frozen(&request.design, request.seed, request.env_steps).map_err(|error| setup(&error))?;
        let collector = LocalCollector::new(&inner, &Serial)?;
        let mut context = LoopContext {
            experiment: collector.experiment.clone(),
            executor: &Serial,
            collector: &collector,
            observer: &mut StateOnly(watch),
            stopped: &|| watch.stopped(),
            clock: Clock::start(0.0),
            budget: request.env_steps,
            metrics: &[],
            terms: &[],
        };
        match gradient(&inner, &mut context, request.from.as_ref()) {
            Ok(learned) if learned.trailing().0.is_nan() => {
                let cause =
                    "no training episode came to its end: the steps of every lane were used up before".to_owned();
                Ok(CandidateAnswer::Failed(CandidateFailure { text: cause.clone(), cause }))
            }
            Ok(learned) => Ok(CandidateAnswer::Trained {
                controller: inner.policy.controller_params(&learned.params).to_vec(),
                returns: learned.trailing(),
                env_steps: learned.env_steps,
                discarded_episodes: learned.discarded_episodes,
            }),
            Err(TrainError::Rollout(error)) => Ok(CandidateAnswer::Failed(CandidateFailure::episode(&error))),
            Err(TrainError::Physics { first, iterations, failed, asked }) => {
                let cause = first.what.clone();
                let text = TrainError::Physics { first, iterations, failed, asked }.to_string();
                Ok(CandidateAnswer::Failed(CandidateFailure { cause, text }))
            }
            Err(TrainError::Learn(error)) => {
                let LearnError::NotFinite { what, .. } = &error;
                let (cause, text) = (format!("{what} is not finite"), error.to_string());
                Ok(CandidateAnswer::Failed(CandidateFailure { cause, text }))
            }
            Err(TrainError::Interrupted { .. }) => Err(CollectError::Interrupted),
            Err(error) => Err(setup(&error)),
        }
    }

    /// The experiment of a request, ready to run. Who comes second while it is put together waits for it.
    pub(crate) fn prepared(&self, text: &ExperimentText) -> Result<Arc<Prepared>, CollectError> {
        let mut experiments = self.experiments();
        if let Some(at) = experiments.iter().position(|known| known.text.is(text)) {
            experiments[..=at].rotate_right(1);
            return Ok(Arc::clone(&experiments[0]));
        }
        let layers = text.layers("the requested experiment").map_err(|error| setup(&error))?;
        let experiment = resolve(layers, None, &self.catalogue).map_err(|error| setup(&error))?;
        let assembly = Assembly::new(&experiment).map_err(|error| setup(&error))?;
        experiments.truncate(KEPT - 1);
        experiments.insert(0, Prepared::new(text.clone(), assembly));
        Ok(Arc::clone(&experiments[0]))
    }

    fn experiments(&self) -> MutexGuard<'_, Vec<Arc<Prepared>>> {
        self.experiments.lock().expect(UNPOISONED)
    }
}

fn setup(error: &dyn std::error::Error) -> CollectError {
    CollectError::Setup(error.to_string())
}

/// An experiment, and what runs its episodes.
pub(crate) struct Prepared {
    text: ExperimentText,
    pub(crate) assembly: Assembly,
    /// The last one first. Each has policy and idle environments of its own.
    samplers: Mutex<Vec<KeptSampler>>,
}

/// Runs the episodes of one stage that take so many steps.
struct KeptSampler {
    stage: Stage,
    steps: Option<usize>,
    sampler: Arc<Sampler>,
}

impl Prepared {
    fn new(text: ExperimentText, assembly: Assembly) -> Arc<Self> {
        Arc::new(Self { text, assembly, samplers: Mutex::new(Vec::new()) })
    }

    /// What runs episodes on a stage with these parameters.
    fn sampler(&self, stage: &Stage, steps: Option<usize>, params: &[f32]) -> Result<Arc<Sampler>, CollectError> {
        let mut samplers = self.samplers.lock().expect(UNPOISONED);
        let known = samplers.iter().position(|kept| kept.stage == *stage && kept.steps == steps);
        if let Some(at) = known {
            samplers[..=at].rotate_right(1);
        } else {
            let sampler = Arc::new(self.make(stage, steps).map_err(|error| setup(&error))?);
            samplers.truncate(KEPT - 1);
            samplers.insert(0, KeptSampler { stage: stage.clone(), steps, sampler });
        }
        let sampler = Arc::clone(&samplers[0].sampler);
        let (found, wanted) = (params.len(), sampler.policy().param_count());
        if found != wanted {
            return Err(setup(&StateError::Length { name: "params".into(), found, wanted }));
        }
        Ok(sampler)
    }

    fn make(&self, stage: &Stage, steps: Option<usize>) -> Result<Sampler, AssembleError> {
        let assembly = &self.assembly;
        let fixed = |world: &World, design: &[f64]| {
            let policy = assembly.fixed_in(world, design, false)?;
            Ok(Sampler::new(Arc::new(policy), Arc::clone(&world.make), steps))
        };
        match stage {
            Stage::Training => {
                let make = Arc::clone(&assembly.worlds.training.make);
                Ok(Sampler::new(Arc::clone(&assembly.policy), make, steps))
            }
            Stage::Deployment(design) => fixed(&assembly.worlds.deployment, design),
            Stage::StandIn(design) => fixed(&assembly.native(design)?, design),
            Stage::Polish(design) => {
                let (world, policy) = assembly.polished_in(design)?;
                Ok(Sampler::new(Arc::new(policy), world.make, steps))
            }
        }
    }
}

/// Hands the states of a training on, and nothing else.
struct StateOnly<'a>(&'a dyn Watch);

impl Observer for StateOnly<'_> {
    fn on(&mut self, event: Event<'_>) -> Result<(), ObserverError> {
        if let Event::Checkpoint(checkpoint) = event {
            self.0.keep(&checkpoint.archive);
        }
        Ok(())
    }

    fn due(&self) -> bool {
        self.0.due()
    }
}

/// Answers with the threads of this process. It begins with an assembly as it is, and so needs no text of that one.
pub struct LocalCollector<'a> {
    worker: Arc<Worker>,
    experiment: ExperimentText,
    executor: &'a dyn Executor,
}

impl<'a> LocalCollector<'a> {
    /// For an assembly; other experiments are put together with its catalogue.
    ///
    /// # Errors
    /// [`CollectError::Setup`] where its experiment cannot be written as a text, which is its name in requests.
    pub fn new(assembly: &Assembly, executor: &'a dyn Executor) -> Result<Self, CollectError> {
        let experiment = ExperimentText::of(assembly.experiment())?;
        let worker = Worker::new(assembly.experiment().catalogue().clone());
        worker.experiments().push(Prepared::new(experiment.clone(), assembly.clone()));
        Ok(Self { worker: Arc::new(worker), experiment, executor })
    }
}

impl Collector for LocalCollector<'_> {
    fn rows(&self, request: &EpisodesRequest) -> Result<Batch, CollectError> {
        self.worker.rows(request, self.executor)
    }

    fn results(&self, request: &EpisodesRequest) -> Result<Vec<EpisodeAnswer>, CollectError> {
        self.worker.results(request, self.executor)
    }

    fn candidate(&self, request: &CandidateRequest, watch: &dyn Watch) -> Result<CandidateAnswer, CollectError> {
        self.worker.candidate(request, watch)
    }

    fn each(&self, count: usize, job: &(dyn Fn(usize, &dyn Collector) + Sync)) {
        let experiment = self.experiment.clone();
        let alone = LocalCollector { worker: Arc::clone(&self.worker), experiment, executor: &Serial };
        self.executor.for_each(count, &|i| job(i, &alone));
    }
}
