//! Broken states. All in one test: the working directory belongs to the process.

#![allow(clippy::unwrap_used)] // a panic is how a test fails

mod common;

use std::fs;

use common::{MASS, SHAPES, simulation};
use hwasp_mujoco::engine::{Simulation, Warning};

/// The engine resets such a state and goes on, with one line in a log file in the working directory.
#[test]
fn a_broken_state_is_a_fault_and_leaves_no_log_file() {
    let folder = std::env::temp_dir().join(format!("hwasp-mujoco-faults-{}", std::process::id()));
    fs::create_dir_all(&folder).unwrap();
    std::env::set_current_dir(&folder).unwrap();

    positions_velocities_and_forces();
    a_fault_within_many_steps_has_its_time();
    what_is_found_only_after_the_last_step();
    too_many_contacts();

    let left: Vec<_> = fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    assert!(left.is_empty(), "{left:?}");
    std::env::set_current_dir("/").unwrap();
    fs::remove_dir(&folder).unwrap();
}

fn positions_velocities_and_forces() {
    type Poison = fn(&mut Simulation);
    let poisons: [(Poison, Warning); 5] = [
        (|simulation| simulation.qpos_mut()[2] = f64::NAN, Warning::BadPosition),
        (|simulation| simulation.qpos_mut()[2] = 1e11, Warning::BadPosition),
        (|simulation| simulation.qvel_mut()[2] = f64::INFINITY, Warning::BadVelocity),
        (|simulation| simulation.qfrc_applied_mut()[2] = f64::NAN, Warning::BadAcceleration),
        (|simulation| simulation.qfrc_applied_mut()[2] = 1e12, Warning::BadAcceleration),
    ];
    for (number, (poison, expected)) in poisons.into_iter().enumerate() {
        let mut simulation = simulation(SHAPES[0], MASS, 1.0);
        simulation.step(10).unwrap();
        poison(&mut simulation);
        let fault = simulation.step(10).unwrap_err();
        assert_eq!((fault.warning, fault.index), (expected, 2), "poison {number}");
        assert!((fault.time - 0.01).abs() < 1e-12, "poison {number}: {fault}");
        assert!(fault.message.contains("The simulation is unstable"), "poison {number}: {fault}");
        assert_eq!(simulation.step(1).unwrap_err(), fault, "it stays until the reset");
        assert_eq!(simulation.forward().unwrap_err(), fault);
        simulation.reset();
        simulation.step(10).unwrap();
    }
}

/// A load that grows with time, as a controller that runs away would make it.
fn a_fault_within_many_steps_has_its_time() {
    let mut simulation = Simulation::from_mjcf(
        r#"<mujoco><option timestep="0.01" gravity="0 0 0"/><worldbody><body><joint name="slide" type="slide"/>
           <geom size="0.1"/></body></worldbody>
           <actuator><general name="away" joint="slide" biastype="affine" biasprm="0 1e7 0"/></actuator></mujoco>"#,
    )
    .unwrap();
    simulation.qpos_mut()[0] = 1.0;
    let fault = simulation.step(1000).unwrap_err();
    assert!(fault.time > 0.01 && fault.time < 0.5, "{fault}");
    let text = fault.to_string();
    assert!(text.starts_with(&format!("the physics broke down at {} s: bad", fault.time)), "{text}");
}

/// The engine looks at the state only at the start of the next step.
fn what_is_found_only_after_the_last_step() {
    let mut simulation = simulation(SHAPES[0], MASS, 1.0);
    simulation.qvel_mut()[2] = 9.9e9;
    simulation.qfrc_applied_mut()[2] = 1.9e9; // 9.5e9 m/s² on 0.2 kg: just below what is bad
    let mut steps = 0;
    let fault = loop {
        match simulation.step(1) {
            Ok(()) => steps += 1,
            Err(fault) => break fault,
        }
        assert!(steps < 100);
    };
    assert_eq!(fault.warning, Warning::BadVelocity, "{fault}");
    assert!(fault.message.contains("the value is"), "{fault}");
    simulation.reset();
    simulation.qpos_mut()[0] = f64::NAN;
    assert_eq!(simulation.forward().unwrap_err().warning, Warning::BadPosition);
}

fn too_many_contacts() {
    let ball = |i: i32| format!(r#"<body pos="{} 0 0.05"><freejoint/><geom size="0.1"/></body>"#, f64::from(i) * 0.05);
    let balls = (0..40).map(ball).collect::<Vec<_>>().concat();
    let mut simulation = Simulation::from_mjcf(&format!(
        r#"<mujoco><size memory="120K"/><worldbody><geom type="plane" size="9 9 1"/>{balls}</worldbody></mujoco>"#
    ))
    .unwrap();
    let fault = simulation.step(1).unwrap_err();
    assert!(matches!(fault.warning, Warning::ContactsFull | Warning::ConstraintsFull), "{fault}");
}
