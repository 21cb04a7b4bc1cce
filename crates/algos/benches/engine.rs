//! The pieces that training is made of, on one thread: `cargo bench -p hwasp-algos`.

use std::hint::black_box;
use std::sync::Arc;

use criterion::{BatchSize, Criterion, Throughput, criterion_group, criterion_main};
use hwasp_algos::{
    BaselineConfig, FisherRows, Learner, MlpBaseline, MlpBaselineConfig, Ppo, PpoConfig, PpoSettings, Trpo, TrpoConfig,
    TrpoSettings,
};
use hwasp_core::{
    Batch, EpisodeKind, Episodes, HardwarePolicy, MakeEnvironment, Noise, Placement, PolicySpec, Sampler, Serial,
};
use hwasp_diff::{Activation, Mlp};
use hwasp_tasks::mass_spring::{MassSpring, MassSpringSettings};

fn springs(hidden: Vec<usize>) -> (MassSpring, Arc<HardwarePolicy>) {
    let problem = MassSpring::stiffness(MassSpringSettings::default()).expect("the paper's settings are sound");
    let law = problem.law();
    let spec = PolicySpec {
        hidden,
        activation: Activation::Tanh,
        squash: true,
        observation_center: vec![0.1, 0.0],
        observation_scale: vec![0.1, 0.5],
        placements: vec![Placement::Graph; law.design().len()],
        law,
        noise: Noise { command: vec![0.3.into()], effort: 3.0.into(), design: 0.1.into(), train: true },
    };
    let policy = HardwarePolicy::new(spec, problem.make(None).spec()).expect("law and plant fit");
    (problem, Arc::new(policy))
}

fn batch(problem: &MassSpring, policy: &Arc<HardwarePolicy>, episodes: u64, horizon: usize) -> Batch {
    let sampler = Sampler::new(Arc::clone(policy), Arc::new(problem.clone()), Some(horizon));
    let kind = EpisodeKind::Training;
    let asked = Episodes { seed: 1, iteration: 0, indices: 0..episodes, progress: 0.0, kind };
    sampler.collect(&Serial, &policy.init(1, 1.0), &asked).expect("the plant is sound")
}

fn inference(c: &mut Criterion) {
    let mlp = Mlp::new(&[2, 32, 32, 1], Activation::Tanh, Activation::Tanh);
    let params = mlp.init(1.0, || 0.3);
    for rows in [1, 32, 256] {
        let (input, mut tape) = (vec![0.1; 2 * rows], mlp.tape::<f32>(rows));
        mlp.bind(&params, &mut tape);
        c.bench_function(&format!("inference 2-32-32-1, {rows} rows"), |b| {
            b.iter(|| mlp.forward(black_box(&input), rows, &mut tape));
        });
    }
}

fn dense(c: &mut Criterion) {
    let mlp = Mlp::new(&[11, 128, 128, 6], Activation::Tanh, Activation::Tanh);
    let params = mlp.init(1.0, || 0.3);
    let (rows, block) = (20_000, 64);
    let (input, cotangent) = (vec![0.1; 11 * rows], vec![0.2; 6 * block]);
    let mut tape = mlp.tape::<f32>(block);
    let mut gradient = vec![0.0; params.len()];
    let mut group = c.benchmark_group("20 000 rows of 11-128-128-6");
    group.throughput(Throughput::Elements(rows as u64)).sample_size(20);
    group.bench_function("gradient", |b| {
        b.iter(|| {
            mlp.bind(&params, &mut tape);
            for input in input.chunks(11 * block) {
                let rows = input.len() / 11;
                mlp.forward(input, rows, &mut tape);
                mlp.vjp(input, &cotangent[..6 * rows], &mut tape);
            }
            mlp.gradient(&tape, &mut gradient);
        });
    });
    group.bench_function("jvp and vjp", |b| {
        b.iter(|| {
            mlp.bind(&params, &mut tape);
            mlp.bind_tangent(&params, &mut tape);
            for input in input.chunks(11 * block) {
                let rows = input.len() / 11;
                mlp.forward(input, rows, &mut tape);
                mlp.jvp(input, &mut tape);
                mlp.vjp(input, &cotangent[..6 * rows], &mut tape);
            }
            mlp.gradient(&tape, &mut gradient);
        });
    });
}

/// One gradient step on 128 rows of a 2-32-32-1 controller with a ten-spring law: surrogate, gradient, Adam. A hundred
/// steps on one batch are timed, the advantages and the baseline's fit among them; read the time per element.
fn ppo_step(c: &mut Criterion) {
    let (problem, policy) = springs(vec![32, 32]);
    let batch = batch(&problem, &policy, 1, 128);
    let steps = 100;
    let settings = PpoSettings {
        ppo: PpoConfig { epochs: steps, minibatch_rows: 0, ..PpoConfig::default() },
        baseline: BaselineConfig::Linear { ridge: 1e-5, privileged: false },
    };
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
    let (problem, policy) = springs(vec![32, 32]);
    let full = batch(&problem, &policy, 20, 200);
    let settings =
        PpoSettings { ppo: PpoConfig::default(), baseline: BaselineConfig::Mlp(MlpBaselineConfig::default()) };
    let mut ppo = Ppo::new(&settings, Arc::clone(&policy), policy.init(1, 1.0), 1);
    let mut group = c.benchmark_group("iteration of 20 episodes of 200 steps");
    group.throughput(Throughput::Elements(full.rows() as u64)).sample_size(30);
    group.bench_function("rollout", |b| b.iter(|| batch(&problem, &policy, 20, 200)));
    group.bench_function("update", |b| b.iter(|| ppo.update(&Serial, &full, 0.0, 0).expect("finite")));
    let mut value = MlpBaseline::new(MlpBaselineConfig::default(), 2, 4, 1);
    let targets: Vec<f32> = full.obs.iter().step_by(2).copied().collect();
    group.bench_function("fit of the value network", |b| b.iter(|| value.fit(&full, &targets, 0.0, 0)));
}

/// One update on 20,000 rows of a 2-128-128-1 controller with a ten-spring law, a linear baseline's fit among it: by the
/// rows that the curvature is taken of, ten products each.
fn trpo_update(c: &mut Criterion) {
    let (problem, policy) = springs(vec![128, 128]);
    let full = batch(&problem, &policy, 100, 200);
    let mut group = c.benchmark_group("TRPO update of 20 000 rows");
    group.throughput(Throughput::Elements(full.rows() as u64)).sample_size(10);
    for rows in [2000, 20_000] {
        let trpo = TrpoConfig { fisher_rows: FisherRows::Count(rows), cg_tolerance: 0.0, ..TrpoConfig::default() };
        let settings = TrpoSettings { trpo, baseline: BaselineConfig::Linear { ridge: 1e-5, privileged: false } };
        group.bench_function(format!("curvature of {rows}"), |b| {
            b.iter_batched_ref(
                || Trpo::new(&settings, Arc::clone(&policy), policy.init(1, 1.0), 1),
                |trpo| trpo.update(&Serial, &full, 0.0, 0).expect("finite"),
                BatchSize::SmallInput,
            );
        });
    }
}

criterion_group!(benches, inference, dense, ppo_step, iteration, trpo_update);
criterion_main!(benches);
