//! Updates of the gradient learners, on one thread: `cargo bench -p hwasp-algos --bench updates`.

mod common;

use std::sync::Arc;

use criterion::{BatchSize, Criterion, Throughput, criterion_group, criterion_main};
use hwasp_algos::{
    BaselineConfig, FisherRows, InputDims, Learner, MlpBaseline, MlpBaselineConfig, Ppo, PpoConfig, PpoSettings, Trpo,
    TrpoConfig, TrpoSettings, advantages,
};
use hwasp_core::Serial;

use common::{batch, hand, hand_batch, springs};

const LINEAR: BaselineConfig = BaselineConfig::Linear { ridge: 1e-5, privileged: false, context: false };

fn gae(c: &mut Criterion) {
    let (problem, policy) = springs(&[32, 32]);
    let full = batch(&problem, &policy, 20, 200);
    let (values, last) = (vec![0.0; full.rows()], vec![0.0; full.episodes.len()]);
    let mut group = c.benchmark_group("advantages");
    group.throughput(Throughput::Elements(full.rows() as u64));
    group.bench_function("20 episodes of 200 steps", |b| {
        b.iter(|| advantages(&full, &values, &last, (0.99, 0.95), true));
    });
}

/// One gradient step on 128 rows of a 2-32-32-1 controller with a ten-spring law: surrogate, gradient, Adam. A hundred
/// steps on one batch are timed, the advantages and the baseline's fit among them; read the time per element.
fn ppo_step(c: &mut Criterion) {
    let (problem, policy) = springs(&[32, 32]);
    let batch = batch(&problem, &policy, 1, 128);
    let steps = 100;
    let settings =
        PpoSettings { ppo: PpoConfig { epochs: steps, minibatch_rows: 0, ..PpoConfig::default() }, baseline: LINEAR };
    let mut group = c.benchmark_group("PPO");
    group.throughput(Throughput::Elements(steps as u64));
    group.bench_function("100 steps of 128 rows", |b| {
        b.iter_batched_ref(
            || Ppo::new(&settings, Arc::clone(&policy), policy.init(1, 1.0), 1),
            |ppo| ppo.update(&Serial, &batch, 0.0, 0).expect("finite"),
            BatchSize::SmallInput,
        );
    });
}

fn iteration(c: &mut Criterion) {
    let (problem, policy) = springs(&[32, 32]);
    let full = batch(&problem, &policy, 20, 200);
    let settings =
        PpoSettings { ppo: PpoConfig::default(), baseline: BaselineConfig::Mlp(MlpBaselineConfig::default()) };
    let mut ppo = Ppo::new(&settings, Arc::clone(&policy), policy.init(1, 1.0), 1);
    let mut group = c.benchmark_group("iteration of 20 episodes of 200 steps");
    group.throughput(Throughput::Elements(full.rows() as u64)).sample_size(30);
    group.bench_function("rollout", |b| b.iter(|| batch(&problem, &policy, 20, 200)));
    group.bench_function("update", |b| b.iter(|| ppo.update(&Serial, &full, 0.0, 0).expect("finite")));
    let mut value = MlpBaseline::new(MlpBaselineConfig::default(), InputDims { obs: 2, state: 4, context: 0 }, 1);
    let targets: Vec<f32> = full.obs.iter().step_by(2).copied().collect();
    group.bench_function("fit of the value network", |b| b.iter(|| value.fit(&full, &targets, 0.0, 0)));
}

/// An update on 20,000 rows of an 11-128-128 controller with the tendon law, a linear baseline's fit among it: by products
/// with the Fisher matrix and by steps that the line search tries, all of which fail. What one of them takes is a
/// difference; what is left without any is the gradient, the baseline and the gathering.
fn trpo_update(c: &mut Criterion) {
    let policy = hand(&[128, 128]);
    let params = policy.init(1, 1.0);
    let full = hand_batch(&policy, &params, 20_000);
    let mut group = c.benchmark_group("TRPO update of 20 000 rows");
    group.throughput(Throughput::Elements(full.rows() as u64)).sample_size(10);
    let all = TrpoConfig { cg_tolerance: 0.0, ..TrpoConfig::default() };
    let cases = [
        ("gradient alone", TrpoConfig { cg_iterations: 0, backtracks: 0, ..all.clone() }),
        ("and 10 products", TrpoConfig { backtracks: 0, ..all.clone() }),
        (
            "and 10 steps of the line search",
            TrpoConfig { cg_iterations: 0, backtracks: 10, max_kl: 0.0, ..all.clone() },
        ),
        ("whole", all.clone()),
        ("whole, curvature of 2000 rows", TrpoConfig { fisher_rows: FisherRows::Count(2000), ..all }),
    ];
    for (name, trpo) in cases {
        let settings = TrpoSettings { trpo, baseline: LINEAR };
        group.bench_function(name, |b| {
            b.iter_batched_ref(
                || Trpo::new(&settings, Arc::clone(&policy), params.clone(), 1),
                |trpo| trpo.update(&Serial, &full, 0.0, 0).expect("finite"),
                BatchSize::SmallInput,
            );
        });
    }
}

criterion_group!(benches, gae, ppo_step, iteration, trpo_update);
criterion_main!(benches);
