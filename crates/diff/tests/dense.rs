//! Dense layers against finite differences, against themselves in other shapes, and by the dot-product identity.

use hwasp_diff::{Activation, Mlp};
use proptest::prelude::*;

/// A cheap generator of test numbers in [-1, 1).
fn noise(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1;
    move || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
}

struct Case {
    mlp: Mlp,
    params: Vec<f64>,
    input: Vec<f64>,
    cotangent: Vec<f64>,
    tangent: Vec<f64>,
    rows: usize,
}

fn case(sizes: &[usize], hidden: Activation, output: Activation, rows: usize, seed: u64) -> Case {
    let mlp = Mlp::new(sizes, hidden, output);
    let mut draw = noise(seed);
    let mut take = |n: usize| -> Vec<f64> { (0..n).map(|_| draw()).collect() };
    Case {
        params: take(mlp.param_count()),
        input: take(rows * mlp.inputs()),
        cotangent: take(rows * mlp.outputs()),
        tangent: take(mlp.param_count()),
        rows,
        mlp,
    }
}

fn outputs(c: &Case, params: &[f64]) -> Vec<f64> {
    let mut tape = c.mlp.tape(c.rows);
    c.mlp.bind(params, &mut tape);
    c.mlp.forward(&c.input, c.rows, &mut tape);
    let (out, stride) = tape.output();
    out.chunks_exact(stride).flat_map(|row| row[..c.mlp.outputs()].to_vec()).collect()
}

fn inner(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn gradient(c: &Case) -> Vec<f64> {
    let mut tape = c.mlp.tape(c.rows);
    c.mlp.bind(&c.params, &mut tape);
    c.mlp.forward(&c.input, c.rows, &mut tape);
    c.mlp.vjp(&c.input, &c.cotangent, &mut tape);
    let mut gradient = vec![0.0; c.mlp.param_count()];
    c.mlp.gradient(&tape, &mut gradient);
    gradient
}

fn check(c: &Case) {
    let gradient = gradient(c);
    let h = 1e-6;
    for i in 0..c.params.len() {
        let at = |step: f64| {
            let mut params = c.params.clone();
            params[i] += step;
            inner(&outputs(c, &params), &c.cotangent)
        };
        let numeric = (at(h) - at(-h)) / (2.0 * h);
        let scale = numeric.abs().max(1e-2);
        assert!(
            (gradient[i] - numeric).abs() / scale < 1e-6,
            "parameter {i} of {:?}: {} against {numeric}",
            c.mlp.sizes(),
            gradient[i]
        );
    }
    let mut tape = c.mlp.tape(c.rows);
    c.mlp.bind(&c.params, &mut tape);
    c.mlp.bind_tangent(&c.tangent, &mut tape);
    c.mlp.forward(&c.input, c.rows, &mut tape);
    c.mlp.jvp(&c.input, &mut tape);
    let (moved, stride) = tape.tangent();
    let moved: Vec<f64> = moved.chunks_exact(stride).flat_map(|row| row[..c.mlp.outputs()].to_vec()).collect();
    let (left, right) = (inner(&moved, &c.cotangent), inner(&gradient, &c.tangent));
    assert!((left - right).abs() < 1e-10 * left.abs().max(1.0), "{left} against {right}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]
    #[test]
    fn tanh_layers_differentiate(
        inputs in 1usize..6, hidden in prop::collection::vec(1usize..20, 0..3), outputs in 1usize..7,
        rows in 1usize..19, seed in any::<u64>(), squash in any::<bool>(),
    ) {
        let mut sizes = vec![inputs];
        sizes.extend(hidden);
        sizes.push(outputs);
        let output = if squash { Activation::Tanh } else { Activation::Identity };
        check(&case(&sizes, Activation::Tanh, output, rows, seed));
    }
}

/// Hidden layers narrower than a vector were once taken for narrow last layers, and their gradient was zero.
#[test]
fn narrow_hidden_layers_differentiate() {
    check(&case(&[1, 1, 1, 1], Activation::Tanh, Activation::Identity, 3, 5));
    check(&case(&[2, 3, 20, 2], Activation::Tanh, Activation::Tanh, 5, 6));
}

#[test]
fn relu_layers_differentiate() {
    // Fixed seeds: a sum within a finite difference of the kink would fail by its own fault.
    for seed in [3, 4] {
        check(&case(&[3, 17, 9, 2], Activation::Relu, Activation::Identity, 5, seed));
    }
}

#[test]
fn a_row_does_not_depend_on_its_company() {
    for sizes in [&[2, 32, 32, 1][..], &[11, 128, 128, 6], &[3, 7, 5, 4]] {
        let mlp = Mlp::new(sizes, Activation::Tanh, Activation::Tanh);
        let mut draw = noise(7);
        let params: Vec<f32> = (0..mlp.param_count()).map(|_| draw() as f32).collect();
        let input: Vec<f32> = (0..67 * sizes[0]).map(|_| draw() as f32).collect();
        let run = |rows: usize| -> Vec<Vec<u32>> {
            let mut tape = mlp.tape(rows);
            mlp.bind(&params, &mut tape);
            let mut all = Vec::new();
            for block in input.chunks(rows * sizes[0]) {
                mlp.forward(block, block.len() / sizes[0], &mut tape);
                let (out, stride) = tape.output();
                all.extend(
                    out.chunks_exact(stride)
                        .map(|row| row[..mlp.outputs()].iter().map(|x| x.to_bits()).collect::<Vec<_>>()),
                );
            }
            all
        };
        let single = run(1);
        for rows in [2, 8, 13, 67] {
            assert_eq!(single, run(rows), "{sizes:?} in blocks of {rows}");
        }
    }
}

#[test]
fn single_and_double_precision_agree() {
    let c = case(&[2, 32, 32, 1], Activation::Tanh, Activation::Tanh, 40, 11);
    let exact = gradient(&c);
    let params: Vec<f32> = c.params.iter().map(|&x| x as f32).collect();
    let input: Vec<f32> = c.input.iter().map(|&x| x as f32).collect();
    let cotangent: Vec<f32> = c.cotangent.iter().map(|&x| x as f32).collect();
    let mut tape = c.mlp.tape(40);
    c.mlp.bind(&params, &mut tape);
    c.mlp.forward(&input, 40, &mut tape);
    c.mlp.vjp(&input, &cotangent, &mut tape);
    let mut single = vec![0.0; params.len()];
    c.mlp.gradient(&tape, &mut single);
    let size = inner(&exact, &exact).sqrt();
    for (s, e) in single.iter().zip(&exact) {
        assert!((f64::from(*s) - e).abs() < 1e-5 * size, "{s} against {e}");
    }
}
