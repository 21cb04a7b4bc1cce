//! A step of a grasp allocates nothing on our side of the engine, which has an arena of its own.

#![allow(clippy::unwrap_used)] // a panic is how a test fails

use hwasp_core::{MakeEnvironment, Purpose, stream};
use hwasp_grasp::{Grasp, GraspSettings};

#[test]
fn grasp_steps_do_not_allocate() {
    let grasp = Grasp::new(GraspSettings::default()).unwrap();
    let law = grasp.law();
    let design = law.design().values(&vec![0.0; law.design().len()]);
    let mut environment = grasp.make(None);
    let spec = environment.spec().clone();
    let (mut seen, mut state) = (vec![0.0; spec.observation.len()], vec![0.0; spec.state.len()]);
    let mut effort = vec![0.0; spec.effort.len()];
    environment.reset(&mut stream(1, Purpose::Check, 0, 0));
    // Down onto the object, and the tendons wound: contacts come and go.
    let counted = allocation_counter::measure(|| {
        for _ in 0..200 {
            environment.observe(&mut seen);
            environment.state(&mut state);
            let command = [-0.001, 0.0001];
            law.effort(&design, &command, &state, &mut effort);
            environment.step(&effort, &command);
            assert!(environment.outcome().is_some());
        }
    });
    assert_eq!(counted.count_total, 0, "{counted:?}");
}
