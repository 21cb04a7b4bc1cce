//! One generation of the searches, the scores for nothing, on one thread: `cargo bench -p hwasp-algos --bench searches`.
//! `benches/peers` has the same for Hansen's program.

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use hwasp_algos::{Ars, ArsConfig, Cmaes, CmaesConfig, Search};

/// The sphere, whose best is the origin.
fn generation(search: &mut dyn Search) {
    let scores: Vec<f64> = search.ask().iter().map(|x| -x.iter().map(|x| x * x).sum::<f64>()).collect();
    search.tell(&scores).expect("finite");
}

/// With a full covariance the decomposition is due every so many generations: a sample is a whole cycle of them, and the
/// time of one generation is given.
fn cmaes(c: &mut Criterion) {
    let mut group = c.benchmark_group("CMA-ES generation");
    group.sample_size(10);
    for (kind, n, separable) in [("full", 12, false), ("full", 1300, false), ("separable", 20_000, true)] {
        let config = CmaesConfig { separable, ..CmaesConfig::default() };
        let mut search = Cmaes::new(config, &vec![1.0; n], 1).expect("sound settings");
        group.bench_function(BenchmarkId::new(kind, n), |b| b.iter(|| generation(&mut search)));
    }
}

fn ars(c: &mut Criterion) {
    let mut group = c.benchmark_group("ARS update");
    for n in [1300, 20_000] {
        let mut search = Ars::new(ArsConfig::default(), vec![1.0; n], 1).expect("sound settings");
        group.bench_function(BenchmarkId::from_parameter(n), |b| b.iter(|| generation(&mut search)));
    }
}

criterion_group!(benches, cmaes, ars);
criterion_main!(benches);
