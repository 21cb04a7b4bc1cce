//! A design set by name and compiled, as an episode begins: `cargo bench -p hwasp-mujoco --bench compile`.

#![allow(clippy::unwrap_used)] // the leg is that of the tests

#[path = "../tests/common/mod.rs"]
mod common;

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};

/// A shin of another length, what follows it, and a gear.
fn compile(c: &mut Criterion) {
    let fields =
        ["geom.shin.size[1]", "geom.shin.pos.z", "body.foot.pos.z", "joint.knee.springref", "actuator.knee.gear"]
            .map(common::path);
    for (name, lean) in [("with visuals", false), ("without visuals", true)] {
        let mut spec = common::spec(common::HOPPER);
        if lean {
            spec.discard_visual().expect("the leg compiles");
        }
        let mut half = 0.25;
        c.bench_function(&format!("design of a leg, {name}"), |b| {
            b.iter(|| {
                half = if half < 0.35 { half + 1e-6 } else { 0.25 };
                for (field, value) in fields.iter().zip([half, -half, -2.0 * half, -0.3, 100.0]) {
                    spec.set(field, value).expect("within the limits");
                }
                black_box(spec.compile().expect("the leg compiles"));
            });
        });
    }
}

criterion_group!(benches, compile);
criterion_main!(benches);
