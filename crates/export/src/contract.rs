//! What a caller of the exported controller has to know: names, shapes, units, rates, limits, frames, what becomes of commands,
//! where an episode starts and what counts as success.
//!
//! `HWASP_WRITE_DOCS=1 cargo test -p hwasp-export --lib` writes `docs/contract.schema.json` anew from these types.

#[cfg(test)]
mod tests;

use hwasp_core::{Dimension, Port};
use hwasp_diff::Activation;
use hwasp_problem::Role;
use hwasp_runs::files::json;
use serde::Serialize;

use crate::deployed::Deployed;
use crate::error::ExportError;
use crate::file::ExportFile;
use crate::manual::{Described, MotorEntry, SensorEntry, TopicEntry, frames, motor, sensor, topics};
use crate::model::Models;

/// The sidecar of every exported controller.
pub(super) const CONTRACT: &str = "contract.json";

/// The contract. Every quantity is in the SI unit that stands beside it.
#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub(super) struct Contract {
    format: &'static str,
    hwasp_version: &'static str,
    experiment: String,
    task: String,
    /// The robot, its purpose and what of it is designed.
    #[serde(skip_serializing_if = "String::is_empty")]
    about: String,
    method: &'static str,
    seed: u64,
    control: Control,
    network: Network,
    /// The frames that positions are told in.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    frames: Vec<Described>,
    /// In order.
    observation: Vec<Observed>,
    /// What only the law reads.
    state: Vec<Quantity>,
    /// In order.
    command: Vec<Commanded>,
    effort: Vec<Quantity>,
    design: Vec<Designed>,
    /// What else there is to know of the problem, by subject.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    manual: Vec<TopicEntry>,
    pub(super) models: Models,
}

/// How often the controller acts.
#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
struct Control {
    period_s: f64,
    rate_hz: f64,
    /// Steps of an episode in training and evaluation.
    horizon_steps: usize,
    /// What a command is between two periods.
    between: &'static str,
    /// What the controller keeps from one period to the next.
    memory: &'static str,
    /// What to do where something is wrong.
    faults: Vec<Described>,
}

/// What to do where something is wrong: the same for every controller.
const FAULTS: [(&str, &str); 3] = [
    (
        "not finite",
        "an observation that is NaN or infinite gives commands that are NaN or mean nothing: look before asking, and take it for a \
         missing one; give no command that is not finite to a motor",
    ),
    (
        "missing",
        "in training nothing was ever missing: give the last whole observation again for a few periods at most, then every \
         command's `hold` where it has one, and stop",
    ),
    (
        "out of range",
        "the network was trained on observations within a few `scale` of `center`: far beyond, its commands mean nothing, though \
         they are within their limits",
    ),
];

#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
struct Network {
    /// Inputs, hidden layers, outputs.
    sizes: Vec<usize>,
    hidden_activation: &'static str,
    output_activation: &'static str,
}

/// Something with a name and a unit.
#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
struct Quantity {
    name: String,
    unit: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    meaning: Option<String>,
}

/// What the controller sees; it works with (observation - center)/scale, within plus or minus the clip where there is one.
#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
struct Observed {
    #[serde(flatten)]
    quantity: Quantity,
    #[serde(flatten)]
    sensor: Option<SensorEntry>,
    center: f64,
    scale: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    clip: Option<f64>,
}

/// What the controller says: the network's output times scale, plus offset, within limits.
#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
struct Commanded {
    #[serde(flatten)]
    quantity: Quantity,
    #[serde(flatten)]
    motor: Option<MotorEntry>,
    limits: [f64; 2],
    scale: f64,
    offset: f64,
}

/// A parameter of the hardware, as built.
#[derive(Debug, Serialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
struct Designed {
    name: String,
    unit: &'static str,
    limits: [f64; 2],
    value: f64,
}

impl Contract {
    pub(super) fn new(deployed: &Deployed) -> Self {
        let Deployed { spec, env, design, .. } = deployed;
        let (policy, built) = (deployed.policy.spec(), spec.task.built());
        let (words, manual) = (&built.words, &built.manual);
        let quantity = |role, name: &str, dimension: Dimension| Quantity {
            name: name.to_owned(),
            unit: dimension.si(),
            meaning: words.meaning(role, name).map(str::to_owned),
        };
        let all = |role, ports: &[Port]| -> Vec<Quantity> {
            ports.iter().map(|port| quantity(role, &port.name, port.dimension)).collect()
        };
        let normalizer = deployed.normalizer();
        let (scaling, clip) = (normalizer.center().iter().zip(normalizer.scale()), normalizer.clip());
        let observed = all(Role::Observation, &env.observation).into_iter().zip(scaling);
        let commanded = env.command.iter().map(|port| Commanded {
            quantity: quantity(Role::Command, &port.name, port.dimension),
            motor: motor(manual, &port.name, [port.lo, port.hi], env.time_step),
            limits: [port.lo, port.hi],
            scale: 0.5 * (port.hi - port.lo),
            offset: 0.5 * (port.hi + port.lo),
        });
        let space = deployed.world.law.design();
        let units = space.groups().iter().flat_map(|group| vec![group.dimension.si(); group.count]);
        let designed = space.names().into_iter().zip(units).zip(design).enumerate();
        Self {
            format: "hwasp-contract-1",
            hwasp_version: env!("CARGO_PKG_VERSION"),
            experiment: spec.name.clone(),
            task: spec.task.name().to_owned(),
            about: words.about.clone(),
            method: spec.method.name(),
            seed: spec.seed,
            control: Control {
                period_s: env.time_step,
                rate_hz: 1.0 / env.time_step,
                horizon_steps: env.horizon,
                between: "the last command is held",
                memory: "none: a command follows from one observation alone",
                faults: FAULTS.map(|(name, meaning)| Described { name: name.into(), meaning: meaning.into() }).into(),
            },
            network: Network {
                sizes: deployed.policy.controller().sizes().to_vec(),
                hidden_activation: activation_name(policy.activation),
                output_activation: activation_name(deployed.output_activation()),
            },
            frames: frames(manual),
            observation: observed
                .map(|(quantity, (&center, &scale))| {
                    let sensor = sensor(manual, &quantity.name);
                    Observed { quantity, sensor, center, scale, clip }
                })
                .collect(),
            state: all(Role::State, &env.state),
            command: commanded.collect(),
            effort: all(Role::Effort, &env.effort),
            design: designed
                .map(|(i, ((name, unit), &value))| Designed { name, unit, limits: space.bounds(i).into(), value })
                .collect(),
            manual: topics(manual),
            models: Models::new(env),
        }
    }

    /// The sidecar.
    pub(super) fn file(&self) -> Result<ExportFile, ExportError> {
        Ok(ExportFile { name: CONTRACT.to_owned(), contents: json(CONTRACT, self)? })
    }
}

/// What an activation is called in files.
pub(super) fn activation_name(activation: Activation) -> &'static str {
    match activation {
        Activation::Tanh => "tanh",
        Activation::Relu => "relu",
        Activation::Identity => "identity",
    }
}
