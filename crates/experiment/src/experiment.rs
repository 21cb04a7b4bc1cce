//! An experiment in which nothing is left open, and how layers become one.

use std::sync::Arc;

use hwasp_algos::{ArsSettings, BaselineSettings, BoConfig, CmaesConfig, RandomConfig};
use hwasp_settings::{Faults, Files, Item, Keys, Layers, Reader, Section, Settings, Table, read, written};

use crate::built::MOST_STEPS;
use crate::catalogue::Catalogue;
use crate::controller::ControllerSettings;
use crate::design::DesignSettings;
use crate::learner::LearnerSettings;
use crate::method::Method;
use crate::noise::NoiseSettings;
use crate::polish::PolishSettings;
use crate::search::{MOST_CORRELATED, SearchSettings};
use crate::task::Task;
use crate::train::TrainSettings;

/// The longest name of an experiment, characters.
pub(crate) const LONGEST_NAME: usize = 100;
/// The longest description.
pub(crate) const LONGEST_DESCRIPTION: usize = 2000;

/// An experiment with every field resolved.
#[derive(Clone, Debug)]
pub struct Experiment {
    /// What plots and folders call it.
    pub name: String,
    /// What it is.
    pub description: String,
    /// How learner, policy and hardware are composed.
    pub method: Method,
    /// Root of all random streams.
    pub seed: u64,
    /// The problem.
    pub task: Task,
    /// The network that commands the motors.
    pub controller: ControllerSettings,
    /// Where the design sits and begins.
    pub design: DesignSettings,
    /// Exploration.
    pub noise: NoiseSettings,
    /// What improves the policy.
    pub learner: LearnerSettings,
    /// What estimates values.
    pub baseline: BaselineSettings,
    /// How the candidates of a search are scored.
    pub search: SearchSettings,
    /// Settings of CMA-ES.
    pub cmaes: CmaesConfig,
    /// Settings of augmented random search.
    pub ars: ArsSettings,
    /// Settings of Bayesian optimisation.
    pub bo: BoConfig,
    /// Settings of random search.
    pub random: RandomConfig,
    /// How long, in which portions.
    pub train: TrainSettings,
    /// How its last part polishes the controller.
    pub polish: PolishSettings,
    catalogue: Catalogue,
}

impl PartialEq for Experiment {
    /// Whether they are the same trainings, wherever their problems came from.
    fn eq(&self, other: &Self) -> bool {
        let top = |e: &Self| (e.name.clone(), e.description.clone(), e.method, e.seed);
        top(self) == top(other)
            && self.task == other.task
            && self.controller == other.controller
            && self.design == other.design
            && self.noise == other.noise
            && self.learner == other.learner
            && self.baseline == other.baseline
            && self.search == other.search
            && (&self.cmaes, &self.ars) == (&other.cmaes, &other.ars)
            && (&self.bo, &self.random) == (&other.bo, &other.random)
            && (&self.train, &self.polish) == (&other.train, &other.polish)
    }
}

impl Experiment {
    /// What it was resolved with: to read others that lie beside it.
    pub fn catalogue(&self) -> &Catalogue {
        &self.catalogue
    }

    /// The files that it names, by their paths from its folder.
    pub fn files(&self) -> &Arc<Files> {
        &self.task.built().files
    }

    /// The discount that returns are told and candidates scored by: the learner's.
    pub fn discount(&self) -> f64 {
        self.learner.discount()
    }

    /// The resolved experiment as a file that gives the same `Experiment` again.
    pub fn to_toml(&self) -> Result<String, toml::ser::Error> {
        let mut keys = Keys::default();
        keys.push("name", Item::from(self.name.as_str()));
        keys.push("description", Item::from(self.description.as_str()));
        keys.push("method", Item::from(self.method.name()));
        keys.push("seed", Item::Integer(self.seed));
        let mut table = |name: &str, table: Keys| keys.push(name, Item::Keys(table));
        table("task", self.task.written());
        table("controller", written(&mut self.controller.clone()));
        table("design", written(&mut self.design.clone()));
        table("noise", written(&mut self.noise.clone()));
        table("learner", Keys(vec![("algorithm".to_owned(), Item::from(self.learner.algorithm()))]));
        for (name, settings) in self.learner.names().zip(&self.learner.settings) {
            table(name, written(&mut *settings.clone()));
        }
        table("baseline", written(&mut self.baseline.clone()));
        table("search", written(&mut self.search.clone()));
        table("cmaes", written(&mut self.cmaes.clone()));
        table("ars", written(&mut self.ars.clone()));
        table("bo", written(&mut self.bo.clone()));
        table("random", written(&mut self.random.clone()));
        table("train", written(&mut self.train.clone()));
        // Checkpoints of earlier versions are of experiments without it.
        if self.polish != PolishSettings::default() {
            table("polish", written(&mut self.polish.clone()));
        }
        toml::to_string(&keys)
    }
}

/// Checks an experiment for a method, its own if none is named, and resolves every field.
///
/// Mistakes in the tables of the other methods are told too.
///
/// # Errors
/// Everything that is wrong, at once.
pub fn resolve(layers: Layers, method: Option<&str>, catalogue: &Catalogue) -> Result<Experiment, Faults> {
    if catalogue.learners().is_empty() {
        let hint = "`Catalogue::with_learner` adds one, such as `PpoKind`".to_owned();
        return Err(Faults::single("catalogue", "it has no learner to train with".to_owned(), Some(hint)));
    }
    let layers = match method {
        Some(method) => layers.with_option(format!("--method {method}"), "method", method),
        None => layers,
    };
    // A method that is none is a fault of its key; the rest is checked as if it were the default.
    let method = layers.top_text("method").and_then(Method::from_name).unwrap_or(Method::Hwasp);
    let (experiment, mut faults) = read_with(layers.reader(), &layers.overridden(method.name()), method, catalogue);
    for (name, source) in layers.overlaid() {
        if faults.is_full() {
            break; // nobody reads the rest, and to look for it takes time
        }
        if let Some(other) = Method::from_name(name).filter(|&other| other != method) {
            // The command line speaks of the chosen method only.
            let (_, found) = read_with(layers.reader_of(source), &layers.merged(name), other, catalogue);
            found.faults().iter().for_each(|fault| faults.push(fault.clone()));
        }
    }
    let methods: Vec<&str> = Method::ALL.iter().map(|(name, _)| *name).collect();
    layers.tell(&methods, &mut faults);
    faults.into_result()?;
    // Without faults there is one: only a missing or unknown problem leaves none.
    Ok(experiment.expect("an experiment without faults has a problem"))
}

/// Reads merged tables.
fn read_with(reader: Reader<'_>, table: &Table, method: Method, catalogue: &Catalogue) -> (Option<Experiment>, Faults) {
    let experiment = read_experiment(&reader, table, method, catalogue);
    (experiment, reader.into_errors())
}

/// Reads a table whose settings are at their defaults.
fn read_table<S: Settings>(mut settings: S, mut section: Section<'_>) -> S {
    read(&mut settings, &mut section);
    section.finish();
    settings
}

fn read_experiment<'r>(
    reader: &'r Reader<'r>,
    table: &'r Table,
    method: Method,
    catalogue: &Catalogue,
) -> Option<Experiment> {
    let mut root = Section::root(reader, table);
    let (name, description, seed) = read_top(&mut root);
    let mut section = |name: &str| reader.section(&mut root, name);
    let [task, controller, design, noise] = ["task", "controller", "design", "noise"].map(&mut section);
    let [mut choice, baseline, search, cmaes, ars, bo, random, train, polish] =
        ["learner", "baseline", "search", "cmaes", "ars", "bo", "random", "train", "polish"].map(&mut section);
    let mut tables: Vec<(String, Section<'_>)> =
        catalogue.learners().iter().map(|kind| (kind.name().to_owned(), section(kind.name()))).collect();
    root.finish();

    let task = Task::read(task, catalogue);
    let horizon = task.as_ref().map_or(MOST_STEPS, |task| task.horizon);
    let train = read_table(TrainSettings::new(horizon, reader.sound(&["task.horizon"])), train);
    let length = reader.sound(&["train.env_steps"]);
    let sound = reader.sound(&[
        "train.episodes_per_iteration",
        "train.steps_per_iteration",
        "train.episode_steps",
        "task.horizon",
    ]);
    let mut learner = LearnerSettings::new(catalogue.learners(), train.rows());
    let table = |name: &str| {
        let at = tables.iter().position(|(other, _)| other == name);
        tables.swap_remove(at.expect("every learner has a table")).1
    };
    learner.read(&mut choice, table, &train, sound);
    let baseline = read_baseline(&learner, &train, sound, baseline);
    let search = read_table(SearchSettings::new(&train, sound), search);
    let sigma = if method == Method::CmaesRl { 0.25 } else { 0.5 };
    let cmaes = |separable| read_table(CmaesConfig { sigma, separable, ..CmaesConfig::default() }, cmaes);
    let ars = read_table(ArsSettings::new(method == Method::ArsRl), ars);
    let (bo, random) = (read_table(BoConfig::default(), bo), read_table(RandomConfig::default(), random));
    // The rest cannot be judged without a task.
    let Some(task) = task else {
        cmaes(false);
        choice.finish();
        read_table(PolishSettings::default(), polish);
        return None;
    };
    let searched_by = (method.searches() && !method.trains_inside()).then(|| method.name());
    let controller = read_table(ControllerSettings::new(task.observations(), searched_by), controller);
    if searched_by.is_none() {
        let centre = "leave it out, and write controller.observation_center and observation_scale";
        learner.check(
            &mut choice,
            [
                ("train.reward_scaling", train.reward_scaling, "leave it out: critics measure rewards by themselves"),
                ("controller.normalize_observations", controller.normalize_observations, centre),
            ],
        );
    }
    choice.finish();
    let cmaes = cmaes(method == Method::Cmaes && most_parameters(&controller, &task) > MOST_CORRELATED);
    let design = read_table(DesignSettings::new(method, task.groups()), design);
    let noise = read_table(NoiseSettings::new(&task, &design), noise);
    let polish_of = if sound && length { PolishSettings::new(&train, &task) } else { PolishSettings::default() };
    let polish = read_table(polish_of, polish);
    Some(Experiment {
        name,
        description,
        method,
        seed,
        task,
        controller,
        design,
        noise,
        learner,
        baseline,
        search,
        cmaes,
        ars,
        bo,
        random,
        train,
        polish,
        catalogue: catalogue.clone(),
    })
}

/// The most parameters that a policy may have: those of the controller, of the design, and of the noise.
fn most_parameters(controller: &ControllerSettings, task: &Task) -> usize {
    let design: usize = task.groups().iter().map(|group| group.count).sum();
    let (commands, efforts) = (task.commands(), task.efforts().len());
    let sees = task.observations() + if controller.sees_design { design } else { 0 };
    let widths = controller.hidden.iter().chain([&commands]);
    let layers = widths.scan(sees, |inputs, &outputs| Some((std::mem::replace(inputs, outputs) + 1) * outputs));
    layers.sum::<usize>() + design + (design + efforts + commands)
}

/// What stands at the top: name, description, method and seed.
fn read_top(root: &mut Section<'_>) -> (String, String, u64) {
    let name = root.text("name", LONGEST_NAME, false).unwrap_or_default();
    if !root.has("name") {
        root.clash("name", "name is missing".into(), "begin the file with a line such as name = \"my-experiment\"");
    } else if name.trim().is_empty() && root.sound(&["name"]) {
        root.clash("name", "name is empty".into(), "plots and folders are called by it");
    }
    let description = root.text("description", LONGEST_DESCRIPTION, true).unwrap_or_default();
    root.choice("method", Method::ALL);
    let seed = root.integer("seed", 0, 0..=i64::MAX as u64);
    if let Some(node) = root.take("methods") {
        // Tables of a file never come this far.
        let hint = "tables for a method are written as [methods.minimal.ppo] in a file; \
                    the command line sets keys of the chosen method: --set ppo.clip_ratio=0.1";
        root.fault_at(&node.origin, "methods", "methods cannot be set here".into(), Some(hint.into()));
    }
    (name, description, seed)
}

fn read_baseline(
    learner: &LearnerSettings,
    train: &TrainSettings,
    sound: bool,
    mut section: Section<'_>,
) -> BaselineSettings {
    let mut baseline = learner.baseline(train.rows());
    read(&mut baseline, &mut section);
    // What it takes over from a learner is judged there.
    if section.has("minibatch_rows")
        && let Some(fault) = baseline.fault(train.rows(), &train.portion()).filter(|_| sound)
    {
        section.clash(fault.key, fault.message, &fault.hint);
    }
    section.finish();
    baseline
}
