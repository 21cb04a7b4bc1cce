//! ONNX models of the controller, and of the controller with the law.
//!
//! Opset 17 and IR version 8, of 2022: what every runtime that is still in use reads. `docs/export.md` has the graphs.

mod graph;
mod law;
mod proto;
#[cfg(test)]
mod tests;

use hwasp_diff::Activation;
use hwasp_runs::encode;
use prost::Message;

use self::graph::Graph;
use self::law::{Value, law};
use self::proto::{ModelProto, OperatorSetIdProto, StringStringEntryProto};
use crate::contract::Contract;
use crate::controller::{Scaling, layer_names};
use crate::deployed::Deployed;
use crate::error::ExportError;
use crate::file::ExportFile;
use crate::model::{COMMAND, EFFORT, ElementType, Model, OBSERVATION, STATE};

const IR_VERSION: i64 = 8;
const OPSET: i64 = 17;
const CONTROLLER: &str = "controller.onnx";
const POLICY: &str = "policy.onnx";

/// Both models.
pub(super) fn models(deployed: &Deployed, contract: &Contract) -> Result<Vec<ExportFile>, ExportError> {
    let models = &contract.models;
    let mut graph = Graph::new("controller", &models.controller);
    controller(&mut graph, deployed, ElementType::Float32);
    let alone = file(CONTROLLER, graph, &models.controller, contract)?;
    let mut graph = Graph::new("policy", &models.policy);
    controller(&mut graph, deployed, ElementType::Float64);
    hardware(&mut graph, deployed);
    Ok(vec![alone, file(POLICY, graph, &models.policy, contract)?])
}

/// From observation to command, in single precision but for what is before and after the network.
fn controller(graph: &mut Graph, deployed: &Deployed, outside: ElementType) {
    let Scaling { center, scale, seen, gain, offset, lowest, highest } = Scaling::new(deployed);
    for (name, values) in [&center, &scale, &gain, &offset, &lowest, &highest].into_iter().chain(seen.iter().flatten())
    {
        graph.numbers(name, &[values.len()], values, outside);
    }
    graph.node("Sub", &[OBSERVATION, center.0], "observation.centered");
    graph.node("Div", &["observation.centered", scale.0], "observation.normalized");
    let mut at = "observation.normalized".to_owned();
    if let Some([least, most]) = &seen {
        graph.node("Max", &[&at, least.0], "observation.above");
        graph.node("Min", &["observation.above", most.0], "observation.clipped");
        "observation.clipped".clone_into(&mut at);
    }
    if outside == ElementType::Float64 {
        at = graph.cast(&at, "controller.input", ElementType::Float32);
    }
    for (l, layer) in deployed.layers().iter().enumerate() {
        let [weight, bias] = layer_names(l);
        graph.floats(&weight, &[layer.inputs, layer.outputs], layer.weight);
        graph.floats(&bias, &[layer.outputs], layer.bias);
        let sum = format!("controller.{l}.sum");
        graph.node("Gemm", &[&at, &weight, &bias], &sum);
        let op = match layer.activation {
            Activation::Tanh => "Tanh",
            Activation::Relu => "Relu",
            Activation::Identity => "Identity",
        };
        at = format!("controller.{l}");
        graph.node(op, &[&sum], &at);
    }
    if outside == ElementType::Float64 {
        at = graph.cast(&at, "controller.output", ElementType::Float64);
    }
    graph.node("Mul", &[&at, gain.0], "command.scaled");
    graph.node("Add", &["command.scaled", offset.0], "command.free");
    // Max and Min, not Clip, whose limits are the same for all components.
    graph.node("Max", &["command.free", lowest.0], "command.above");
    graph.node("Min", &["command.above", highest.0], COMMAND);
}

/// From command and state to effort, in double precision: the law of the hardware, with its design as initializers.
fn hardware(graph: &mut Graph, deployed: &Deployed) {
    let program = deployed.world.law.program();
    if program.output_names().is_empty() {
        return;
    }
    let mut uniforms = Vec::new();
    for (name, &value) in program.uniform_names().iter().zip(&deployed.design) {
        let name = format!("design.{name}");
        graph.numbers(&name, &[], &[value], ElementType::Float64);
        uniforms.push(Value { name, by_row: false });
    }
    let names = |prefix: &str, ports: &[String]| ports.iter().map(|port| format!("{prefix}.{port}")).collect();
    let ports = deployed.world.law.ports();
    let commands: Vec<String> = deployed.env.command.iter().map(|port| port.name.clone()).collect();
    let commands = split(graph, COMMAND, names(COMMAND, &commands));
    // The law need not read every command.
    let mut columns: Vec<Value> = deployed.reads.iter().map(|&c| commands[c].clone()).collect();
    columns.extend(split(graph, STATE, names(STATE, &ports.state)));
    let efforts = law(graph, program, &uniforms, &columns);
    let efforts: Vec<String> = efforts.into_iter().map(|effort| as_column(graph, effort)).collect();
    let efforts: Vec<&str> = efforts.iter().map(String::as_str).collect();
    graph.node_with("Concat", &efforts, &[EFFORT.to_owned()], &[("axis", 1)]);
}

/// Takes a tensor apart into its columns.
fn split(graph: &mut Graph, tensor: &str, columns: Vec<String>) -> Vec<Value> {
    if columns.is_empty() {
        return Vec::new();
    }
    let lengths = format!("{tensor}.columns");
    graph.whole(&lengths, &vec![1; columns.len()]);
    graph.node_with("Split", &[tensor, &lengths], &columns, &[("axis", 1)]);
    columns.into_iter().map(|name| Value { name, by_row: true }).collect()
}

/// A value as a column; one that is the same for all rows (the length of a rigid bar) is repeated.
fn as_column(graph: &mut Graph, value: Value) -> String {
    if value.by_row {
        return value.name;
    }
    let [rows, one, shape, column] = ["rows", "one", "shape", "column"].map(|part| format!("{}.{part}", value.name));
    graph.node_with("Shape", &[OBSERVATION], std::slice::from_ref(&rows), &[("start", 0), ("end", 1)]);
    graph.whole(&one, &[1]);
    graph.node_with("Concat", &[&rows, &one], std::slice::from_ref(&shape), &[("axis", 0)]);
    graph.node("Expand", &[&value.name, &shape], &column);
    column
}

fn file(name: &'static str, graph: Graph, model: &Model, contract: &Contract) -> Result<ExportFile, ExportError> {
    let contract = serde_json::to_string(contract).map_err(|e| encode(name, &e))?;
    let model = ModelProto {
        ir_version: IR_VERSION,
        producer_name: "hwasp".to_owned(),
        producer_version: env!("CARGO_PKG_VERSION").to_owned(),
        doc_string: format!("{}; arithmetic: {}", model.about, model.arithmetic),
        graph: Some(graph.0),
        opset_import: vec![OperatorSetIdProto { domain: String::new(), version: OPSET }],
        metadata_props: vec![StringStringEntryProto { key: "contract".to_owned(), value: contract }],
    };
    Ok(ExportFile { name: name.to_owned(), contents: model.encode_to_vec() })
}
