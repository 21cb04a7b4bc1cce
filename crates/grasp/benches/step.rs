//! One environment step of z-grasp, ten steps of the engine, as a rollout takes it: `cargo bench -p hwasp-mujoco`.

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use hwasp_core::{MakeEnvironment, Purpose, stream};
use hwasp_grasp::{Grasp, GraspSettings};

/// The palm goes down and the motor winds, so that the fingers come to touch the object; an episode that has ended begins
/// again.
fn step(c: &mut Criterion) {
    let grasp = Grasp::new(GraspSettings::default()).expect("the paper's task is sound");
    let law = grasp.law();
    let design = law.design().values(&vec![0.0; law.design().len()]);
    let mut environment = grasp.make(None);
    let spec = environment.spec().clone();
    let (mut seen, mut state) = (vec![0.0; spec.observation.len()], vec![0.0; spec.state.len()]);
    let mut effort = vec![0.0; spec.effort.len()];
    let mut episode = 0;
    let mut reset = |environment: &mut dyn hwasp_core::Environment| {
        episode += 1;
        environment.reset(&mut stream(1, Purpose::TrainingReset, 0, episode));
    };
    reset(&mut *environment);
    c.bench_function("z-grasp step", |b| {
        b.iter(|| {
            environment.observe(&mut seen);
            environment.state(&mut state);
            let command = [-0.001, 0.0001];
            law.effort(&design, &command, &state, &mut effort);
            if black_box(environment.step(&effort, &command)).end.is_some() {
                reset(&mut *environment);
            }
        });
    });
}

criterion_group!(benches, step);
criterion_main!(benches);
