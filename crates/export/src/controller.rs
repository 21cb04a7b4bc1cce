//! The controller's numbers: their names, and the forms of them that need no runtime.

use hwasp_runs::encode;
use hwasp_runs::tensors::{Piece, serialized};
use serde::Serialize;

use crate::contract::{Contract, activation_name};
use crate::deployed::Deployed;
use crate::error::ExportError;
use crate::file::ExportFile;

const SAFETENSORS: &str = "controller.safetensors";
const JSON: &str = "controller.json";

/// What surrounds the network, one number per component: by the name of the tensor in every file.
pub(super) struct Scaling {
    pub(super) center: (&'static str, Vec<f64>),
    pub(super) scale: (&'static str, Vec<f64>),
    /// The least and the most that the network sees, where there are limits.
    pub(super) seen: Option<[(&'static str, Vec<f64>); 2]>,
    pub(super) gain: (&'static str, Vec<f64>),
    pub(super) offset: (&'static str, Vec<f64>),
    pub(super) lowest: (&'static str, Vec<f64>),
    pub(super) highest: (&'static str, Vec<f64>),
}

impl Scaling {
    /// The network sees (observation - center)/scale, limited where there are limits; its output times gain, plus offset,
    /// limited, is the command.
    pub(super) fn new(deployed: &Deployed) -> Self {
        let normalizer = deployed.normalizer();
        let all = |limit: f64| vec![limit; normalizer.center().len()];
        let of_command = |f: fn(f64, f64) -> f64| deployed.env.command.iter().map(|p| f(p.lo, p.hi)).collect();
        Self {
            center: ("observation.center", normalizer.center().to_vec()),
            scale: ("observation.scale", normalizer.scale().to_vec()),
            seen: normalizer
                .clip()
                .map(|clip| [("observation.lowest", all(-clip)), ("observation.highest", all(clip))]),
            gain: ("command.scale", of_command(|lo, hi| 0.5 * (hi - lo))),
            offset: ("command.offset", of_command(|lo, hi| 0.5 * (hi + lo))),
            lowest: ("command.lowest", of_command(|lo, _| lo)),
            highest: ("command.highest", of_command(|_, hi| hi)),
        }
    }
}

/// The names of a layer's tensors, as `policy.safetensors` has them.
pub(super) fn layer_names(layer: usize) -> [String; 2] {
    ["weight", "bias"].map(|what| format!("controller.{layer}.{what}"))
}

/// All numbers in single precision, and the contract in the metadata.
pub(super) fn safetensors(deployed: &Deployed, contract: &Contract) -> Result<ExportFile, ExportError> {
    let mut pieces = Vec::new();
    for (l, layer) in deployed.layers().iter().enumerate() {
        let [weight, bias] = layer_names(l);
        pieces.push(Piece::f32(weight, vec![layer.inputs, layer.outputs], layer.weight));
        pieces.push(Piece::f32(bias, vec![layer.outputs], layer.bias));
    }
    let Scaling { center, scale, seen, gain, offset, lowest, highest } = Scaling::new(deployed);
    let scaling = [center, scale].into_iter().chain(seen.into_iter().flatten()).chain([gain, offset, lowest, highest]);
    for (name, values) in scaling {
        let values: Vec<f32> = values.iter().map(|&v| v as f32).collect();
        pieces.push(Piece::f32(name.to_owned(), vec![values.len()], &values));
    }
    let contract = serde_json::to_string(contract).map_err(|e| encode(SAFETENSORS, &e))?;
    let about = [("format", "hwasp-controller-1".to_owned()), ("contract", contract)];
    let contents = serialized(&pieces, about).map_err(|e| encode(SAFETENSORS, &e))?;
    Ok(ExportFile { name: SAFETENSORS.to_owned(), contents })
}

/// A layer in JSON.
#[derive(Serialize)]
struct JsonLayer<'a> {
    activation: &'static str,
    /// A row per input.
    weight: Vec<&'a [f32]>,
    bias: &'a [f32],
}

/// The contract with the layers below it: nothing else is needed to run the controller.
#[derive(Serialize)]
struct JsonController<'a> {
    #[serde(flatten)]
    contract: &'a Contract,
    layers: Vec<JsonLayer<'a>>,
}

/// All numbers as text, on one line: who reads it is a program.
pub(super) fn json(deployed: &Deployed, contract: &Contract) -> Result<ExportFile, ExportError> {
    let layers = deployed.layers();
    let layers = layers.iter().map(|layer| JsonLayer {
        activation: activation_name(layer.activation),
        weight: layer.weight.chunks_exact(layer.outputs).collect(),
        bias: layer.bias,
    });
    let controller = JsonController { contract, layers: layers.collect() };
    let contents = serde_json::to_vec(&controller).map_err(|e| encode(JSON, &e))?;
    Ok(ExportFile { name: JSON.to_owned(), contents })
}
