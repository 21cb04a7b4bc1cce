//! An ONNX graph, node by node.

use super::proto::{
    AttributeProto, DOUBLE, DimensionProto, FLOAT, GraphProto, INT64, NodeProto, TensorProto, TensorShapeProto,
    TensorTypeProto, TypeProto, ValueInfoProto,
};
use crate::model::{ElementType, Model, TensorSpec};

impl ElementType {
    /// Its number in ONNX.
    pub(super) fn code(self) -> i32 {
        match self {
            Self::Float32 => FLOAT,
            Self::Float64 => DOUBLE,
        }
    }
}

/// A graph that grows. Values are told apart by name; a node is called as its first output.
pub(super) struct Graph(pub(super) GraphProto);

impl Graph {
    /// A graph with a model's inputs and outputs; the nodes that make the outputs are still to come.
    pub(super) fn new(name: &str, model: &Model) -> Self {
        Self(GraphProto {
            name: name.to_owned(),
            input: model.inputs.iter().map(value_info).collect(),
            output: model.outputs.iter().map(value_info).collect(),
            ..GraphProto::default()
        })
    }

    /// Numbers that the program has in double precision, in the precision that the graph wants them in. No `dims`: a
    /// scalar.
    pub(super) fn numbers(&mut self, name: &str, dims: &[usize], values: &[f64], element: ElementType) {
        let bytes = match element {
            ElementType::Float32 => values.iter().flat_map(|&v| (v as f32).to_le_bytes()).collect(),
            ElementType::Float64 => values.iter().flat_map(|v| v.to_le_bytes()).collect(),
        };
        self.initializer(name, dims, element.code(), bytes);
    }

    /// Weights.
    pub(super) fn floats(&mut self, name: &str, dims: &[usize], values: &[f32]) {
        self.initializer(name, dims, FLOAT, values.iter().flat_map(|v| v.to_le_bytes()).collect());
    }

    /// Shapes and lengths.
    pub(super) fn whole(&mut self, name: &str, values: &[i64]) {
        self.initializer(name, &[values.len()], INT64, values.iter().flat_map(|v| v.to_le_bytes()).collect());
    }

    fn initializer(&mut self, name: &str, dims: &[usize], data_type: i32, raw_data: Vec<u8>) {
        let dims = dims.iter().map(|&n| n as i64).collect();
        self.0.initializer.push(TensorProto { name: name.to_owned(), dims, data_type, raw_data });
    }

    /// A node of one output without attributes.
    pub(super) fn node(&mut self, op: &str, inputs: &[&str], output: &str) {
        self.node_with(op, inputs, &[output.to_owned()], &[]);
    }

    /// Any node; its attributes are whole numbers.
    pub(super) fn node_with(&mut self, op: &str, inputs: &[&str], outputs: &[String], attributes: &[(&str, i64)]) {
        self.0.node.push(NodeProto {
            name: outputs[0].clone(),
            op_type: op.to_owned(),
            input: inputs.iter().map(|&input| input.to_owned()).collect(),
            output: outputs.to_vec(),
            attribute: attributes.iter().map(|&(name, value)| AttributeProto::int(name, value)).collect(),
        });
    }

    /// Gives a value another element type and name.
    pub(super) fn cast(&mut self, from: &str, to: &str, element: ElementType) -> String {
        self.node_with("Cast", &[from], &[to.to_owned()], &[("to", element.code().into())]);
        to.to_owned()
    }
}

fn value_info(tensor: &TensorSpec) -> ValueInfoProto {
    let (batch, width) = tensor.shape;
    let batch = DimensionProto { dim_param: Some(batch.to_owned()), dim_value: None };
    let width = DimensionProto { dim_value: Some(width as i64), dim_param: None };
    let shape = TensorShapeProto { dim: vec![batch, width] };
    let tensor_type = TensorTypeProto { elem_type: tensor.element.code(), shape: Some(shape) };
    ValueInfoProto {
        name: tensor.name.to_owned(),
        kind: Some(TypeProto { tensor_type: Some(tensor_type) }),
        doc_string: tensor.doc.clone(),
    }
}
