//! What is known of a run before it has rows: its experiment, where it came from, and the design that may move.

use std::fs;
use std::path::Path;

use hwasp_core::unit;
use hwasp_experiment::{Catalogue, EXPERIMENT, Experiment, Group, LONGEST_FILE, Place};
use hwasp_problem::{Role, Words};
use hwasp_runs::saved_experiment;
use serde::{Deserialize, Serialize};

/// The head of an experiment file, which can be read without its problem.
#[derive(Clone, Debug, Default, Deserialize)]
pub(crate) struct Head {
    pub(crate) name: Option<String>,
    pub(crate) method: Option<String>,
    pub(crate) seed: Option<u64>,
    #[serde(default)]
    pub(crate) task: TaskHead,
    #[serde(default)]
    pub(crate) train: TrainHead,
}

#[derive(Clone, Debug, Default, Deserialize)]
pub(crate) struct TaskHead {
    pub(crate) problem: Option<String>,
}

#[derive(Clone, Debug, Default, Deserialize)]
pub(crate) struct TrainHead {
    pub(crate) env_steps: Option<u64>,
}

/// A group of design parameters.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct DesignGroup {
    pub(crate) name: String,
    pub(crate) meaning: String,
    /// The unit in which it reads well, and how many SI units that is.
    pub(crate) unit: &'static str,
    pub(crate) to_si: f64,
    /// Limits of each parameter, SI.
    pub(crate) limits: [f64; 2],
    /// The names of its parameters.
    pub(crate) parameters: Vec<String>,
    /// Whether training moves any of them.
    pub(crate) moves: bool,
    /// The best total, where it is known, SI.
    pub(crate) optimum: Option<f64>,
}

/// What an experiment says.
#[derive(Debug, Default)]
pub(crate) struct About {
    pub(crate) head: Head,
    /// The problem in a sentence.
    pub(crate) told: String,
    pub(crate) words: Words,
    pub(crate) design: Vec<DesignGroup>,
    /// Why the experiment is not understood here, and nothing of it can be simulated.
    pub(crate) fault: Option<String>,
}

impl About {
    /// Of a run folder.
    pub(crate) fn read(run: &Path, catalogue: &Catalogue) -> Self {
        let file = run.join(EXPERIMENT);
        let size = fs::metadata(&file).map_or(0, |file| file.len());
        let text = if size <= LONGEST_FILE as u64 { fs::read_to_string(&file).ok() } else { None };
        let head: Head = text.and_then(|text| toml::from_str(&text).ok()).unwrap_or_default();
        match saved_experiment(run, &[], catalogue) {
            Ok(experiment) => Self::of(head, &experiment),
            Err(error) => Self {
                head,
                fault: Some(error.to_string().trim_start_matches("error: ").to_owned()),
                ..Self::default()
            },
        }
    }

    fn of(head: Head, experiment: &Experiment) -> Self {
        let built = experiment.task.built();
        let groups = experiment.task.groups();
        let design = groups.iter().zip(&built.optimum).map(|(group, &optimum)| {
            let most = group.hi.abs().max(group.lo.abs()) * group.count as f64;
            let shown = unit(group.dimension.si()).map(|unit| unit.readable(most));
            DesignGroup {
                name: group.name.clone(),
                meaning: built.words.meaning(Role::Design, &group.name).unwrap_or_default().to_owned(),
                unit: shown.map_or("", |unit| unit.symbol),
                to_si: shown.map_or(1.0, |unit| unit.to_si),
                limits: [group.lo, group.hi],
                parameters: names(group),
                moves: (group.first..group.first + group.count).any(|i| experiment.design.place_of(i) != Place::Fixed),
                optimum,
            }
        });
        let told = if experiment.description.is_empty() { &built.words.about } else { &experiment.description };
        Self { head, told: told.clone(), words: built.words.clone(), design: design.collect(), fault: None }
    }
}

/// The names of the parameters of a group, as [`hwasp_core::DesignSpace::names`] has them.
fn names(group: &Group) -> Vec<String> {
    if group.count == 1 {
        return vec![group.name.clone()];
    }
    (0..group.count).map(|i| format!("{}[{i}]", group.name)).collect()
}
