//! Trainings whose last part polishes the controller where the result has to work.

#![allow(clippy::unwrap_used)] // helpers of tests are tests too

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use hwasp_core::{Environment, Serial, Step, Stream, Watch, Watched};
use hwasp_testing::{Keeper, Settings, Stopper, executor, layers, resolve, run, told};
use hwasp_training::{
    Assembly, Checkpoint, Event, Observer, ObserverError, TrainError, World, params_at, repeat, stage_at, train,
    train_from,
};

/// The bar, which trains with an interface that gives way and works with a rigid one: 8 episodes of 50 steps an iteration.
const SHORT: Settings = &[
    ("train.env_steps", "4000"),
    ("train.episodes_per_iteration", "8"),
    ("train.episode_steps", "50"),
    ("train.evaluation_episodes", "3"),
    ("ppo.minibatch_rows", "100"),
    ("baseline.minibatch_rows", "100"),
    ("polish.share", "0.45"),
];

const TD3: Settings = &[
    ("learner.algorithm", "td3"),
    ("td3.warmup_steps", "500"),
    ("td3.replay_frames", "1500"),
    ("td3.batch_rows", "200"),
    ("td3.critic_hidden", "[16, 16]"),
    ("td3.updates_per_step", "0.05"),
    ("td3.privileged", "true"),
];

const RUNNING: Settings = &[
    ("controller.observation_center", "[0.0, 0.0]"),
    ("controller.observation_scale", "[1.0, 1.0]"),
    ("controller.normalize_observations", "true"),
    ("train.reward_scaling", "true"),
];

const SEARCH: Settings = &[
    ("train.env_steps", "12000"),
    ("search.episodes", "1"),
    ("cmaes.popsize", "8"),
    ("search.inner_env_steps", "800"),
    ("ars.directions", "2"),
];

/// Every way to a controller.
const WAYS: [(&str, Settings); 7] = [
    ("hwasp", &[]),
    ("hwasp", TD3),
    ("minimal", RUNNING),
    ("episode", &[("controller.sees_design", "true")]),
    ("cmaes", SEARCH),
    ("ars", SEARCH),
    ("cmaes-rl", SEARCH),
];

fn assembly(method: &str, settings: Settings) -> Assembly {
    let all = SHORT.iter().chain(settings);
    let layers = all.fold(layers("bar-length"), |layers, (key, value)| layers.with_override(key, value));
    // Methods other than hwasp train with the rigid bar; so that they have two worlds, too:
    let layers = layers.with_override("task.interface", "soft");
    Assembly::new(&resolve(layers, Some(method)).unwrap()).unwrap()
}

fn polishes(checkpoint: &Checkpoint) -> bool {
    checkpoint.archive.contains_key("polish.params")
}

/// In the main stage, where it ends, and in the polish: of any number of threads before and after.
#[test]
fn resumed_anywhere_it_has_the_bits_of_one_that_was_never_interrupted() {
    for (method, settings) in WAYS {
        let assembly = assembly(method, settings);
        let (whole, kept) = run(&assembly, None, 1);
        let whole = told(&whole);
        assert_eq!(told(&run(&assembly, None, 2).0), whole, "{method} {settings:?}: two threads");
        let count = kept.checkpoints.len();
        let polished = kept.checkpoints.iter().filter(|checkpoint| polishes(checkpoint)).count();
        assert!(polished > 2 && count - polished > 2, "{method}: {polished} of {count} checkpoints");
        // The last one before the polish, and some on both sides of it.
        let boundary = count - polished - 1;
        for i in [0, boundary / 2, boundary - 1, boundary, boundary + 1, count - 2, count - 1] {
            let from = &kept.checkpoints[i];
            let (resumed, rows) = run(&assembly, Some(from), 1 + i % 2);
            assert_eq!(told(&resumed), whole, "{method} {settings:?}, checkpoint {i} of {count}");
            let rest = &kept.rows[from.iteration as usize..];
            assert_eq!(format!("{:?}", rows.rows), format!("{rest:?}"), "{method} {settings:?}, checkpoint {i}");
        }
    }
}

#[test]
fn only_the_controller_moves_and_rows_go_on_counting() {
    for (method, settings) in WAYS {
        let assembly = assembly(method, settings);
        let (trained, kept) = run(&assembly, None, 1);
        let boundary = kept.checkpoints.iter().rfind(|checkpoint| !polishes(checkpoint)).unwrap();
        let policy = &assembly.policy;
        // What the last choice of a search takes is charged after its last checkpoint.
        let polished = trained.polish_steps.unwrap();
        let before = trained.env_steps - polished;
        if !assembly.experiment().method.searches() {
            assert_eq!(before, boundary.env_steps, "{method}");
            let (from, to) = (params_at(&assembly, boundary).unwrap(), &trained.params);
            let controller = policy.controller_params(&from).len();
            assert_ne!(from[..controller], to[..controller], "{method}");
            assert_eq!(from[controller..], to[controller..], "{method}");
        }
        // The budget is the sum: none is taken twice, and less than an episode is left.
        let (budget, asked) = (assembly.experiment().train.env_steps, assembly.polish_steps());
        assert!(
            budget - trained.env_steps < 50 && trained.env_steps <= budget,
            "{method}: {} steps",
            trained.env_steps
        );
        assert!(polished + 50 > asked, "{method}: {polished} of {asked}");
        let design = policy.space().totals(&policy.design(&trained.params));
        let rows = &kept.rows;
        assert!(rows.iter().enumerate().all(|(i, row)| row.iteration == i as u64), "{method}");
        assert!(rows.windows(2).all(|pair| pair[0].env_steps < pair[1].env_steps), "{method}");
        let of_polish: Vec<_> = rows.iter().filter(|row| row.env_steps > before).collect();
        assert!(of_polish.len() >= 3, "{method}: {} rows", of_polish.len());
        for row in of_polish {
            assert_eq!(row.design_totals, design, "{method}");
            assert!(row.learner[0].is_finite(), "{method}: {row:?}");
        }
        let last = kept.checkpoints.last().unwrap();
        assert_eq!(params_at(&assembly, last).unwrap(), trained.params, "{method}");
    }
}

/// Counts the steps of a world's environments, and says of which design they were told.
fn counted(world: &mut World) -> Arc<AtomicU64> {
    struct Count(Arc<AtomicU64>);
    impl Watch for Count {
        fn reset(&mut self, inner: &mut dyn Environment, rng: &mut Stream) {
            inner.reset(rng);
        }

        fn step(&mut self, inner: &mut dyn Environment, effort: &[f64], command: &[f64]) -> Step {
            self.0.fetch_add(1, Ordering::Relaxed);
            inner.step(effort, command)
        }
    }
    let (count, whole) = (Arc::new(AtomicU64::new(0)), Arc::clone(&world.make));
    let steps = Arc::clone(&count);
    world.make = Arc::new(move |horizon| {
        Box::new(Watched::new(whole.make(horizon), Count(Arc::clone(&steps)))) as Box<dyn Environment>
    });
    count
}

/// Keeps what two counters say when the evaluation begins.
struct AtEvaluation<'a>([&'a AtomicU64; 2], [u64; 2]);

impl Observer for AtEvaluation<'_> {
    fn on(&mut self, event: Event<'_>) -> Result<(), ObserverError> {
        if matches!(event, Event::Evaluating) {
            self.1 = self.0.map(|count| count.load(Ordering::Relaxed));
        }
        Ok(())
    }
}

#[test]
fn it_polishes_where_the_result_has_to_work() {
    let mut assembly = assembly("hwasp", &[]);
    let counts = [counted(&mut assembly.worlds.training), counted(&mut assembly.worlds.deployment)];
    let mut observer = AtEvaluation([&counts[0], &counts[1]], [0; 2]);
    let trained = train(&assembly, &Serial, &mut observer, &AtomicBool::new(false)).unwrap();
    assert_eq!(observer.1, [2200, 1800]);
    assert_eq!((trained.env_steps, trained.polish_steps), (4000, Some(1800)));
}

/// What was there before is the training of a smaller budget, to the bit.
#[test]
fn the_main_stage_is_the_training_of_its_own_budget() {
    let (polished, kept) = run(&assembly("hwasp", &[]), None, 1);
    let alone = assembly("hwasp", &[("polish.share", "0"), ("train.env_steps", "2200")]);
    let (trained, rows) = run(&alone, None, 1);
    assert_eq!(trained.polish_steps, None);
    assert_eq!(format!("{:?}", kept.rows[..rows.rows.len()].to_vec()), format!("{:?}", rows.rows));
    assert_ne!(polished.evaluation, trained.evaluation);
    assert!(!alone.experiment().to_toml().unwrap().contains("polish"));
}

#[test]
fn a_training_that_is_stopped_in_its_polish_says_where_it_stands() {
    let assembly = assembly("hwasp", &[]);
    let (stop, mut keeper) = (AtomicBool::new(false), Keeper::default());
    // Six iterations and the end of the main stage, and one of the polish.
    let mut stopper = Stopper { inner: &mut keeper, stop: &stop, after: 8 };
    let error = train_from(None, &assembly, &*executor(1), &mut stopper, &stop).unwrap_err();
    assert!(matches!(error, TrainError::Interrupted { env_steps: 2600, budget: 4000 }), "{error}");
    assert!(polishes(keeper.checkpoints.last().unwrap()));
}

#[test]
fn an_iteration_of_a_polish_can_be_repeated() {
    let assembly = assembly("hwasp", &[]);
    let (_, kept) = run(&assembly, None, 1);
    for from in [&kept.checkpoints[2], kept.checkpoints.iter().find(|checkpoint| polishes(checkpoint)).unwrap()] {
        let stage = stage_at(&assembly, from).unwrap();
        assert!(stage.iterates(from.env_steps));
        let (batch, update) = repeat(&stage, &from.archive, &*executor(2)).unwrap();
        let row = &kept.rows[from.iteration as usize];
        assert_eq!(from.env_steps + batch.unwrap().env_steps(), row.env_steps);
        assert_eq!(format!("{:?}", update.unwrap().values()), format!("{:?}", row.learner));
    }
}
