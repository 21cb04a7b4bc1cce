//! Perceptrons of two hidden layers, by width and rows, on one thread: `cargo bench -p hwasp-diff`.

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use hwasp_diff::{Activation, Mlp};

/// Rows of a block, as the learners have it.
const BLOCK: usize = 64;
const INPUTS: usize = 11;
const OUTPUTS: usize = 2;

/// What a pass does with each block after the forward pass.
type Pass = fn(&Mlp, &[f32], &[f32], &mut hwasp_diff::MlpTape<f32>);

fn passes(c: &mut Criterion) {
    let kinds: [(&str, Pass); 3] = [
        ("forward", |_, _, _, _| ()),
        ("forward and vjp", |mlp, input, cotangent, tape| mlp.vjp(input, cotangent, tape)),
        ("forward and jvp", |mlp, input, _, tape| mlp.jvp(input, tape)),
    ];
    for width in [32, 128] {
        let mlp = Mlp::new(&[INPUTS, width, width, OUTPUTS], Activation::Tanh, Activation::Tanh);
        let mut seed = 0.1;
        let params = mlp.init(1.0, || {
            seed = (seed * 997.0_f64 + 0.123).fract();
            seed
        });
        for (name, pass) in kinds {
            let mut group = c.benchmark_group(format!("{width} wide, {name}"));
            for rows in [1, 64, 1000, 50_000] {
                let block = rows.min(BLOCK);
                let (input, cotangent) = (vec![0.3; INPUTS * rows], vec![0.2; OUTPUTS * block]);
                let mut tape = mlp.tape::<f32>(block);
                mlp.bind(&params, &mut tape);
                mlp.bind_tangent(&params, &mut tape);
                group.throughput(Throughput::Elements(rows as u64));
                group.sample_size(if rows > 1000 { 20 } else { 50 });
                group.bench_with_input(BenchmarkId::from_parameter(rows), &rows, |b, _| {
                    b.iter(|| {
                        for input in black_box(&input).chunks(INPUTS * block) {
                            let rows = input.len() / INPUTS;
                            mlp.forward(input, rows, &mut tape);
                            pass(&mlp, input, &cotangent[..OUTPUTS * rows], &mut tape);
                        }
                    });
                });
            }
        }
    }
}

criterion_group!(benches, passes);
criterion_main!(benches);
