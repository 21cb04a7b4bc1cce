//! Perceptrons of any depth and width: forward, vjp and jvp over blocks of rows.

mod simd;

use self::simd::{Backward, Forward, Tangent};
use super::aligned::Aligned;
use crate::Float;

/// What a layer does to its sums.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Activation {
    /// The hyperbolic tangent.
    Tanh,
    /// max(0, z); no derivative at zero.
    Relu,
    /// Nothing.
    Identity,
}

/// A last layer of at most this many outputs is computed by dot products: padded to a vector it would mostly idle.
const NARROW: usize = 4;

/// The shape of a perceptron: `sizes[0]` inputs, then one layer per further size.
///
/// Parameters lie in one vector, layer by layer: weights `[in × out]` row by row, then biases `[out]`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Mlp {
    sizes: Vec<usize>,
    hidden: Activation,
    output: Activation,
    layer_norm: bool,
}

#[derive(Clone, Copy)]
struct Layer {
    inputs: usize,
    outputs: usize,
    /// Where its parameters begin.
    at: usize,
    activation: Activation,
    narrow: bool,
    normal: bool,
}

impl Layer {
    fn bias_at(&self) -> usize {
        self.at + self.inputs * self.outputs
    }
}

/// The padded weights of one layer and what a block of rows left there.
#[derive(Debug)]
struct LayerTape<F> {
    /// Weights `[in × padded out]`; `[out × padded in]` in a narrow layer.
    weights: Aligned<F>,
    /// Their transpose, padded, for the way back; empty where it is not needed.
    transposed: Aligned<F>,
    bias: Aligned<F>,
    /// Sums of cotangents, shaped as the weights and the bias.
    weights_cotangent: Aligned<F>,
    bias_cotangent: Aligned<F>,
    /// Tangents of weights and bias, shaped as they are.
    weights_tangent: Aligned<F>,
    bias_tangent: Aligned<F>,
    /// Activations `[rows × stride]`.
    output: Aligned<F>,
    /// Their tangents.
    tangent: Aligned<F>,
    /// Sums that were normalised `[rows × stride]`, and what each row was multiplied by; empty where none are.
    normal: Aligned<F>,
    factors: Vec<F>,
    /// Padded outputs, the row stride of `output`; the true number in a narrow layer.
    stride: usize,
    layer: Shape,
}

#[derive(Clone, Copy, Debug)]
struct Shape {
    inputs: usize,
    outputs: usize,
    activation: Activation,
    narrow: bool,
}

/// Working memory of an [`Mlp`] for blocks of up to a fixed number of rows.
#[derive(Debug)]
pub struct MlpTape<F> {
    layers: Vec<LayerTape<F>>,
    /// Cotangents of a layer's outputs and of its inputs, in turn.
    cotangents: [Aligned<F>; 2],
    /// Cotangents of the inputs `[rows × padded inputs]`; empty where they are not asked for.
    input_cotangent: Aligned<F>,
    max_rows: usize,
    rows: usize,
}

/// How far the passes of a tape go.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Way {
    /// Forward alone.
    Forward,
    /// Back to all parameters.
    Back,
    /// Back to the inputs as well.
    Inputs,
}

fn padded<F: Float>(n: usize) -> usize {
    n.next_multiple_of(F::WIDTH)
}

impl Mlp {
    /// A perceptron of these sizes (inputs, hidden layers, outputs), at least two of them and none zero.
    ///
    /// # Panics
    /// If there are fewer than two sizes or one is zero; experiment files are checked before.
    pub fn new(sizes: &[usize], hidden: Activation, output: Activation) -> Self {
        assert!(sizes.len() >= 2 && sizes.iter().all(|&n| n > 0), "not the sizes of a perceptron: {sizes:?}");
        Self { sizes: sizes.to_vec(), hidden, output, layer_norm: false }
    }

    /// The same with the sums of each hidden layer brought to mean 0 and variance 1 in each row, before their activation: layer
    /// normalisation (Ba, Kiros and Hinton 2016, eq. 3) without gains and shifts of its own.
    #[must_use]
    pub fn with_layer_norm(self, layer_norm: bool) -> Self {
        Self { layer_norm, ..self }
    }

    /// Inputs, hidden layers, outputs.
    pub fn sizes(&self) -> &[usize] {
        &self.sizes
    }

    /// The number of inputs.
    pub fn inputs(&self) -> usize {
        self.sizes[0]
    }

    /// The number of outputs.
    pub fn outputs(&self) -> usize {
        self.sizes[self.sizes.len() - 1]
    }

    /// The length of the parameter vector.
    pub fn param_count(&self) -> usize {
        self.sizes.windows(2).map(|w| (w[0] + 1) * w[1]).sum()
    }

    /// Where the last layer's parameters lie in the parameter vector: weights, then biases.
    pub fn last_layer(&self) -> (std::ops::Range<usize>, std::ops::Range<usize>) {
        let layer = self.layers().last();
        layer.map_or((0..0, 0..0), |l| (l.at..l.bias_at(), l.bias_at()..l.bias_at() + l.outputs))
    }

    fn layers(&self) -> impl Iterator<Item = Layer> + '_ {
        let count = self.sizes.len() - 1;
        self.sizes.windows(2).enumerate().scan(0, move |next, (l, w)| {
            let at = *next;
            *next += (w[0] + 1) * w[1];
            let activation = if l + 1 == count { self.output } else { self.hidden };
            let narrow = l > 0 && l + 1 == count && w[1] <= NARROW;
            let normal = self.layer_norm && l + 1 < count;
            Some(Layer { inputs: w[0], outputs: w[1], at, activation, narrow, normal })
        })
    }

    /// Fresh parameters: weights uniform in ±sqrt(6/(in + out)) (Glorot and Bengio 2010, eq. 16), biases zero, the last
    /// layer's weights times `output_gain`. `uniform` draws from [0, 1).
    pub fn init(&self, output_gain: f64, mut uniform: impl FnMut() -> f64) -> Vec<f32> {
        let mut params = vec![0.0; self.param_count()];
        let last = self.sizes.len() - 2;
        for (l, layer) in self.layers().enumerate() {
            let gain = if l == last { output_gain } else { 1.0 };
            let limit = gain * (6.0 / (layer.inputs + layer.outputs) as f64).sqrt();
            for weight in &mut params[layer.at..layer.bias_at()] {
                *weight = ((uniform() * 2.0 - 1.0) * limit) as f32;
            }
        }
        params
    }

    /// Working memory for blocks of up to `max_rows` rows.
    pub fn tape<F: Float>(&self, max_rows: usize) -> MlpTape<F> {
        self.tape_for(max_rows, Way::Back)
    }

    /// The same for [`forward`](Self::forward) alone: binding parameters costs less.
    pub fn tape_forward<F: Float>(&self, max_rows: usize) -> MlpTape<F> {
        self.tape_for(max_rows, Way::Forward)
    }

    /// The same for whoever wants the [cotangents of the inputs](MlpTape::input_cotangent) as well.
    pub fn tape_with_inputs<F: Float>(&self, max_rows: usize) -> MlpTape<F> {
        self.tape_for(max_rows, Way::Inputs)
    }

    fn tape_for<F: Float>(&self, max_rows: usize, way: Way) -> MlpTape<F> {
        let mut widest = 0;
        let layers = self
            .layers()
            .map(|l| {
                let (long, short) =
                    if l.narrow { (l.outputs, padded::<F>(l.inputs)) } else { (l.inputs, padded::<F>(l.outputs)) };
                let stride = if l.narrow { l.outputs } else { short };
                widest = widest.max(stride).max(padded::<F>(l.inputs));
                let weights = Aligned::zeroed(long * short);
                let bias = Aligned::zeroed(stride);
                let back = match way {
                    Way::Forward => false,
                    Way::Back => l.at > 0,
                    Way::Inputs => true,
                };
                let transposed = if back && !l.narrow { l.outputs * padded::<F>(l.inputs) } else { 0 };
                let output = Aligned::zeroed(max_rows * stride);
                LayerTape {
                    transposed: Aligned::zeroed(transposed),
                    weights_cotangent: weights.clone(),
                    weights_tangent: weights.clone(),
                    weights,
                    bias_cotangent: bias.clone(),
                    bias_tangent: bias.clone(),
                    bias,
                    tangent: output.clone(),
                    normal: Aligned::zeroed(if l.normal { output.len() } else { 0 }),
                    factors: vec![F::ZERO; if l.normal { max_rows } else { 0 }],
                    output,
                    stride,
                    layer: Shape { inputs: l.inputs, outputs: l.outputs, activation: l.activation, narrow: l.narrow },
                }
            })
            .collect();
        let cotangent = Aligned::zeroed(max_rows * widest);
        let input_cotangent =
            Aligned::zeroed(if way == Way::Inputs { max_rows * padded::<F>(self.sizes[0]) } else { 0 });
        MlpTape { layers, cotangents: [cotangent.clone(), cotangent], input_cotangent, max_rows, rows: 0 }
    }

    /// Takes over a parameter vector and clears the sums of cotangents.
    pub fn bind<F: Float>(&self, params: &[F], tape: &mut MlpTape<F>) {
        for (l, t) in self.layers().zip(&mut tape.layers) {
            pack(&l, params, &mut t.weights, &mut t.bias);
            if !t.transposed.is_empty() {
                let given = &params[l.at..l.bias_at()];
                transpose(given, l.outputs, padded::<F>(l.inputs), &mut t.transposed);
            }
        }
        self.clear(tape);
    }

    /// Clears the sums of cotangents and keeps the parameters.
    pub fn clear<F: Float>(&self, tape: &mut MlpTape<F>) {
        for t in &mut tape.layers {
            t.weights_cotangent.fill(F::ZERO);
            t.bias_cotangent.fill(F::ZERO);
        }
    }

    /// Takes over a direction in parameter space for [`jvp`](Self::jvp).
    pub fn bind_tangent<F: Float>(&self, tangent: &[F], tape: &mut MlpTape<F>) {
        for (l, t) in self.layers().zip(&mut tape.layers) {
            pack(&l, tangent, &mut t.weights_tangent, &mut t.bias_tangent);
        }
    }

    /// Runs `input` `[rows × inputs]`, row by row, through the bound parameters. See [`MlpTape::output`].
    ///
    /// A row's bits do not depend on the rows beside it.
    ///
    /// # Panics
    /// If there are more rows than the tape was made for.
    #[inline]
    pub fn forward<F: Float>(&self, input: &[F], rows: usize, tape: &mut MlpTape<F>) {
        assert!(rows <= tape.max_rows, "{rows} rows on a tape for {}", tape.max_rows);
        tape.rows = rows;
        pulp::Arch::new().dispatch(Forward { inputs: self.sizes[0], input, tape });
    }

    /// Adds the gradient of Σ cotangent·output to the tape's sums, after [`forward`](Self::forward) of the same input.
    /// `cotangent` is `[rows × outputs]`, row by row.
    pub fn vjp<F: Float>(&self, input: &[F], cotangent: &[F], tape: &mut MlpTape<F>) {
        pulp::Arch::new().dispatch(Backward { inputs: self.sizes[0], input, cotangent, weights: true, tape });
    }

    /// The cotangents of the inputs alone, after [`forward`](Self::forward) of the same input, on a tape
    /// [that has them](Self::tape_with_inputs): the sums for the parameters stay as they are.
    pub fn vjp_inputs<F: Float>(&self, input: &[F], cotangent: &[F], tape: &mut MlpTape<F>) {
        pulp::Arch::new().dispatch(Backward { inputs: self.sizes[0], input, cotangent, weights: false, tape });
    }

    /// Adds the sums of cotangents to `gradient`, shaped as the parameters.
    pub fn gradient<F: Float>(&self, tape: &MlpTape<F>, gradient: &mut [F]) {
        for (l, t) in self.layers().zip(&tape.layers) {
            if l.narrow {
                let stride = padded::<F>(l.inputs);
                for i in 0..l.inputs {
                    for j in 0..l.outputs {
                        gradient[l.at + i * l.outputs + j] += t.weights_cotangent[j * stride + i];
                    }
                }
            } else {
                let rows = gradient[l.at..l.bias_at()].chunks_exact_mut(l.outputs);
                for (to, from) in rows.zip(t.weights_cotangent.chunks_exact(t.stride)) {
                    for (to, &from) in to.iter_mut().zip(from) {
                        *to += from;
                    }
                }
            }
            for j in 0..l.outputs {
                gradient[l.bias_at() + j] += t.bias_cotangent[j];
            }
        }
    }

    /// The outputs' tangents along the bound direction, after [`forward`](Self::forward) of the same input.
    /// See [`MlpTape::tangent`].
    pub fn jvp<F: Float>(&self, input: &[F], tape: &mut MlpTape<F>) {
        pulp::Arch::new().dispatch(Tangent { inputs: self.sizes[0], input, tape });
    }
}

/// Lays the parameters of a layer out on padded rows.
fn pack<F: Float>(l: &Layer, params: &[F], weights: &mut [F], bias: &mut [F]) {
    let (given, biases) = params[l.at..][..(l.inputs + 1) * l.outputs].split_at(l.inputs * l.outputs);
    if l.narrow {
        transpose(given, l.outputs, padded::<F>(l.inputs), weights);
    } else {
        for (to, from) in weights.chunks_exact_mut(bias.len()).zip(given.chunks_exact(l.outputs)) {
            to[..l.outputs].copy_from_slice(from);
        }
    }
    bias[..l.outputs].copy_from_slice(biases);
}

/// Writes `from` `[_ × columns]` as its transpose with rows of `stride`.
fn transpose<F: Float>(from: &[F], columns: usize, stride: usize, to: &mut [F]) {
    // So few rows at once that the lines they lie in stay in the cache from one column to the next.
    const ROWS: usize = 16;
    for (block, rows) in from.chunks(ROWS * columns).enumerate() {
        for (j, to) in to.chunks_exact_mut(stride).enumerate() {
            for (to, from) in to[block * ROWS..].iter_mut().zip(rows.chunks_exact(columns)) {
                *to = from[j];
            }
        }
    }
}

impl<F: Float> MlpTape<F> {
    /// The outputs of the last forward and the stride between rows: output `j` of row `r` is at `r·stride + j`.
    pub fn output(&self) -> (&[F], usize) {
        self.layers.last().map_or((&[], 0), |l| (&l.output[..self.rows * l.stride], l.stride))
    }

    /// The cotangents of the inputs of the last vjp and the stride between rows, laid out as [`output`](Self::output). Only on a tape
    /// that was [made for them](Mlp::tape_with_inputs).
    pub fn input_cotangent(&self) -> (&[F], usize) {
        let stride = self.input_cotangent.len() / self.max_rows.max(1);
        (&self.input_cotangent[..self.rows * stride], stride)
    }

    /// The outputs' tangents of the last jvp, laid out as [`output`](Self::output).
    pub fn tangent(&self) -> (&[F], usize) {
        self.layers.last().map_or((&[], 0), |l| (&l.tangent[..self.rows * l.stride], l.stride))
    }

    /// Adds the sums of cotangents of another tape, which worked on other rows.
    pub fn add_cotangents(&mut self, other: &Self) {
        for (mine, theirs) in self.layers.iter_mut().zip(&other.layers) {
            for (m, &t) in mine.weights_cotangent.iter_mut().zip(theirs.weights_cotangent.iter()) {
                *m += t;
            }
            for (m, &t) in mine.bias_cotangent.iter_mut().zip(theirs.bias_cotangent.iter()) {
                *m += t;
            }
        }
    }
}

#[cfg(test)]
mod tests;
