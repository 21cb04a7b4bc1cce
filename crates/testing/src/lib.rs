//! Small trainings of every kind, and what they come to: for the tests of the other crates.

#![forbid(unsafe_code)]
#![allow(clippy::unwrap_used)] // helpers of tests are tests too

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, LazyLock};

use hwasp_core::{Environment, Executor, Serial, Step, Threads, Watch, Watched};
use hwasp_experiment::{Catalogue, Experiment, Faults, Layers, load};
use hwasp_training::{Assembly, Checkpoint, Event, MetricsRow, Observer, ObserverError, Trained, train_from};

/// Keys and values.
pub type Settings = &'static [(&'static str, &'static str)];

const MLP: &str = "mlp";

/// Everything that robots need which nobody has scaled by hand, and iterations of 1000 steps in 7 lanes.
pub const UNSCALED: Settings = &[
    ("controller.observation_center", "[0.0]"),
    ("controller.observation_scale", "[1.0]"),
    ("controller.normalize_observations", "true"),
    ("train.reward_scaling", "true"),
    ("train.steps_per_iteration", "1000"),
    ("train.episodes_per_iteration", "7"),
    ("ppo.recompute_advantages", "true"),
    ("baseline.kind", MLP),
    ("cmaes.popsize", "4"),
];

/// A small learner with a replay that overflows, whose gradient steps are three jobs.
pub const OFF_POLICY: Settings = &[
    ("learner.algorithm", "td3"),
    ("td3.warmup_steps", "1500"),
    ("td3.replay_frames", "4000"),
    ("td3.batch_rows", "300"),
    ("td3.critic_hidden", "[16, 16]"),
    ("td3.updates_per_step", "0.03"),
    ("td3.n_step", "2"),
    ("td3.privileged", "true"),
    ("td3.critic_layer_norm", "true"),
    ("td3.forget_beyond", "0.002"),
];

/// The same with a spread of its commands that it learns.
pub const SOFT: Settings = &[
    ("learner.algorithm", "sac"),
    ("sac.warmup_steps", "1500"),
    ("sac.replay_frames", "4000"),
    ("sac.batch_rows", "300"),
    ("sac.critic_hidden", "[16, 16]"),
    ("sac.updates_per_step", "0.03"),
    ("sac.policy_delay", "2"),
    ("sac.context", "true"),
    ("sac.design_search", "2000"),
];

/// A design that is drawn once an episode, and moved by what 60 of them earned.
pub const EARNED: Settings = &[
    ("learner.algorithm", "sac"),
    ("sac.warmup_steps", "1500"),
    ("sac.critic_hidden", "[16, 16]"),
    ("sac.updates_per_step", "0.03"),
    ("sac.design_returns", "60"),
    ("controller.sees_design", "true"),
];

/// The last two fifths polish the controller.
pub const POLISH: Settings =
    &[("polish.share", "0.4"), ("polish.progress_start", "0.2"), ("ppo.learning_rate_final", "0.1")];

/// Every kind of thing that learns: method, settings.
pub const KINDS: [(&str, Settings); 22] = [
    ("hwasp", &[]),
    ("minimal", &[("baseline.kind", MLP), ("ppo.learning_rate_final", "0.1")]),
    ("episode", &[("controller.sees_design", "true")]),
    ("hwasp", &[("learner.algorithm", "trpo"), ("baseline.kind", MLP)]),
    ("cmaes", &[]),
    ("cmaes", &[("cmaes.separable", "true"), ("cmaes.restarts", "2")]),
    ("ars", &[("ars.variant", "v2-t"), ("ars.directions", "8")]),
    ("cmaes-rl", &[("cmaes.popsize", "5"), ("train.env_steps", "24000")]),
    ("cmaes-rl", &[("cmaes.popsize", "4"), ("train.env_steps", "10000"), ("learner.algorithm", "trpo")]),
    ("ars-rl", &[("ars.directions", "2"), ("train.env_steps", "10000"), ("baseline.kind", MLP)]),
    ("bo-rl", &[("bo.popsize", "3"), ("bo.initial_points", "2"), ("train.env_steps", "24000")]),
    ("random-rl", &[("random.popsize", "3"), ("train.env_steps", "10000")]),
    ("hwasp", UNSCALED),
    ("cmaes-rl", UNSCALED),
    ("hwasp", OFF_POLICY),
    ("minimal", OFF_POLICY),
    ("hwasp", SOFT),
    ("episode", SOFT),
    ("fixed", SOFT),
    ("episode", EARNED),
    ("hwasp", POLISH),
    ("cmaes", POLISH),
];

/// The problems and learners that come with the program.
pub fn catalogue() -> &'static Catalogue {
    static CATALOGUE: LazyLock<Catalogue> = LazyLock::new(hwasp_builtin::catalogue);
    &CATALOGUE
}

/// An experiment that comes with them, or a file.
pub fn layers(name_or_path: &str) -> Layers {
    load(name_or_path, catalogue()).unwrap()
}

/// Layers resolved with them.
pub fn resolve(layers: Layers, method: Option<&str>) -> Result<Experiment, Faults> {
    hwasp_experiment::resolve(layers, method, catalogue())
}

/// A training on the reach problem: 40 episodes of 30 steps an iteration.
pub fn small(method: &str, settings: Settings) -> Experiment {
    let few = [("train.env_steps", "9600"), ("train.evaluation_episodes", "4"), ("search.inner_env_steps", "2400")];
    let steps = if matches!(method, "cmaes" | "ars") { "40000" } else { few[0].1 };
    let layers = few.iter().fold(layers("reach"), |layers, (k, v)| layers.with_override(k, v));
    let layers = layers.with_override("train.env_steps", steps);
    let layers = settings.iter().fold(layers, |layers, (k, v)| layers.with_override(k, v));
    resolve(layers, Some(method)).unwrap()
}

/// A path in `root` where nothing is: a test gives its `env!("CARGO_TARGET_TMPDIR")`.
pub fn empty(root: &str, name: &str) -> PathBuf {
    let path = Path::new(root).join(name);
    let _ = fs::remove_dir_all(&path);
    path
}

/// Keeps rows, and every checkpoint there can be.
#[derive(Default)]
pub struct Keeper {
    /// The rows, without the time they took.
    pub rows: Vec<MetricsRow>,
    /// The checkpoints.
    pub checkpoints: Vec<Checkpoint>,
}

impl Observer for Keeper {
    fn on(&mut self, event: Event<'_>) -> Result<(), ObserverError> {
        match event {
            Event::Iteration(row) => self.rows.push(MetricsRow { wall_s: 0.0, ..row.clone() }),
            Event::Checkpoint(checkpoint) => self.checkpoints.push(checkpoint.clone()),
            _ => {}
        }
        Ok(())
    }

    fn due(&self) -> bool {
        true
    }
}

/// So many threads.
pub fn executor(threads: usize) -> Box<dyn Executor> {
    if threads == 1 { Box::new(Serial) } else { Box::new(Threads::new(threads).unwrap()) }
}

/// Trains from the beginning or from a checkpoint.
pub fn run(assembly: &Assembly, from: Option<&Checkpoint>, threads: usize) -> (Trained, Keeper) {
    let mut keeper = Keeper::default();
    let trained = train_from(from, assembly, &*executor(threads), &mut keeper, &AtomicBool::new(false)).unwrap();
    (trained, keeper)
}

/// Everything of a result but the time it took, so that equal texts are equal bits.
pub fn told(trained: &Trained) -> String {
    let bits: Vec<u32> = trained.params.iter().map(|p| p.to_bits()).collect();
    format!("{bits:?} {:?}", Trained { wall_s: 0.0, ..trained.clone() })
}

/// Sets the flag after some checkpoints or rows, as a signal would.
pub struct Stopper<'a> {
    /// Is told everything.
    pub inner: &'a mut dyn Observer,
    /// The flag.
    pub stop: &'a AtomicBool,
    /// How many.
    pub after: usize,
}

impl Observer for Stopper<'_> {
    fn on(&mut self, event: Event<'_>) -> Result<(), ObserverError> {
        if matches!(event, Event::Checkpoint(_)) {
            self.after = self.after.saturating_sub(1);
            self.stop.fetch_or(self.after == 0, Ordering::Relaxed);
        }
        self.inner.on(event)
    }

    fn due(&self) -> bool {
        self.inner.due()
    }
}

/// Lets `how` change what the environments of an assembly answer to an effort.
pub fn spoil(assembly: &mut Assembly, how: impl Fn(&[f64], Step) -> Step + Send + Sync + 'static) {
    let (how, whole): (Arc<How>, _) = (Arc::new(how), assembly.worlds.training.make.clone());
    assembly.worlds.training.make = Arc::new(move |horizon| {
        Box::new(Watched::new(whole.make(horizon), Spoiler { how: how.clone() })) as Box<dyn Environment>
    });
    assembly.worlds.deployment = assembly.worlds.training.clone();
}

type How = dyn Fn(&[f64], Step) -> Step + Send + Sync;

struct Spoiler {
    how: Arc<How>,
}

impl Watch for Spoiler {
    fn step(&mut self, inner: &mut dyn Environment, effort: &[f64], command: &[f64]) -> Step {
        (self.how)(effort, inner.step(effort, command))
    }
}
