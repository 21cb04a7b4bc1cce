//! What a caller of the exported controller has to know: names, shapes, units, rates, limits.

use hwasp_core::{Dimension, Port};
use hwasp_diff::Activation;
use hwasp_problem::Role;
use hwasp_runs::files::json;
use serde::Serialize;

use crate::deployed::Deployed;
use crate::error::ExportError;
use crate::file::ExportFile;
use crate::model::Models;

/// The sidecar of every exported controller.
pub(super) const CONTRACT: &str = "contract.json";

/// The contract. Every quantity is in the SI unit that stands beside it.
#[derive(Debug, Serialize)]
pub(super) struct Contract {
    format: &'static str,
    hwasp_version: &'static str,
    experiment: String,
    task: String,
    method: &'static str,
    seed: u64,
    control: Control,
    network: Network,
    observation: Vec<Observed>,
    state: Vec<Quantity>,
    command: Vec<Commanded>,
    effort: Vec<Quantity>,
    design: Vec<Designed>,
    pub(super) models: Models,
}

/// How often the controller acts.
#[derive(Debug, Serialize)]
struct Control {
    period_s: f64,
    rate_hz: f64,
    /// Steps of an episode in training and evaluation.
    horizon_steps: usize,
}

#[derive(Debug, Serialize)]
struct Network {
    /// Inputs, hidden layers, outputs.
    sizes: Vec<usize>,
    hidden_activation: &'static str,
    output_activation: &'static str,
}

/// Something with a name and a unit.
#[derive(Debug, Serialize)]
struct Quantity {
    name: String,
    unit: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    meaning: Option<String>,
}

/// What the controller sees; it works with (observation - center)/scale, within plus or minus the clip where there is one.
#[derive(Debug, Serialize)]
struct Observed {
    #[serde(flatten)]
    quantity: Quantity,
    center: f64,
    scale: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    clip: Option<f64>,
}

/// What the controller says: the network's output times scale, plus offset, within limits.
#[derive(Debug, Serialize)]
struct Commanded {
    #[serde(flatten)]
    quantity: Quantity,
    limits: [f64; 2],
    scale: f64,
    offset: f64,
}

/// A parameter of the hardware, as built.
#[derive(Debug, Serialize)]
struct Designed {
    name: String,
    unit: &'static str,
    limits: [f64; 2],
    value: f64,
}

impl Contract {
    pub(super) fn new(deployed: &Deployed) -> Self {
        let Deployed { spec, env, design, .. } = deployed;
        let (policy, words) = (deployed.policy.spec(), &spec.task.built().words);
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
            method: spec.method.name(),
            seed: spec.seed,
            control: Control { period_s: env.time_step, rate_hz: 1.0 / env.time_step, horizon_steps: env.horizon },
            network: Network {
                sizes: deployed.policy.controller().sizes().to_vec(),
                hidden_activation: activation_name(policy.activation),
                output_activation: activation_name(deployed.output_activation()),
            },
            observation: observed
                .map(|(quantity, (&center, &scale))| Observed { quantity, center, scale, clip })
                .collect(),
            state: all(Role::State, &env.state),
            command: commanded.collect(),
            effort: all(Role::Effort, &env.effort),
            design: designed
                .map(|(i, ((name, unit), &value))| Designed { name, unit, limits: space.bounds(i).into(), value })
                .collect(),
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
