//! An interpreter of the ONNX operators that our models use, after the operators' specification and nothing else.

use std::collections::BTreeMap;

use super::super::proto::{DOUBLE, FLOAT, GraphProto, INT64, ModelProto, NodeProto, TensorProto};

/// An array, row by row. Single precision is rounded to after every operation.
#[derive(Clone, Debug)]
pub(super) struct Tensor {
    pub(super) kind: i32,
    pub(super) dims: Vec<usize>,
    pub(super) data: Vec<f64>,
}

impl Tensor {
    fn new(kind: i32, dims: Vec<usize>, data: Vec<f64>) -> Self {
        assert_eq!(dims.iter().product::<usize>(), data.len());
        let rounded = |x: f64| if kind == FLOAT { f64::from(x as f32) } else { x };
        Self { kind, dims, data: data.into_iter().map(rounded).collect() }
    }

    fn read(tensor: &TensorProto) -> Self {
        let raw = &tensor.raw_data;
        let data = match tensor.data_type {
            FLOAT => raw.as_chunks().0.iter().map(|&b| f64::from(f32::from_le_bytes(b))).collect(),
            DOUBLE => raw.as_chunks().0.iter().map(|&b| f64::from_le_bytes(b)).collect(),
            INT64 => raw.as_chunks().0.iter().map(|&b| i64::from_le_bytes(b) as f64).collect(),
            other => panic!("no type {other}"),
        };
        Self::new(tensor.data_type, tensor.dims.iter().map(|&n| n as usize).collect(), data)
    }

    /// Its value at a place of a larger shape: dimensions are matched from the last one, those of length 1 repeated.
    fn at(&self, place: &[usize]) -> f64 {
        let skipped = place.len() - self.dims.len();
        let index = self.dims.iter().zip(&place[skipped..]).fold(0, |index, (&length, &i)| {
            assert!(length == 1 || i < length);
            index * length + if length == 1 { 0 } else { i }
        });
        self.data[index]
    }
}

/// What comes out of a model; its inputs have to be what it declares.
pub(super) fn run(model: &ModelProto, inputs: &[(&str, Tensor)]) -> BTreeMap<String, Tensor> {
    let graph = model.graph.as_ref().unwrap();
    for (declared, (name, given)) in graph.input.iter().zip(inputs) {
        let kind = declared.kind.as_ref().unwrap().tensor_type.as_ref().unwrap();
        let width = kind.shape.as_ref().unwrap().dim[1].dim_value.unwrap();
        assert_eq!((&*declared.name, kind.elem_type, width as usize), (*name, given.kind, given.dims[1]));
    }
    assert_eq!(graph.input.len(), inputs.len());
    let mut values = values(graph, inputs);
    graph.output.iter().map(|output| (output.name.clone(), values.remove(&output.name).unwrap())).collect()
}

/// Every value of a graph. Nodes stand in an order in which they can be run, and write each name once.
pub(super) fn values(graph: &GraphProto, inputs: &[(&str, Tensor)]) -> BTreeMap<String, Tensor> {
    let mut values: BTreeMap<String, Tensor> = BTreeMap::new();
    let initializers = graph.initializer.iter().map(|tensor| (tensor.name.clone(), Tensor::read(tensor)));
    let given = inputs.iter().map(|(name, tensor)| ((*name).to_owned(), tensor.clone()));
    for (name, tensor) in initializers.chain(given) {
        assert!(values.insert(name.clone(), tensor).is_none(), "two values are called {name}");
    }
    for node in &graph.node {
        let read: Vec<&Tensor> =
            node.input.iter().map(|name| values.get(name).unwrap_or_else(|| panic!("{name}"))).collect();
        for (name, result) in node.output.iter().zip(apply(node, &read)) {
            assert!(values.insert(name.clone(), result).is_none(), "two values are called {name}");
        }
    }
    values
}

fn apply(node: &NodeProto, inputs: &[&Tensor]) -> Vec<Tensor> {
    let attribute = |name: &str| node.attribute.iter().find(|a| a.name == name).unwrap().i.unwrap();
    let first = inputs[0];
    let elementwise = |f: fn(f64) -> f64| vec![broadcast(&first.dims, first.kind, |at| f(first.at(at)))];
    let binary = |f: fn(f64, f64) -> f64| {
        let second = inputs[1];
        assert_eq!(first.kind, second.kind, "{}", node.name);
        vec![broadcast(&together(&first.dims, &second.dims), first.kind, |at| f(first.at(at), second.at(at)))]
    };
    match node.op_type.as_str() {
        "Identity" => elementwise(|x| x),
        "Neg" => elementwise(|x| -x),
        "Exp" => elementwise(f64::exp),
        "Log" => elementwise(f64::ln),
        "Sqrt" => elementwise(f64::sqrt),
        "Sin" => elementwise(f64::sin),
        "Cos" => elementwise(f64::cos),
        "Tanh" => elementwise(f64::tanh),
        "Abs" => elementwise(f64::abs),
        "Relu" => elementwise(|x| x.max(0.0)),
        "Sigmoid" => elementwise(|x| if x >= 0.0 { 1.0 / (1.0 + (-x).exp()) } else { x.exp() / (1.0 + x.exp()) }),
        "Add" => binary(|a, b| a + b),
        "Sub" => binary(|a, b| a - b),
        "Mul" => binary(|a, b| a * b),
        "Div" => binary(|a, b| a / b),
        "Atan" => elementwise(f64::atan),
        "Less" => binary(|a, b| if a < b { 1.0 } else { 0.0 }),
        "Equal" => binary(|a, b| if a == b { 1.0 } else { 0.0 }),
        "Where" => {
            let (yes, no) = (inputs[1], inputs[2]);
            let dims = together(&together(&first.dims, &yes.dims), &no.dims);
            vec![broadcast(&dims, yes.kind, |at| if first.at(at) == 0.0 { no.at(at) } else { yes.at(at) })]
        }
        "Min" => binary(f64::min),
        "Max" => binary(f64::max),
        "Cast" => vec![Tensor::new(attribute("to") as i32, first.dims.clone(), first.data.clone())],
        "Gemm" => vec![gemm(first, inputs[1], inputs[2])],
        "Split" => split(first, inputs[1], attribute("axis")),
        "Concat" => vec![concat(inputs, attribute("axis") as usize)],
        "Shape" => {
            let dims = &first.dims[attribute("start") as usize..attribute("end") as usize];
            vec![Tensor::new(INT64, vec![dims.len()], dims.iter().map(|&n| n as f64).collect())]
        }
        "Expand" => {
            let shape: Vec<usize> = inputs[1].data.iter().map(|&n| n as usize).collect();
            vec![broadcast(&together(&first.dims, &shape), first.kind, |at| first.at(at))]
        }
        other => panic!("no operator {other}"),
    }
}

/// The shape of two shapes together.
fn together(a: &[usize], b: &[usize]) -> Vec<usize> {
    let length = |dims: &[usize], from_last: usize| dims.iter().rev().nth(from_last).copied().unwrap_or(1);
    (0..a.len().max(b.len()))
        .rev()
        .map(|i| match (length(a, i), length(b, i)) {
            (1, n) | (n, 1) => n,
            (n, m) => {
                assert_eq!(n, m);
                n
            }
        })
        .collect()
}

fn broadcast(dims: &[usize], kind: i32, value: impl Fn(&[usize]) -> f64) -> Tensor {
    let place = |index: usize| {
        let mut at = vec![0; dims.len()];
        let mut rest = index;
        for (at, length) in at.iter_mut().zip(dims).rev() {
            (*at, rest) = (rest % length, rest / length);
        }
        at
    };
    Tensor::new(kind, dims.to_vec(), (0..dims.iter().product()).map(|i| value(&place(i))).collect())
}

fn gemm(a: &Tensor, b: &Tensor, c: &Tensor) -> Tensor {
    assert_eq!((a.kind, b.kind, c.kind, a.dims[1]), (FLOAT, FLOAT, FLOAT, b.dims[0]));
    let sum = |at: &[usize]| (0..a.dims[1]).map(|k| a.at(&[at[0], k]) * b.at(&[k, at[1]])).sum::<f64>() + c.at(at);
    broadcast(&[a.dims[0], b.dims[1]], FLOAT, sum)
}

fn split(from: &Tensor, lengths: &Tensor, axis: i64) -> Vec<Tensor> {
    assert_eq!((axis, lengths.kind), (1, INT64));
    assert_eq!(lengths.data.iter().sum::<f64>() as usize, from.dims[1]);
    let mut before = 0;
    let parts = lengths.data.iter().map(|&length| {
        let (first, length) = (before, length as usize);
        before += length;
        broadcast(&[from.dims[0], length], from.kind, |at| from.at(&[at[0], first + at[1]]))
    });
    parts.collect()
}

/// Along the first axis of lists, or the second of tables whose parts have one column.
fn concat(parts: &[&Tensor], axis: usize) -> Tensor {
    if axis == 0 {
        let data: Vec<f64> = parts.iter().flat_map(|part| part.data.clone()).collect();
        return Tensor::new(parts[0].kind, vec![data.len()], data);
    }
    assert!(parts.iter().all(|part| part.dims == [parts[0].dims[0], 1] && part.kind == parts[0].kind));
    broadcast(&[parts[0].dims[0], parts.len()], parts[0].kind, |at| parts[at[1]].at(&[at[0], 0]))
}
