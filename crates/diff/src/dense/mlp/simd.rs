//! The three ways through a perceptron, compiled for each vector width.

use pulp::{Simd, WithSimd};

use super::MlpTape;
use crate::Float;
use crate::dense::kernels::{Onto, product, product_transposed};
use crate::dense::passes::{activate, add_rows, differentiate, differentiate_normal, dot, normalize, sum_column};

/// One block of rows through all layers.
pub(super) struct Forward<'a, F> {
    pub(super) inputs: usize,
    pub(super) input: &'a [F],
    pub(super) tape: &'a mut MlpTape<F>,
}

impl<F: Float> WithSimd for Forward<'_, F> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let rows = self.tape.rows;
        let (mut x, mut stride) = (self.input, self.inputs);
        for t in &mut self.tape.layers {
            let shape = t.layer;
            let output = &mut t.output[..rows * t.stride];
            if shape.narrow {
                let padded = t.weights.len() / shape.outputs;
                for (x, y) in x.chunks_exact(stride).zip(output.chunks_exact_mut(shape.outputs)) {
                    for j in 0..shape.outputs {
                        y[j] = t.bias[j] + dot(x, &t.weights[j * padded..][..padded]);
                    }
                }
            } else {
                let size = (rows, shape.inputs, t.stride);
                product::<F, S>(simd, size, x, stride, &t.weights, Onto::Row(&t.bias), output);
            }
            normalize(output, (t.stride, shape.outputs), &mut t.normal, &mut t.factors);
            activate(shape.activation, output);
            (x, stride) = (&t.output[..rows * t.stride], t.stride);
        }
    }
}

/// The cotangents of a block, from the last layer to the first.
pub(super) struct Backward<'a, F> {
    pub(super) inputs: usize,
    pub(super) input: &'a [F],
    pub(super) cotangent: &'a [F],
    /// Whether the sums for weights and biases are wanted.
    pub(super) weights: bool,
    pub(super) tape: &'a mut MlpTape<F>,
}

impl<F: Float> WithSimd for Backward<'_, F> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let MlpTape { layers, cotangents: [current, next], input_cotangent, rows, .. } = self.tape;
        let (mut current, mut next, rows) = (&mut current[..], &mut next[..], *rows);
        if let Some(last) = layers.last() {
            let outputs = last.layer.outputs;
            if last.stride == outputs {
                current[..rows * outputs].copy_from_slice(&self.cotangent[..rows * outputs]);
            } else {
                current[..rows * last.stride].fill(F::ZERO);
                for (to, from) in current.chunks_exact_mut(last.stride).zip(self.cotangent.chunks_exact(outputs)) {
                    to[..outputs].copy_from_slice(from);
                }
            }
        }
        for l in (0..layers.len()).rev() {
            let (before, rest) = layers.split_at_mut(l);
            let t = &mut rest[0];
            let shape = t.layer;
            let (x, x_stride) = match before.last() {
                Some(below) => (&below.output[..rows * below.stride], below.stride),
                None => (self.input, self.inputs),
            };
            let d = &mut current[..rows * t.stride];
            differentiate(shape.activation, &t.output[..rows * t.stride], d);
            differentiate_normal(d, (t.stride, shape.outputs), &t.normal, &t.factors);
            let sums = &mut t.weights_cotangent;
            if shape.narrow {
                if self.weights {
                    for j in 0..shape.outputs {
                        t.bias_cotangent[j] += sum_column(d, shape.outputs, j);
                    }
                    product_transposed::<F, S>(simd, (rows, shape.outputs, x_stride), d, t.stride, x, sums);
                }
                let size = (rows, shape.outputs, x_stride);
                product::<F, S>(simd, size, d, t.stride, &t.weights, Onto::Zero, &mut next[..rows * x_stride]);
            } else {
                if self.weights {
                    add_rows(d, &mut t.bias_cotangent);
                    product_transposed::<F, S>(simd, (rows, shape.inputs, t.stride), x, x_stride, d, sums);
                }
                // Of the first layer it is empty, unless cotangents of the inputs are wanted.
                if !t.transposed.is_empty() {
                    let padded = t.transposed.len() / shape.outputs;
                    let below = if l > 0 { &mut next[..rows * padded] } else { &mut input_cotangent[..rows * padded] };
                    let size = (rows, shape.outputs, padded);
                    product::<F, S>(simd, size, d, t.stride, &t.transposed, Onto::Zero, below);
                }
            }
            std::mem::swap(&mut current, &mut next);
        }
    }
}

/// The tangents of a block, from the first layer to the last.
pub(super) struct Tangent<'a, F> {
    pub(super) inputs: usize,
    pub(super) input: &'a [F],
    pub(super) tape: &'a mut MlpTape<F>,
}

impl<F: Float> WithSimd for Tangent<'_, F> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let rows = self.tape.rows;
        let layers = &mut self.tape.layers;
        for l in 0..layers.len() {
            let (before, rest) = layers.split_at_mut(l);
            let t = &mut rest[0];
            let shape = t.layer;
            let (x, stride, moving) = match before.last() {
                Some(below) => {
                    (&below.output[..rows * below.stride], below.stride, Some(&below.tangent[..rows * below.stride]))
                }
                None => (self.input, self.inputs, None),
            };
            let d = &mut t.tangent[..rows * t.stride];
            if shape.narrow {
                let padded = t.weights.len() / shape.outputs;
                let moving = moving.unwrap_or(x); // a narrow layer is never the first
                let rows = x.chunks_exact(stride).zip(moving.chunks_exact(stride));
                for ((x, dx), d) in rows.zip(d.chunks_exact_mut(shape.outputs)) {
                    for j in 0..shape.outputs {
                        let weights = j * padded..(j + 1) * padded;
                        d[j] = t.bias_tangent[j]
                            + dot(x, &t.weights_tangent[weights.clone()])
                            + dot(dx, &t.weights[weights]);
                    }
                }
            } else {
                let size = (rows, shape.inputs, t.stride);
                product::<F, S>(simd, size, x, stride, &t.weights_tangent, Onto::Row(&t.bias_tangent), d);
                if let Some(dx) = moving {
                    product::<F, S>(simd, size, dx, stride, &t.weights, Onto::Result, d);
                }
            }
            differentiate_normal(d, (t.stride, shape.outputs), &t.normal, &t.factors);
            differentiate(shape.activation, &t.output[..rows * t.stride], d);
        }
    }
}
