//! The figures of a finished run, as `summary.json` and `design.toml` hold them.

use std::collections::BTreeMap;

use hwasp_training::{Assembly, Evaluation, Trained};
use serde::{Deserialize, Serialize};

use crate::checkpoint::experiment_hash;

/// One group of design parameters, SI.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct DesignGroupSummary {
    /// The SI unit of all values, empty for pure numbers.
    pub unit: String,
    /// Limits of each parameter.
    pub limits: [f64; 2],
    /// The sum of the values as trained.
    pub total: f64,
    /// The sum of the values to build.
    pub total_as_built: f64,
    /// The best total as built, where it is known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub optimum: Option<f64>,
    /// The values as trained.
    pub values: Vec<f64>,
    /// The values to build: other than the trained ones only where the law softens an interface.
    pub as_built: Vec<f64>,
}

/// A run in figures.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Summary {
    /// The experiment.
    pub experiment: String,
    /// How learner, policy and hardware were composed.
    pub method: String,
    /// The problem.
    pub task: String,
    /// SHA-256 of the values in its `experiment.toml`, so that a file that was changed afterwards is noticed; runs before 0.1.0
    /// have none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub experiment_sha256: Option<String>,
    /// The root seed.
    pub seed: u64,
    /// Iterations done.
    pub iterations: u64,
    /// Real simulator steps of training.
    pub env_steps: u64,
    /// Time of training, s.
    pub wall_s: f64,
    /// Real simulator steps per second of training, updates included.
    pub steps_per_s: f64,
    /// Mean discounted return of the noisy training episodes over the last 11 iterations in which some came to their end; none
    /// where none ever did.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub training_discounted_return: Option<f64>,
    /// The same, undiscounted.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub training_return: Option<f64>,
    /// Candidates of a search that failed and ranked last.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub failed_candidates: Option<u64>,
    /// How the first of them failed: episode, step and cause.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub first_failure: Option<String>,
    /// Episodes whose physics failed.
    #[serde(default)]
    pub discarded_episodes: u64,
    /// Steps that polished the controller, of those of training; none where the experiment asks for no polish.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub polish_steps: Option<u64>,
    /// The deterministic policy on held-out starts, on the hardware as built.
    pub evaluation: Evaluation,
    /// The design.
    pub design: BTreeMap<String, DesignGroupSummary>,
}

impl Summary {
    /// The figures of a training.
    pub fn new(assembly: &Assembly, trained: &Trained) -> Self {
        let spec = assembly.experiment();
        Self {
            experiment: spec.name.clone(),
            method: spec.method.name().to_owned(),
            task: spec.task.name().to_owned(),
            experiment_sha256: spec.to_toml().ok().and_then(|text| values_hash(&text)),
            seed: spec.seed,
            iterations: trained.iterations,
            env_steps: trained.env_steps,
            wall_s: trained.wall_s,
            steps_per_s: trained.env_steps as f64 / trained.wall_s.max(f64::MIN_POSITIVE),
            training_discounted_return: known(trained.training_discounted_return),
            training_return: known(trained.training_return),
            failed_candidates: trained.failed_candidates,
            first_failure: trained.first_failure.clone(),
            discarded_episodes: trained.discarded_episodes,
            polish_steps: trained.polish_steps,
            evaluation: trained.evaluation.clone(),
            design: design_summary(assembly, &trained.params),
        }
    }
}

/// A figure, unless it is NaN, for which JSON has no text.
fn known(figure: f64) -> Option<f64> {
    (!figure.is_nan()).then_some(figure)
}

/// SHA-256 of what an experiment file says: of its values, whatever its comments, its layout and the order of its keys. None
/// where it is no TOML.
pub(crate) fn values_hash(text: &str) -> Option<String> {
    let table: BTreeMap<String, toml::Value> = toml::from_str(text).ok()?;
    serde_json::to_string(&table).ok().map(|values| experiment_hash(&values))
}

/// The design in `params`, by group.
fn design_summary(assembly: &Assembly, params: &[f32]) -> BTreeMap<String, DesignGroupSummary> {
    let policy = &assembly.policy;
    let design = policy.design(params);
    let built = assembly.worlds.training.law.as_built(&design);
    let mut at = 0;
    let mut groups = BTreeMap::new();
    for (group, optimum) in policy.space().groups().iter().zip(&assembly.worlds.optimum) {
        let range = at..at + group.count;
        at = range.end;
        let (values, as_built) = (design[range.clone()].to_vec(), built[range].to_vec());
        let summary = DesignGroupSummary {
            unit: group.dimension.si().to_owned(),
            limits: [group.lo, group.hi],
            total: values.iter().sum(),
            total_as_built: as_built.iter().sum(),
            optimum: *optimum,
            values,
            as_built,
        };
        groups.insert(group.name.clone(), summary);
    }
    groups
}
