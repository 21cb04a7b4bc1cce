//! Who gives the same bits: the same version of the program, the same sources, the same engine, and arithmetic that rounds alike.

use hwasp_core::{EpisodeKind, Episodes};
use hwasp_experiment::{Catalogue, load, resolve};
use hwasp_training::collect::{CollectError, EpisodesRequest, ExperimentText, Request, Stage};
use hwasp_training::{Assembly, Worker};
use serde::{Deserialize, Serialize};

use crate::message::{hash, pack};

/// Experiments of which an episode is run, and whether it needs the engine.
const PROBES: [(&str, bool); 2] = [("mass-spring", false), ("z-grasp", true)];
/// What a program has that has no engine.
const NO_ENGINE: &str = "none";
const PROBE_STEPS: usize = 60;

/// What the bits of an answer depend on, besides its request.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Identity {
    /// The program's version.
    pub version: String,
    /// A hash of the program's sources.
    pub sources: String,
    /// The engine and its version; `none` where the program has none.
    pub engine: String,
    /// A hash of the names of what experiments may name.
    pub catalogue: String,
    /// A hash of what elementary functions and two short episodes come to here.
    pub arithmetic: String,
}

impl Identity {
    /// Of this program with its problems and learners, on this machine. Takes a moment, for it computes.
    ///
    /// # Errors
    /// Where an episode of a probe cannot be run.
    pub fn new(catalogue: &Catalogue, engine: Option<&str>) -> Result<Self, CollectError> {
        let mut numbers = elementary();
        for (name, _) in PROBES.iter().filter(|probe| !probe.1 || engine.is_some()) {
            numbers.extend(episode(name, catalogue)?);
        }
        let problems = catalogue.problems().iter().map(|problem| problem.name());
        let mut names: Vec<&str> = problems.chain(catalogue.learners().iter().map(|learner| learner.name())).collect();
        names.sort_unstable();
        Ok(Self {
            version: env!("CARGO_PKG_VERSION").to_owned(),
            sources: env!("HWASP_SOURCES").to_owned(),
            engine: engine.unwrap_or(NO_ENGINE).to_owned(),
            catalogue: short(names.join("\n").as_bytes()),
            arithmetic: short(&numbers),
        })
    }

    /// All of it in one word.
    pub fn digest(&self) -> String {
        let Self { version, sources, engine, catalogue, arithmetic } = self;
        short([version, sources, engine, catalogue, arithmetic].map(String::as_str).join("\n").as_bytes())
    }

    /// What of another one is not the same, in words; none where all is.
    pub fn differs(&self, other: &Self) -> Option<String> {
        let fields = [
            ("version", &self.version, &other.version),
            ("sources", &self.sources, &other.sources),
            ("engine", &self.engine, &other.engine),
            ("problems and learners", &self.catalogue, &other.catalogue),
            ("arithmetic", &self.arithmetic, &other.arithmetic),
        ];
        let differing = fields.into_iter().filter(|(_, here, there)| here != there);
        let told: Vec<String> =
            differing.map(|(what, here, there)| format!("{what} {there} instead of {here}")).collect();
        (!told.is_empty()).then(|| told.join(", "))
    }
}

fn short(bytes: &[u8]) -> String {
    hash(bytes)[..12].to_owned()
}

/// Functions whose last bits are the platform's.
fn elementary() -> Vec<u8> {
    let functions: [fn(f64) -> f64; 8] =
        [f64::sin, f64::cos, f64::tan, f64::exp, f64::tanh, f64::atan, |x| x.abs().ln(), |x| x.abs().powf(1.7)];
    let values = (1..=400).map(|i| f64::from(i) * 0.037 - 7.3);
    values.flat_map(|x| functions.map(|f| f(x))).flat_map(f64::to_le_bytes).collect()
}

/// An episode with noise; nothing where the catalogue does not have it.
fn episode(name: &str, catalogue: &Catalogue) -> Result<Vec<u8>, CollectError> {
    let setup = |error: &dyn std::fmt::Display| CollectError::Setup(format!("{name}: {error}"));
    let Ok(layers) = load(name, catalogue) else { return Ok(Vec::new()) };
    let experiment = resolve(layers, None, catalogue).map_err(|error| setup(&error))?;
    let assembly = Assembly::new(&experiment).map_err(|error| setup(&error))?;
    let indices = 0..1;
    let episodes = Episodes { seed: 1, iteration: 0, indices, progress: 0.0, kind: EpisodeKind::Training };
    let request = EpisodesRequest {
        experiment: ExperimentText::of(assembly.experiment())?,
        stage: Stage::Training,
        params: assembly.init(),
        episodes,
        steps: Some(PROBE_STEPS),
        lanes: None,
    };
    let answer = Worker::new(catalogue.clone()).answer(&Request::Rows(request), &())?;
    pack(&answer).map_err(|error| setup(&error))
}
