//! A traced law as ONNX nodes: one elementwise node per instruction.

use hwasp_diff::{Binary, Interpreter, Program, Unary};

use super::graph::Graph;
use crate::model::ElementType;

/// A value of the graph.
#[derive(Clone, Debug)]
pub(super) struct Value {
    pub(super) name: String,
    /// Whether it is a column, one value per row of the batch, or a scalar.
    pub(super) by_row: bool,
}

/// Writes the nodes of `program` and returns its outputs. Its arithmetic is in double precision.
pub(super) fn law(graph: &mut Graph, program: &Program, uniforms: &[Value], columns: &[Value]) -> Vec<Value> {
    program.interpret(uniforms, columns, &mut Writer { graph, constants: 0, steps: 0 })
}

struct Writer<'g> {
    graph: &'g mut Graph,
    constants: usize,
    steps: usize,
}

impl Writer<'_> {
    fn step(&mut self, op: &str, inputs: &[&Value]) -> Value {
        let name = format!("law.{}", self.steps);
        self.steps += 1;
        let names: Vec<&str> = inputs.iter().map(|input| input.name.as_str()).collect();
        self.graph.node(op, &names, &name);
        Value { name, by_row: inputs.iter().any(|input| input.by_row) }
    }

    /// What is true or false in ONNX is 1 or 0 in a program.
    fn cast_of(&mut self, op: &str, inputs: &[&Value]) -> Value {
        let truth = self.step(op, inputs);
        let name = self.graph.cast(&truth.name, &format!("{}.number", truth.name), ElementType::Float64);
        Value { name, ..truth }
    }

    /// `value` where `condition` is not 0, else 0.
    fn gate(&mut self, condition: &Value, value: &Value) -> Value {
        let zero = self.constant(0.0);
        let closed = self.step("Equal", &[condition, &zero]);
        self.step("Where", &[&closed, &zero, value])
    }
}

impl Interpreter for Writer<'_> {
    type Value = Value;

    fn constant(&mut self, value: f64) -> Value {
        let name = format!("law.constant.{}", self.constants);
        self.constants += 1;
        self.graph.numbers(&name, &[], &[value], ElementType::Float64);
        Value { name, by_row: false }
    }

    fn unary(&mut self, op: Unary, a: &Value) -> Value {
        let op = match op {
            Unary::Neg => "Neg",
            Unary::Exp => "Exp",
            Unary::Ln => "Log",
            Unary::Sqrt => "Sqrt",
            Unary::Sin => "Sin",
            Unary::Cos => "Cos",
            Unary::Tanh => "Tanh",
            Unary::Abs => "Abs",
            Unary::Sigmoid => "Sigmoid",
            Unary::Atan => "Atan",
        };
        self.step(op, &[a])
    }

    fn binary(&mut self, op: Binary, a: &Value, b: &Value) -> Value {
        let op = match op {
            Binary::Add => "Add",
            Binary::Sub => "Sub",
            Binary::Mul => "Mul",
            Binary::Div => "Div",
            Binary::Min => "Min",
            Binary::Max => "Max",
            Binary::Less => return self.cast_of("Less", &[a, b]),
            Binary::Gate => return self.gate(a, b),
        };
        self.step(op, &[a, b])
    }
}
