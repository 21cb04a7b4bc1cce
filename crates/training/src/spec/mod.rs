//! Experiment files: TOML becomes a [`Spec`] in which nothing is left open, or a list of everything that is wrong with it.
//!
//! An experiment has layers, and the later ones win: the file; its `[methods.<method>]` tables, which hold the same
//! tables as the file does; what the command line sets. A place in one of them goes with every value, so that each
//! [`Fault`] can show its line. Files are taken for hostile: their size, their counts and their numbers have limits.
//!
//! ```
//! let layers = hwasp_training::spec::load("mass-spring")?.with_override("ppo.clip_ratio", "0.1");
//! let spec = hwasp_training::spec::resolve(layers, Some("minimal"))?;
//! assert_eq!(spec.ppo.clip_ratio, 0.1);
//!
//! // What a run folder keeps gives the same experiment again.
//! let again = hwasp_training::spec::Layers::from_text("experiment.toml", &spec.to_toml()?)?;
//! assert_eq!(hwasp_training::spec::resolve(again, None)?, spec);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod builtin;
mod controller;
mod design;
mod fault;
mod grasp;
mod layers;
mod learner;
mod names;
mod noise;
mod own;
mod quantity;
mod search;
mod section;
mod source;
mod suggest;
mod task;
mod train;
mod tree;
mod values;

use serde::Serialize;

pub use builtin::{EXPERIMENT, EXPERIMENTS, load};
pub use controller::{ActivationKind, ControllerSpec, MOST_LAYERS, WIDEST_LAYER};
pub use design::{DesignSpec, InitialSpec, InitialValue, Place, PlacedRange};
pub use fault::{Excerpt, Fault, SpecErrors, shorten};
pub use grasp::{GraspProblem, HandRangeKind, ObjectKind, SpanSpec, ViewpointKind};
pub use layers::{LONGEST_FILE, Layers};
pub use learner::{Algorithm, BaselineKind, BaselineSpec, LearnerSpec, PpoSpec, TrpoSpec};
pub use noise::{EffortSpec, NoiseSpec, PerCommand};
pub use own::{OwnError, OwnProblem, OwnTask, Setting, register, registered};
pub use search::{ArsSpec, ArsVariant, CmaesSpec, Score, SearchSpec};
pub use suggest::nearest;
pub use task::{
    BarProblem, GroupSpec, InterfaceKind, MOST_SEGMENTS, MOST_STEPS, MassSpringSpec, Problem, ProblemKind,
    ReachProblem, RewardKind, StiffnessProblem, TaskSpec,
};
pub use train::{MOST_ROWS, TrainSpec};

use names::named;
use section::{Reader, Section};
use tree::{Node, Table, Value};

named! {
    /// A composition of learner, policy and hardware; it decides where the design sits unless `[design]` does.
    pub enum Method {
        /// The design is in the policy's graph.
        Hwasp = "hwasp",
        /// The design is in the action.
        Minimal = "minimal",
        /// The design stays as it begins.
        Fixed = "fixed",
        /// CMA-ES over controller and design.
        Cmaes = "cmaes",
        /// Augmented random search over controller and design.
        Ars = "ars",
        /// CMA-ES over the design; every candidate trains a controller of its own.
        CmaesRl = "cmaes-rl",
        /// Augmented random search over the design; every candidate trains a controller of its own.
        ArsRl = "ars-rl",
    }
}

impl Method {
    /// Whether it searches without a gradient of the whole.
    pub fn searches(self) -> bool {
        matches!(self, Self::Cmaes | Self::Ars | Self::CmaesRl | Self::ArsRl)
    }

    /// Whether every candidate of its search trains a controller of its own.
    pub fn trains_inside(self) -> bool {
        matches!(self, Self::CmaesRl | Self::ArsRl)
    }
}

/// An experiment with every field resolved.
///
/// | key | default | meaning | limits |
/// |---|---|---|---|
/// | `name` | required | what plots and folders call it | 1 to 100 characters |
/// | `description` | "" | what it is | up to 2000 characters |
/// | `method` | "hwasp" | `hwasp`, `minimal`, `fixed`, `cmaes`, `ars`, `cmaes-rl` or `ars-rl` | |
/// | `seed` | 0 | root of all random streams | 0 to 2^63 - 1 |
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Spec {
    /// What plots and folders call it.
    pub name: String,
    /// What it is.
    pub description: String,
    /// How learner, policy and hardware are composed.
    pub method: Method,
    /// Root of all random streams.
    pub seed: u64,
    /// The problem.
    pub task: TaskSpec,
    /// The network that commands the motors.
    pub controller: ControllerSpec,
    /// Where the design sits and begins.
    pub design: DesignSpec,
    /// Exploration.
    pub noise: NoiseSpec,
    /// What improves the policy.
    pub learner: LearnerSpec,
    /// Settings of PPO.
    pub ppo: PpoSpec,
    /// Settings of TRPO.
    pub trpo: TrpoSpec,
    /// What estimates values.
    pub baseline: BaselineSpec,
    /// How the candidates of a search are scored.
    pub search: SearchSpec,
    /// Settings of CMA-ES.
    pub cmaes: CmaesSpec,
    /// Settings of augmented random search.
    pub ars: ArsSpec,
    /// How long, in which portions.
    pub train: TrainSpec,
}

impl Spec {
    /// The discount that returns are told and candidates scored by: the learner's.
    pub fn discount(&self) -> f64 {
        match self.learner.algorithm {
            Algorithm::Ppo => self.ppo.discount,
            Algorithm::Trpo => self.trpo.discount,
        }
    }

    /// The resolved experiment as a file that gives the same `Spec` again.
    pub fn to_toml(&self) -> Result<String, toml::ser::Error> {
        toml::to_string(self)
    }
}

/// Checks an experiment for a method, its own if none is named, and resolves every field.
///
/// Mistakes in the tables of the other methods are told too.
pub fn resolve(layers: Layers, method: Option<&str>) -> Result<Spec, SpecErrors> {
    let layers = match method {
        Some(method) => layers.with_option(format!("--method {method}"), "method", method),
        None => layers,
    };
    let named = match layers.method() {
        Some(Node { value: Value::Text(name), .. }) => Method::from_name(name),
        _ => None,
    };
    // A method that is none is a fault of its key; the rest is checked as if it were the default.
    let method = named.unwrap_or(Method::Hwasp);
    let (spec, mut errors) = read(Reader::new(&layers.sources), &layers.overridden(method.name()), method);
    for (name, source) in layers.overlaid() {
        if errors.is_full() {
            break; // nobody reads the rest, and to look for it takes time
        }
        if let Some(other) = Method::from_name(name).filter(|&other| other != method) {
            // The command line speaks of the chosen method only.
            let (_, found) = read(Reader::of(&layers.sources, source), &layers.merged(name), other);
            found.faults().iter().for_each(|fault| errors.push(fault.clone()));
        }
    }
    layers.tell(&mut errors);
    errors.into_result()?;
    // Without faults there is a spec: only a missing or unknown problem leaves none.
    spec.ok_or_else(|| SpecErrors::single("experiment", "it cannot be resolved".into(), None))
}

/// Reads merged tables.
fn read(reader: Reader<'_>, table: &Table, method: Method) -> (Option<Spec>, SpecErrors) {
    let spec = read_spec(&reader, table, method);
    (spec, reader.into_errors())
}

fn read_spec<'r>(reader: &'r Reader<'r>, table: &'r Table, method: Method) -> Option<Spec> {
    let mut root = Section::root(reader, table);
    let name = root.text("name", 100).unwrap_or_default();
    if root.origin("name").is_none() {
        root.clash("name", "name is missing".into(), "begin the file with a line such as name = \"my-experiment\"");
    } else if name.trim().is_empty() && reader.sound(&["name"]) {
        root.clash("name", "name is empty".into(), "plots and folders are called by it");
    }
    let description = root.text("description", 2000).unwrap_or_default();
    root.choice("method", Method::ALL);
    let seed = root.integer("seed", 0, 0..=i64::MAX as u64);
    if let Some(node) = root.take("methods") {
        // Tables of a file never come this far.
        let hint = "tables for a method are written as [methods.minimal.ppo] in a file; \
                    the command line sets keys of the chosen method: --set ppo.clip_ratio=0.1";
        reader.fault(Some(&node.origin), "methods", "methods cannot be set here".into(), Some(hint.into()));
    }
    let sections = [
        "task",
        "controller",
        "design",
        "noise",
        "learner",
        "ppo",
        "trpo",
        "baseline",
        "search",
        "cmaes",
        "ars",
        "train",
    ]
    .map(|name| reader.section(&mut root, name));
    root.finish();
    let [task, controller, design, noise, learner, ppo, trpo, baseline, search, cmaes, ars, train] = sections;

    let learner = LearnerSpec::read(learner);
    let task = TaskSpec::read(task);
    let train = TrainSpec::read(train, task.as_ref().map_or(MOST_STEPS, |task| task.horizon));
    let ppo = PpoSpec::read(ppo, &train);
    let trpo = TrpoSpec::read(trpo, &ppo);
    let baseline = BaselineSpec::read(baseline, &ppo, &train);
    let search = SearchSpec::read(search, &train);
    let cmaes = CmaesSpec::read(cmaes, method);
    let ars = ArsSpec::read(ars, method);
    // The rest cannot be judged without a task.
    let task = task?;
    let controller = ControllerSpec::read(controller, task.observations());
    let design = DesignSpec::read(design, method, &task);
    let noise = NoiseSpec::read(noise, &task, &design);
    Some(Spec {
        name,
        description,
        method,
        seed,
        task,
        controller,
        design,
        noise,
        learner,
        ppo,
        trpo,
        baseline,
        search,
        cmaes,
        ars,
        train,
    })
}
