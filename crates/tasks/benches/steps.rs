//! One environment step and one action, as a rollout takes them, on one thread: `cargo bench -p hwasp-tasks`.

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use hwasp_core::{
    Actor, Environment, HardwarePolicy, Law, MakeEnvironment, Noise, Placement, PolicySpec, Purpose, stream,
};
use hwasp_diff::Activation;
use hwasp_tasks::mass_spring::{Interface, MassSpring, MassSpringSettings};
use hwasp_tasks::pendulum::{Pendulum, PendulumSettings};

const NAMED: (u64, Purpose) = (1, Purpose::TrainingReset);

/// Steps that are timed at once: an episode's.
const STEPS: usize = 200;

fn step(c: &mut Criterion) {
    let springs = MassSpring::stiffness(MassSpringSettings::default()).expect("sound settings");
    let bar = MassSpring::bar(MassSpringSettings::default(), Interface::Soft).expect("sound settings");
    let pendulum = Pendulum::new(&PendulumSettings::default()).expect("sound settings");
    let worlds: [(&str, Box<dyn Environment>); 3] =
        [("mass-spring", springs.make(None)), ("bar-length", bar.make(None)), ("pendulum", pendulum.make(None))];
    let mut group = c.benchmark_group("environment step");
    group.throughput(Throughput::Elements(STEPS as u64));
    for (name, mut environment) in worlds {
        let spec = environment.spec().clone();
        let (effort, command) = (vec![0.1; spec.effort.len()], vec![0.1; spec.command.len()]);
        let (mut seen, mut state) = (vec![0.0; spec.observation.len()], vec![0.0; spec.state.len()]);
        environment.reset(&mut stream(NAMED.0, NAMED.1, 0, 0));
        group.bench_function(name, |b| {
            b.iter(|| {
                for _ in 0..STEPS {
                    black_box(environment.step(black_box(&effort), &command));
                    environment.observe(&mut seen);
                    environment.state(&mut state);
                }
            });
        });
    }
}

fn policy(law: Law, place: Placement, environment: &dyn Environment) -> HardwarePolicy {
    let spec = PolicySpec {
        hidden: vec![32, 32],
        activation: Activation::Tanh,
        squash: true,
        state_dependent_std: false,
        observation_center: vec![0.1, 0.0],
        observation_scale: vec![0.1, 0.5],
        sees_design: false,
        normalize: None,
        placements: vec![place; law.design().len()],
        law,
        noise: Noise { command: vec![0.3.into()], effort: vec![3.0.into()], design: 0.1.into(), train: true },
    };
    HardwarePolicy::new(spec, environment.spec()).expect("law and plant fit")
}

fn act(c: &mut Criterion) {
    let springs = MassSpring::stiffness(MassSpringSettings::default()).expect("sound settings");
    let environment = springs.make(None);
    for (name, place) in [("graph", Placement::Graph), ("action", Placement::Action)] {
        let policy = policy(springs.law(), place, &*environment);
        let params = policy.init(1, 1.0);
        let mut group = c.benchmark_group(format!("action of 2-32-32-1, ten springs in the {name}"));
        for rows in [1, 32, 256] {
            let mut actor = Actor::new(&policy, &params, 0.0, rows);
            let (obs, state) = (vec![0.1; 2 * rows], vec![0.1; 4 * rows]);
            let mut noise: Vec<_> = (0..rows as u64).map(|i| stream(NAMED.0, NAMED.1, 0, i)).collect();
            group.throughput(Throughput::Elements(rows as u64));
            group.bench_with_input(BenchmarkId::new("deterministic", rows), &rows, |b, _| {
                b.iter(|| actor.act(black_box(&obs), &state, rows, None));
            });
            group.bench_with_input(BenchmarkId::new("sampled", rows), &rows, |b, _| {
                b.iter(|| actor.act(black_box(&obs), &state, rows, Some(&mut noise)));
            });
        }
    }
}

criterion_group!(benches, step, act);
criterion_main!(benches);
