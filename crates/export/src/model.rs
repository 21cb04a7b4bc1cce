//! The two functions that are exported, by their tensors.

use hwasp_core::{CommandPort, Dimension, EnvSpec, Port};
use serde::Serialize;

/// The name of the first dimension of every tensor: as many rows as the caller likes.
pub(super) const BATCH: &str = "batch";
pub(super) const OBSERVATION: &str = "observation";
pub(super) const STATE: &str = "state";
pub(super) const COMMAND: &str = "command";
pub(super) const EFFORT: &str = "effort";

/// What is exported.
#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub(super) struct Models {
    /// Observation to command.
    pub(super) controller: Model,
    /// Observation and state to command and effort: the controller with the law of the hardware as built.
    pub(super) policy: Model,
}

/// A function of tensors.
#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub(super) struct Model {
    pub(super) about: &'static str,
    pub(super) arithmetic: &'static str,
    pub(super) inputs: Vec<TensorSpec>,
    pub(super) outputs: Vec<TensorSpec>,
}

/// The type of a tensor's elements.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(rename_all = "lowercase")]
pub(super) enum ElementType {
    Float32,
    Float64,
}

/// An input or output: rows of the quantities that the contract lists under the same name.
#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub(super) struct TensorSpec {
    pub(super) name: &'static str,
    #[serde(rename = "type")]
    pub(super) element: ElementType,
    pub(super) shape: (&'static str, usize),
    /// The quantities with their units, for those who open a model alone.
    #[serde(skip)]
    pub(super) doc: String,
}

impl Models {
    pub(super) fn new(env: &EnvSpec) -> Self {
        let seen = |element| tensor(OBSERVATION, element, &listed(&env.observation));
        let said = |element| tensor(COMMAND, element, &env.command.iter().map(command).collect::<Vec<_>>());
        // A law may read no state, and a world may have no law.
        let plain =
            |name, ports: &[Port]| (!ports.is_empty()).then(|| tensor(name, ElementType::Float64, &listed(ports)));
        Self {
            controller: Model {
                about: "the deterministic controller",
                arithmetic: "float32",
                inputs: vec![seen(ElementType::Float32)],
                outputs: vec![said(ElementType::Float32)],
            },
            policy: Model {
                about: "the deterministic controller and the law of the hardware as built",
                arithmetic: "the network in float32, all before and after it in float64, as in the simulation",
                inputs: [seen(ElementType::Float64)].into_iter().chain(plain(STATE, &env.state)).collect(),
                outputs: [said(ElementType::Float64)].into_iter().chain(plain(EFFORT, &env.effort)).collect(),
            },
        }
    }
}

fn tensor(name: &'static str, element: ElementType, quantities: &[String]) -> TensorSpec {
    TensorSpec { name, element, shape: (BATCH, quantities.len()), doc: quantities.join(", ") }
}

fn listed(ports: &[Port]) -> Vec<String> {
    ports.iter().map(|port| with_unit(&port.name, port.dimension)).collect()
}

fn command(port: &CommandPort) -> String {
    format!("{} in [{}, {}]", with_unit(&port.name, port.dimension), port.lo, port.hi)
}

fn with_unit(name: &str, dimension: Dimension) -> String {
    if dimension == Dimension::None { name.to_owned() } else { format!("{name} ({})", dimension.si()) }
}
