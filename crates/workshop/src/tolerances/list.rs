//! The sensitivities as files and programs have them. Everything is in SI units.

use hwasp_training::{Change, Evaluation, MeanInterval, SuccessRate};
use serde::{Deserialize, Serialize};

/// The sensitivities of a design: `tolerances.json`. SI units.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Sensitivities {
    /// The experiment.
    pub experiment: String,
    /// How learner, controller and hardware were composed.
    pub method: String,
    /// The problem.
    pub task: String,
    /// The root seed of the run.
    pub seed: u64,
    /// The design as it should be built.
    pub nominal: Evaluation,
    /// Its parameters, the one whose error costs most return first.
    pub parameters: Vec<Sensitivity>,
}

/// What an error of one parameter does.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Sensitivity {
    /// The parameter.
    pub name: String,
    /// The SI unit of its values.
    pub unit: String,
    /// As it should be built.
    pub nominal: f64,
    /// The manufacturing error, to either side.
    pub error: f64,
    /// The error as it was given: `5 %`, `0.1 mm`.
    pub error_text: String,
    /// Too small by the error.
    pub minus: Side,
    /// Too large by it.
    pub plus: Side,
    /// What the worse of both costs of the mean return; 0 where neither costs anything.
    pub loss: f64,
}

/// The design with one parameter off.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Side {
    /// The parameter's value: within its limits, so that it may be nearer than the error.
    pub value: f64,
    /// Undiscounted return.
    #[serde(rename = "return")]
    pub undiscounted_return: MeanInterval,
    /// Success, for tasks that know it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub success: Option<SuccessRate>,
    /// From the nominal design to this one, episode by episode.
    pub change: Change,
}
