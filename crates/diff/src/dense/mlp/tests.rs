//! The width of the processor's vectors changes no bit: AVX-512, AVX2 and plain numbers, as far as this processor has them.

use pulp::Simd;

use super::{Activation, Backward, Forward, Mlp, Tangent};

/// Outputs, their tangents and the gradient over an odd number of rows, bit by bit.
fn run<S: Simd>(simd: S, mlp: &Mlp) -> Vec<u32> {
    const ROWS: usize = 13;
    let entry = |i: usize| (12.9898 * (i + 1) as f64).sin() as f32;
    let inputs = mlp.inputs();
    let input: Vec<f32> = (0..ROWS * inputs).map(entry).collect();
    let cotangent: Vec<f32> = (0..ROWS * mlp.outputs()).map(|i| entry(7 * i)).collect();
    let params: Vec<f32> = (0..mlp.param_count()).map(|i| 0.3 * entry(3 * i)).collect();
    let tape = &mut mlp.tape_with_inputs::<f32>(ROWS);
    mlp.bind(&params, tape);
    mlp.bind_tangent(&input.iter().cycle().copied().take(params.len()).collect::<Vec<_>>(), tape);
    tape.rows = ROWS;
    simd.vectorize(Forward { inputs, input: &input, tape });
    simd.vectorize(Tangent { inputs, input: &input, tape });
    simd.vectorize(Backward { inputs, input: &input, cotangent: &cotangent, weights: true, tape });
    let mut gradient = vec![0.0; params.len()];
    mlp.gradient(tape, &mut gradient);
    tape.output()
        .0
        .iter()
        .chain(tape.tangent().0)
        .chain(&gradient)
        .chain(tape.input_cotangent().0)
        .map(|x| x.to_bits())
        .collect()
}

#[test]
fn the_width_of_vectors_changes_no_bit() {
    // A narrow last layer and a wide one; widths that fill no vector.
    let nets = [&[3, 33, 20, 2][..], &[11, 50, 7]].map(|sizes| Mlp::new(sizes, Activation::Tanh, Activation::Tanh));
    for mlp in nets.iter().flat_map(|net| [net.clone(), net.clone().with_layer_norm(true)]) {
        let sizes = mlp.sizes();
        let plain = run(pulp::Scalar::new(), &mlp);
        assert!(plain.iter().any(|&bits| bits != 0));
        #[cfg(target_arch = "x86_64")]
        {
            let found = [
                pulp::x86::V3::try_new().map(|simd| run(simd, &mlp)),
                pulp::x86::V4::try_new().map(|simd| run(simd, &mlp)),
            ];
            for bits in found.into_iter().flatten() {
                assert!(bits == plain, "{sizes:?}");
            }
        }
    }
}

/// Of parameters and inputs, forward and back, against central differences; with a narrow last layer and a wide one. The way back to
/// the inputs alone leaves the parameters' sums as they are.
#[test]
fn cotangents_and_tangents_are_derivatives() {
    const ROWS: usize = 3;
    let nets = [&[3, 17, 2][..], &[5, 20, 9, 7], &[4, 6]];
    let nets = nets.map(|sizes| Mlp::new(sizes, Activation::Tanh, Activation::Identity));
    for mlp in nets.iter().flat_map(|net| [net.clone(), net.clone().with_layer_norm(true)]) {
        let entry = |i: usize| (12.9898 * (i + 1) as f64).sin();
        let params: Vec<f64> = (0..mlp.param_count()).map(|i| 0.3 * entry(3 * i)).collect();
        let input: Vec<f64> = (0..ROWS * mlp.inputs()).map(entry).collect();
        let cotangent: Vec<f64> = (0..ROWS * mlp.outputs()).map(|i| entry(7 * i)).collect();
        let tape = &mut mlp.tape_with_inputs::<f64>(ROWS);
        mlp.bind(&params, tape);
        let mut value = |params: &[f64], input: &[f64]| {
            mlp.bind(params, tape);
            mlp.forward(input, ROWS, tape);
            let (output, stride) = tape.output();
            let rows = output.chunks_exact(stride).zip(cotangent.chunks_exact(mlp.outputs()));
            rows.flat_map(|(y, c)| y.iter().zip(c)).map(|(y, c)| y * c).sum::<f64>()
        };
        let step = 1e-6;
        let moved =
            |x: &[f64], along: &[f64], by: f64| x.iter().zip(along).map(|(x, d)| x + by * d).collect::<Vec<_>>();
        let unit = |count: usize, i: usize| (0..count).map(|k| f64::from(u8::from(k == i))).collect::<Vec<_>>();
        let of_input: Vec<f64> = (0..input.len())
            .map(|i| {
                let mut at = |by| value(&params, &moved(&input, &unit(input.len(), i), by));
                (at(step) - at(-step)) / (2.0 * step)
            })
            .collect();
        let of_params: Vec<f64> = (0..params.len())
            .map(|i| {
                let mut at = |by| value(&moved(&params, &unit(params.len(), i), by), &input);
                (at(step) - at(-step)) / (2.0 * step)
            })
            .collect();
        let direction: Vec<f64> = (0..params.len()).map(|i| entry(5 * i)).collect();
        mlp.bind(&params, tape);
        mlp.bind_tangent(&direction, tape);
        mlp.forward(&input, ROWS, tape);
        mlp.jvp(&input, tape);
        let (tangent, stride) = tape.tangent();
        let rows = tangent.chunks_exact(stride).zip(cotangent.chunks_exact(mlp.outputs()));
        let forward: f64 = rows.flat_map(|(y, c)| y.iter().zip(c)).map(|(y, c)| y * c).sum();
        let expected: f64 = of_params.iter().zip(&direction).map(|(g, d)| g * d).sum();
        assert!((forward - expected).abs() < 1e-7, "{mlp:?}: {forward} and {expected}");
        mlp.vjp_inputs(&input, &cotangent, tape);
        let mut gradient = vec![0.0; params.len()];
        mlp.gradient(tape, &mut gradient);
        assert!(gradient.iter().all(|&g| g == 0.0));
        let (given, stride) = tape.input_cotangent();
        for (r, expected) in of_input.chunks_exact(mlp.inputs()).enumerate() {
            for (j, expected) in expected.iter().enumerate() {
                let given = given[r * stride + j];
                assert!((given - expected).abs() < 1e-8, "{mlp:?}, row {r}, input {j}: {given} and {expected}");
            }
        }
        mlp.vjp(&input, &cotangent, tape);
        mlp.gradient(tape, &mut gradient);
        for (i, (given, expected)) in gradient.iter().zip(&of_params).enumerate() {
            assert!((given - expected).abs() < 1e-8, "{mlp:?}, parameter {i}: {given} and {expected}");
        }
    }
}
