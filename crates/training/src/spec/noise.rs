//! `[noise]`: standard deviations of the Gaussian that explores.

use hwasp_core::{Dimension, parse_quantity};
use serde::{Serialize, Serializer};

use super::design::{DesignSpec, Place};
use super::section::Section;
use super::task::{Problem, TaskSpec};
use super::tree::Value;
use super::values::with_unit;

/// A quantity whose dimension depends on the task.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EffortSpec {
    /// In SI.
    pub value: f64,
    /// Force, length, speed or torque.
    pub dimension: Dimension,
}

/// A number for each command; one alone stands for all in files.
#[derive(Clone, Debug, PartialEq)]
pub struct PerCommand(pub Vec<f64>);

/// `[noise]`: initial standard deviations, trained or annealed from there.
///
/// | key | default | meaning | limits |
/// |---|---|---|---|
/// | `command` | 0.3 | of the motor commands, as a fraction of their range; a list for one each | 1e-6 to 10 |
/// | `effort` | "3 N" (rigid bar: "0.1 m", reach: "0.1 m/s", pendulum: "0.5 N·m", grasps: "0.02 N·m") | of the effort, where a parameter sits in the graph | 1e-6 to 1e4 |
/// | `design` | 0.3 | of a parameter in the action, as a fraction of its range | 1e-6 to 10 |
/// | `command_final`, `effort_final`, `design_final` | "none" | annealed geometrically to this | as above |
/// | `anneal` | [0.25, 0.75] | begin and end of annealing, fractions of training | 0 to 1, in order |
/// | `train` | true | whether the standard deviations are trained | |
/// | `learning_rate_scale` | 1.0 | times the policy's learning rate (PPO) | 0 to 1000 |
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct NoiseSpec {
    /// Of the motor commands, as a fraction of their range.
    pub command: PerCommand,
    /// What that is annealed to.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub command_final: Option<PerCommand>,
    /// Of the effort; none where no parameter sits in the graph, and the effort is no action.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub effort: Option<EffortSpec>,
    /// What that is annealed to.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub effort_final: Option<EffortSpec>,
    /// Of a parameter in the action, as a fraction of its range.
    pub design: f64,
    /// What that is annealed to.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub design_final: Option<f64>,
    /// Begin and end of annealing, as fractions of training.
    pub anneal: [f64; 2],
    /// Whether the standard deviations are trained.
    pub train: bool,
    /// Times the policy's learning rate.
    pub learning_rate_scale: f64,
}

impl NoiseSpec {
    /// Reads the table for a task and the places of its parameters.
    pub(super) fn read(mut s: Section<'_>, task: &TaskSpec, design: &DesignSpec) -> Self {
        let fraction = 1e-6..=10.0;
        let commands = task.commands();
        let command = s.each("command", commands, &fraction).unwrap_or_else(|| vec![0.3; commands]);
        let command_final = s.each("command_final", commands, &fraction).map(PerCommand);
        let in_graph = (0..task.groups().iter().map(|g| g.count).sum()).any(|i| design.place_of(i) == Place::Graph);
        let (effort, effort_final) = if in_graph {
            read_effort(&mut s, task)
        } else {
            (skim(&mut s, "effort", task), skim(&mut s, "effort_final", task))
        };
        let spec = Self {
            command: PerCommand(command),
            command_final,
            effort,
            effort_final,
            design: s.number("design", 0.3, fraction.clone()),
            design_final: s.optional_number("design_final", fraction),
            anneal: s.fractions("anneal", [0.25, 0.75]),
            train: s.flag("train", true),
            learning_rate_scale: s.number("learning_rate_scale", 1.0, 0.0..=1000.0),
        };
        s.finish();
        spec
    }
}

fn read_effort(s: &mut Section<'_>, task: &TaskSpec) -> (Option<EffortSpec>, Option<EffortSpec>) {
    let dimension = task.effort_dimension();
    let default = match dimension {
        _ if matches!(task.problem, Problem::ZGrasp(_) | Problem::SpatialGrasp(_)) => 0.02,
        Dimension::Force => 3.0,
        Dimension::Torque => 0.5,
        _ => 0.1,
    };
    let range = 1e-6..=1e4;
    let value = s.quantity("effort", dimension, default, &range);
    let end = s.optional_quantity("effort_final", dimension, 0.01 * default, &range);
    (Some(EffortSpec { value, dimension }), end.map(|value| EffortSpec { value, dimension }))
}

/// A key that says nothing here, because the effort is no action: a base table may have it for another method, whose
/// effort may even have another unit. It still has to be a quantity.
fn skim(s: &mut Section<'_>, key: &'static str, task: &TaskSpec) -> Option<EffortSpec> {
    let node = s.take(key)?;
    let any = [Dimension::Force, Dimension::Length, Dimension::Speed, Dimension::Torque, task.effort_dimension()];
    let fits = match &node.value {
        Value::Text(text) => text == "none" || any.iter().any(|&d| parse_quantity(text, d).is_ok()),
        _ => false,
    };
    if !fits {
        s.wrong(key, node, "is not a quantity", Some("write it like \"3 N\"".into()));
    }
    None
}

impl Serialize for PerCommand {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match &self.0[..] {
            [first, rest @ ..] if rest.iter().all(|other| other == first) => serializer.serialize_f64(*first),
            all => serializer.collect_seq(all),
        }
    }
}

impl Serialize for EffortSpec {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(&with_unit(self.value, self.dimension))
    }
}
