//! Laws as they are composed into a policy: forward, vjp and jvp over a block of 64 rows, and the direct form that the
//! simulator calls. On one thread: `cargo bench -p hwasp-tasks`.

use std::hint::black_box;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use hwasp_core::Law;
use hwasp_diff::Program;
use hwasp_tasks::hand::{HandDescription, TendonHand, TendonHandSettings};
use hwasp_tasks::mass_spring::{MassSpring, MassSpringSettings};

const ROWS: usize = 64;

/// The law as a program, its design squashed.
fn program(law: &Law) -> Program {
    let (space, ports) = (law.design(), law.ports());
    let columns: Vec<String> = ports.command.iter().chain(&ports.state).cloned().collect();
    Program::trace(&space.names(), &columns, |u, c| {
        let design: Vec<_> = u.iter().enumerate().map(|(i, &u)| space.squash(i, u)).collect();
        let (command, state) = c.split_at(ports.command.len());
        ports.effort.iter().cloned().zip(law.effort_traced(&design, command, state)).collect()
    })
}

fn laws(c: &mut Criterion) {
    let springs = |count| {
        let settings = MassSpringSettings { count, ..MassSpringSettings::default() };
        MassSpring::stiffness(settings).expect("the paper's settings are sound").law()
    };
    let hand = TendonHand::new(&HandDescription::default().transmission, &TendonHandSettings::default());
    let hand = Law::new(hand.expect("the paper's hand is sound"));
    for (name, law) in [("10 springs", springs(10)), ("1000 springs", springs(1000)), ("tendon hand", hand)] {
        let program = program(&law);
        let (inputs, outputs) = (program.column_names().len(), program.output_names().len());
        let (columns, mut moved) = (vec![0.02_f32; inputs * ROWS], vec![0.0_f32; inputs * ROWS]);
        let (mut out, cotangent) = (vec![0.0_f32; outputs * ROWS], vec![0.1_f32; outputs * ROWS]);
        let mut tape = program.tape::<f32>(ROWS);
        let uniforms = vec![0.3; law.design().len()];
        let mut group = c.benchmark_group(name);
        group.bench_function("bind", |b| b.iter(|| program.bind(black_box(&uniforms), &mut tape)));
        program.bind_tangent(&uniforms, &mut tape);
        group.throughput(Throughput::Elements(ROWS as u64));
        group.bench_function("forward", |b| {
            b.iter(|| program.forward(black_box(&columns), ROWS, ROWS, &mut tape, &mut out, ROWS));
        });
        group.bench_function("vjp", |b| {
            b.iter(|| program.vjp(black_box(&columns), ROWS, ROWS, &cotangent, ROWS, &mut tape, &mut moved, ROWS));
        });
        group.bench_function("jvp", |b| {
            b.iter(|| program.jvp(black_box(&columns), &columns, ROWS, ROWS, &mut tape, &mut out, ROWS));
        });
        let (design, mut effort) = (law.design().values(&vec![0.3; law.design().len()]), vec![0.0; outputs]);
        let (command, state) = (vec![0.02; law.ports().command.len()], vec![0.02; law.ports().state.len()]);
        group.throughput(Throughput::Elements(1));
        group.bench_function("direct", |b| b.iter(|| law.effort(black_box(&design), &command, &state, &mut effort)));
    }
}

criterion_group!(benches, laws);
criterion_main!(benches);
