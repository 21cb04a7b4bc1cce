//! Nothing that learns can tell whether a thread or another process ran its episodes.

#![allow(clippy::unwrap_used)] // helpers of tests are tests too

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use hwasp_algos::{Archive, PpoKind};
use hwasp_core::{Batch, End, Episode, Executor, Moments, RolloutError};
use hwasp_experiment::{Catalogue, PolishWorld};
use hwasp_testing::{Keeper, POLISH, Settings, UNSCALED, catalogue, executor, layers, resolve, run, small, told};
use hwasp_training::collect::{
    Answer, CandidateAnswer, CandidateRequest, CollectError, Collector, EpisodeAnswer, EpisodesRequest, ExperimentText,
    Request, Stage, Watch,
};
use hwasp_training::{Assembly, Worker, evaluate, evaluate_by, held_out, train_by};
use serde::Serialize;
use serde::de::DeserializeOwned;

/// As it comes out of a text.
fn sent<T: Serialize + DeserializeOwned>(value: &T) -> T {
    serde_json::from_str(&serde_json::to_string(value).unwrap()).unwrap()
}

/// Sends every request as JSON to a worker that has just begun, episodes in three parts, and gets JSON back.
struct Elsewhere(Arc<dyn Executor>);

impl Elsewhere {
    fn ask(request: &Request) -> Result<Answer, CollectError> {
        sent(&Worker::new(catalogue().clone()).answer(&sent(request), &()))
    }
}

impl Collector for Elsewhere {
    fn rows(&self, request: &EpisodesRequest) -> Result<Batch, CollectError> {
        let rows = |part| -> Result<_, CollectError> {
            match Self::ask(&Request::Rows(part))? {
                Answer::Rows(batch) => Ok(batch),
                other => panic!("{other:?}"),
            }
        };
        Ok(Batch::join(request.split(3).into_iter().map(rows).collect::<Result<_, _>>()?))
    }

    fn results(&self, request: &EpisodesRequest) -> Result<Vec<EpisodeAnswer>, CollectError> {
        let results = |part| -> Result<_, CollectError> {
            match Self::ask(&Request::Results(part))? {
                Answer::Results(results) => Ok(results),
                other => panic!("{other:?}"),
            }
        };
        let parts: Vec<_> = request.split(3).into_iter().map(results).collect::<Result<_, _>>()?;
        Ok(parts.into_iter().flatten().collect())
    }

    fn candidate(&self, request: &CandidateRequest, _: &dyn Watch) -> Result<CandidateAnswer, CollectError> {
        match Self::ask(&Request::Candidate(request.clone()))? {
            Answer::Candidate(answer) => Ok(answer),
            other => panic!("{other:?}"),
        }
    }

    fn each(&self, count: usize, job: &(dyn Fn(usize, &dyn Collector) + Sync)) {
        self.0.for_each(count, &|i| job(i, self));
    }
}

#[test]
fn another_process_gives_the_same_bits() {
    const KINDS: [(&str, Settings); 6] = [
        ("hwasp", &[]),
        ("hwasp", POLISH),
        ("minimal", UNSCALED),
        ("cmaes", &[("train.env_steps", "20000")]),
        ("ars", &[("ars.variant", "v2-t"), ("ars.directions", "8"), ("train.env_steps", "20000")]),
        ("cmaes-rl", &[("cmaes.popsize", "4"), ("train.env_steps", "10000")]),
    ];
    for (method, settings) in KINDS {
        let assembly = Assembly::new(&small(method, settings)).unwrap();
        for threads in [1, 2] {
            let here = run(&assembly, None, threads).0;
            let executor: Arc<dyn Executor> = executor(threads).into();
            let (collector, mut keeper) = (Elsewhere(Arc::clone(&executor)), Keeper::default());
            let stop = AtomicBool::new(false);
            let there = train_by(&collector, None, &assembly, &*executor, &mut keeper, &stop).unwrap();
            assert_eq!(told(&here), told(&there), "{method}, {threads} threads");
            let evaluation = evaluate_by(&collector, &assembly, &here.params, (7, 3)).unwrap();
            assert_eq!(evaluation, evaluate(&assembly, &here.params, (7, 3), &*executor).unwrap(), "{method}");
        }
    }
}

/// A worker elsewhere makes the world that stands in for the built robot from the experiment and the design of a request.
#[test]
fn another_process_polishes_in_the_world_that_stands_in() {
    let settings = [
        ("train.env_steps", "2400"),
        ("train.steps_per_iteration", "0"),
        ("train.episodes_per_iteration", "4"),
        ("train.episode_steps", "100"),
        ("train.evaluation_episodes", "2"),
        ("ppo.minibatch_rows", "100"),
        ("baseline.minibatch_rows", "100"),
        ("polish.share", "0.4"),
        ("polish.world", "native"),
    ];
    let layers = settings.iter().fold(layers("balanced-arm"), |layers, (k, v)| layers.with_override(k, v));
    let assembly = Assembly::new(&resolve(layers, None).unwrap()).unwrap();
    let (here, keeper) = run(&assembly, None, 2);
    // 1440 steps hold 14 episodes of the main stage; the polish has the rest.
    assert_eq!(here.polish_steps, Some(1000));
    let (executor, stop): (Arc<dyn Executor>, _) = (executor(1).into(), AtomicBool::new(false));
    let mut rows = Keeper::default();
    let there = train_by(&Elsewhere(Arc::clone(&executor)), None, &assembly, &*executor, &mut rows, &stop).unwrap();
    assert_eq!(told(&here), told(&there));
    assert_eq!(format!("{:?}", keeper.rows), format!("{:?}", rows.rows));
    // It is another world than that of the evaluation.
    let mut spec = assembly.experiment().clone();
    spec.polish.world = PolishWorld::Deployment;
    let deployed = run(&Assembly::new(&spec).unwrap(), None, 1).0;
    assert_ne!(deployed.params, here.params);
}

/// Forgets the last job.
struct Forgetful(Arc<dyn Executor>);

impl Collector for Forgetful {
    fn rows(&self, request: &EpisodesRequest) -> Result<Batch, CollectError> {
        Elsewhere(Arc::clone(&self.0)).rows(request)
    }

    fn results(&self, request: &EpisodesRequest) -> Result<Vec<EpisodeAnswer>, CollectError> {
        Elsewhere(Arc::clone(&self.0)).results(request)
    }

    fn candidate(&self, request: &CandidateRequest, watch: &dyn Watch) -> Result<CandidateAnswer, CollectError> {
        Elsewhere(Arc::clone(&self.0)).candidate(request, watch)
    }

    fn each(&self, count: usize, job: &(dyn Fn(usize, &dyn Collector) + Sync)) {
        (1..count).for_each(|i| job(i - 1, self));
    }
}

/// A candidate that a collector had not run was taken for one that somebody had stopped: the search ended as if it could be resumed.
#[test]
#[should_panic(expected = "candidate 3 of 4 was not scored, and nobody asked the search to stop")]
fn a_candidate_that_is_not_run_was_not_stopped() {
    let assembly = Assembly::new(&small("ars", &[("ars.directions", "2"), ("search.episodes", "1")])).unwrap();
    let (executor, mut keeper): (Arc<dyn Executor>, _) = (executor(1).into(), Keeper::default());
    let stop = AtomicBool::new(false);
    let _ = train_by(&Forgetful(Arc::clone(&executor)), None, &assembly, &*executor, &mut keeper, &stop);
}

/// The answer to a candidate that was interrupted goes on from the state that its request brings along.
#[test]
fn a_candidate_goes_on_from_its_state() {
    struct Stop(AtomicBool, std::sync::Mutex<Option<Archive>>);
    impl Watch for Stop {
        fn stopped(&self) -> bool {
            self.0.load(std::sync::atomic::Ordering::Relaxed)
        }
        fn due(&self) -> bool {
            true
        }
        fn keep(&self, state: &Archive) {
            self.0.store(true, std::sync::atomic::Ordering::Relaxed);
            *self.1.lock().unwrap() = Some(state.clone());
        }
    }
    let assembly = Assembly::new(&small("cmaes-rl", &[("cmaes.popsize", "4")])).unwrap();
    let executor = executor(1);
    let local = hwasp_training::LocalCollector::new(&assembly, &*executor).unwrap();
    let design = assembly.policy.design(&assembly.init());
    let experiment = ExperimentText::of(assembly.experiment()).unwrap();
    let request = CandidateRequest { experiment, design, seed: 5, env_steps: 3600, from: None };
    let whole = local.candidate(&request, &()).unwrap();
    let stop = Stop(AtomicBool::new(false), None.into());
    assert_eq!(local.candidate(&request, &stop), Err(CollectError::Interrupted));
    let from = stop.1.into_inner().unwrap();
    assert!(from.is_some());
    let rest = Elsewhere(executor.into()).candidate(&CandidateRequest { from, ..request }, &()).unwrap();
    assert_eq!(whole, rest);
}

/// JSON has no text for them: a batch with a position that had left the numbers of `f32` could not be read back.
#[test]
fn numbers_that_are_none_travel_too() {
    let batch = Batch {
        obs: vec![f32::INFINITY, -0.0],
        state: vec![f32::NEG_INFINITY],
        action: vec![f32::from_bits(0x7fc0_1234)],
        log_prob: vec![1e-45],
        reward: vec![f64::MIN_POSITIVE],
        episodes: vec![Episode {
            rows: 0..1,
            end: End::Truncated,
            cut: true,
            last_obs: vec![0.1],
            last_state: vec![],
            context: vec![],
            log_prob: 0.0,
            outcome: Some(hwasp_core::Outcome { kind: "ball".into(), success: true }),
            terms: vec![-0.0, 1e300],
        }],
        faults: vec![RolloutError { seed: 1, iteration: 2, episode: 3, step: 4, what: "it left".into() }],
        observed: vec![Moments { count: 1.0, mean: vec![f64::NAN], squares: vec![f64::INFINITY] }],
    };
    let back = sent(&batch);
    assert_eq!(format!("{back:?}"), format!("{batch:?}"));
    assert_eq!(back.action[0].to_bits(), 0x7fc0_1234);
}

#[test]
fn what_a_worker_cannot_set_up_is_an_answer() {
    let assembly = Assembly::new(&small("hwasp", &[])).unwrap();
    let experiment = ExperimentText::of(assembly.experiment()).unwrap();
    let (stage, episodes) = (Stage::Deployment(assembly.built(&assembly.init())), held_out(1, 0..2));
    let params = assembly.policy.controller_params(&assembly.init()).to_vec();
    let request = EpisodesRequest { experiment, stage, params, episodes, steps: None, lanes: None };
    let ask = |request| Elsewhere::ask(&Request::Results(request));
    assert!(ask(request.clone()).is_ok());
    let wrong = |request| match ask(request) {
        Err(CollectError::Setup(text)) => text,
        other => panic!("{other:?}"),
    };
    let design = wrong(EpisodesRequest { stage: Stage::Deployment(vec![]), ..request.clone() });
    assert_eq!(design, "0 placements for 1 design parameters");
    let stand_in = wrong(EpisodesRequest { stage: Stage::StandIn(vec![1.0]), ..request.clone() });
    assert!(stand_in.contains("no world that is nearer to the built robot"), "{stand_in}");
    let few = wrong(EpisodesRequest { params: vec![0.0; 3], ..request.clone() });
    assert!(few.contains("`params` of the saved state has 3 elements"), "{few}");
    let text = ExperimentText::from("name = 1".to_owned());
    let file = wrong(EpisodesRequest { experiment: text, ..request.clone() });
    assert!(file.contains("the requested experiment"), "{file}");
    let empty = Catalogue::default().with_learner(PpoKind).unwrap();
    let unknown = Worker::new(empty).answer(&Request::Results(request), &()).unwrap_err();
    assert!(unknown.to_string().contains("reach"), "{unknown}");
}

#[test]
fn a_request_is_split_into_consecutive_parts() {
    let experiment = ExperimentText::from(String::new());
    let split = |count: u64, parts: usize| {
        let episodes = held_out(1, 10..10 + count);
        let request = EpisodesRequest {
            experiment: experiment.clone(),
            stage: Stage::Training,
            params: vec![],
            episodes,
            steps: None,
            lanes: None,
        };
        request.split(parts).iter().map(|part| part.episodes.indices.clone()).collect::<Vec<_>>()
    };
    assert_eq!(split(7, 3), [10..13, 13..16, 16..17]);
    assert_eq!(split(2, 5), [10..11, 11..12]);
    assert_eq!(split(4, 0), split(4, 1));
    assert!(split(0, 3).is_empty());
}

/// The last ones are small, so that nobody waits long for somebody else; no episode is left out or run twice.
#[test]
fn workers_share_a_request_and_end_together() {
    let shared = |count: u64, workers: usize, least: u64| {
        let request = EpisodesRequest {
            experiment: ExperimentText::from(String::new()),
            stage: Stage::Training,
            params: vec![],
            episodes: held_out(1, 5..5 + count),
            steps: None,
            lanes: None,
        };
        let parts = request.shared_by(workers, least);
        let ends: Vec<u64> = parts.iter().map(|part| part.episodes.indices.end).collect();
        let starts: Vec<u64> = parts.iter().map(|part| part.episodes.indices.start).collect();
        assert_eq!(starts[1..], ends[..ends.len() - 1]);
        assert_eq!((starts[0], ends[ends.len() - 1]), (5, 5 + count));
        parts.iter().map(|part| part.episodes.indices.end - part.episodes.indices.start).collect::<Vec<_>>()
    };
    assert_eq!(shared(20, 2, 1), [5, 4, 3, 2, 2, 1, 1, 1, 1]);
    assert_eq!(shared(20, 2, 3), [5, 4, 3, 3, 3, 2]);
    assert_eq!(shared(3, 1000, 1), [1, 1, 1]);
    assert_eq!(shared(7, 0, 1), [4, 2, 1]);
}
