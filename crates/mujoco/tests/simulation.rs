//! Building, stepping, reading, names.

#![allow(clippy::unwrap_used)] // a panic is how a test fails

mod common;

use common::{MASS, SHAPES, simulation, trajectory};
use hwasp_mujoco::engine::{BuildError, Simulation, Wrench};

const BALL: &str = r#"<mujoco>
  <option timestep="0.001" gravity="0 0 -9.81" integrator="Euler"/>
  <worldbody>
    <body name="ball" pos="0 0 1">
      <freejoint/>
      <geom name="ball" size="0.1" mass="2"/>
    </body>
  </worldbody>
</mujoco>"#;

const ARM: &str = r#"<mujoco>
  <worldbody>
    <body name="base">
      <joint name="slide" type="slide" axis="1 0 0"/>
      <geom name="base" size="0.1" mass="3"/>
      <body name="arm">
        <joint name="hinge" axis="0 1 0"/>
        <geom name="arm" type="capsule" size="0.02" fromto="0 0 0 0 0 -0.4" mass="1"/>
      </body>
    </body>
    <body name="loose" pos="0 2 0"><freejoint name="free"/><geom name="loose" size="0.1"/></body>
  </worldbody>
  <tendon><fixed name="cable"><joint joint="hinge" coef="0.03"/></fixed></tendon>
  <actuator><motor name="pull" tendon="cable" gear="-1"/><motor name="push" joint="slide"/></actuator>
</mujoco>"#;

/// Semi-implicit Euler has a closed form of its own: after n steps of h, v = -g n h and z = z0 - g h² n (n + 1) / 2.
#[test]
fn a_ball_falls_as_the_integrator_says() {
    let mut simulation = Simulation::from_mjcf(BALL).unwrap();
    simulation.step(500).unwrap();
    let (n, h, g) = (500.0, simulation.timestep(), 9.81);
    assert!((simulation.qvel()[2] + g * n * h).abs() < 1e-12, "{}", simulation.qvel()[2]);
    assert!((simulation.qpos()[2] - (1.0 - g * h * h * n * (n + 1.0) / 2.0)).abs() < 1e-12, "{}", simulation.qpos()[2]);
    assert!((simulation.time() - 0.5).abs() < 1e-12);

    // Positions of bodies are a step behind until they are asked for.
    let ball = simulation.body("ball").unwrap();
    assert_ne!(simulation.body_position(ball)[2], simulation.qpos()[2]);
    simulation.forward().unwrap();
    assert_eq!(simulation.body_position(ball)[2], simulation.qpos()[2]);
    assert_eq!(simulation.geom_position(simulation.geom("ball").unwrap())[2], simulation.qpos()[2]);
    assert_eq!(simulation.body_orientation(ball), [1.0, 0.0, 0.0, 0.0]);

    simulation.reset();
    assert_eq!((simulation.time(), simulation.qpos()[2], simulation.qvel()[2]), (0.0, 1.0, 0.0));
}

#[test]
fn a_wrench_accelerates_a_body_until_the_reset() {
    let mut simulation = Simulation::from_mjcf(BALL).unwrap();
    let ball = simulation.body("ball").unwrap();
    let upwards = Wrench { force: [1.0, 0.0, 2.0 * 9.81], torque: [0.0, 0.004, 0.0] };
    simulation.set_wrench(ball, upwards);
    simulation.forward().unwrap();
    // 2 kg, and 2/5 m r² = 0.008 kg·m².
    let expected = [0.5, 0.0, 0.0, 0.0, 0.5, 0.0];
    for (acceleration, expected) in simulation.qacc().iter().zip(expected) {
        assert!((acceleration - expected).abs() < 1e-12, "{:?}", simulation.qacc());
    }
    simulation.reset();
    simulation.forward().unwrap();
    assert!((simulation.qacc()[2] + 9.81).abs() < 1e-12, "{:?}", simulation.qacc());
}

#[test]
fn names_give_addresses_in_the_state() {
    let mut simulation = Simulation::from_mjcf(ARM).unwrap();
    let hinge = simulation.joint("hinge").unwrap();
    let free = simulation.joint("free").unwrap();
    assert_eq!((hinge.qpos.clone(), hinge.dof.clone()), (1..2, 1..2));
    assert_eq!((free.qpos, free.dof), (2..9, 2..8));
    assert_eq!(simulation.actuator("push").unwrap().index(), 1);

    simulation.qpos_mut()[hinge.qpos.start] = 0.5;
    let pull = simulation.actuator("pull").unwrap().index();
    simulation.ctrl_mut()[pull] = 10.0;
    simulation.forward().unwrap();
    assert!((simulation.tendon_length(simulation.tendon("cable").unwrap()) - 0.015).abs() < 1e-15);
    assert!((simulation.qfrc_actuator()[hinge.dof.start] + 0.3).abs() < 1e-15);
    assert_eq!(simulation.mass(simulation.body("base").unwrap()), 3.0);

    let mut mass = [0.0; 64];
    simulation.mass_matrix(&mut mass);
    assert!((mass[0] - 4.0).abs() < 1e-12, "the slide moves base and arm: {}", mass[0]);
    assert_eq!(mass[1], mass[8], "symmetric");
}

#[test]
fn an_applied_force_does_what_an_actuator_does() {
    let velocity = |apply: fn(&mut Simulation)| {
        let mut simulation = Simulation::from_mjcf(ARM).unwrap();
        apply(&mut simulation);
        simulation.step(50).unwrap();
        simulation.qvel()[0]
    };
    let driven = velocity(|simulation| simulation.ctrl_mut()[1] = 2.0);
    let applied = velocity(|simulation| simulation.qfrc_applied_mut()[0] = 2.0);
    assert!(driven > 0.04, "{driven}");
    assert!((driven - applied).abs() < 1e-12, "{driven} and {applied}");
}

#[test]
fn an_unknown_name_is_an_error_that_names_the_known_ones() {
    let simulation = Simulation::from_mjcf(ARM).unwrap();
    assert_eq!(
        simulation.geom("thumb").unwrap_err().to_string(),
        "the model has no geom `thumb`; it has: base, arm, loose"
    );
    assert!(simulation.body("base\0").is_err(), "a name with a NUL");
    assert!(simulation.joint("").is_err(), "an empty name is not that of an unnamed joint");
    let simulation = Simulation::from_mjcf(BALL).unwrap();
    let message = simulation.tendon("cable").unwrap_err().to_string();
    assert_eq!(message, "the model has no tendon `cable`; it names no tendon");
}

#[test]
fn a_faulty_text_is_an_error_in_the_words_of_the_engine() {
    let message = |mjcf: &str| match Simulation::from_mjcf(mjcf) {
        Err(BuildError::Mjcf(message)) => message,
        other => panic!("{other:?}"),
    };
    let schema = message("<mujoco><worldbody><boddy/></worldbody></mujoco>");
    assert!(schema.contains("unrecognized element") && schema.contains("boddy"), "{schema}");
    let compiler = message("<mujoco><worldbody><body><freejoint/></body></worldbody></mujoco>");
    assert!(compiler.contains("mass and inertia of moving bodies must be larger than mjMINVAL"), "{compiler}");
    assert!(message("no XML at all").contains("XML"));
}

#[test]
fn contacts_are_those_of_the_geoms_asked_for() {
    let mut simulation = simulation(SHAPES[0], MASS, 1.0);
    let [object, floor, left, right] = ["object", "floor", "left", "right"].map(|name| simulation.geom(name).unwrap());
    let set = [floor, left, right];
    let mut touched = [true; 3];
    simulation.forward().unwrap();
    assert_eq!((simulation.touching(&[object], &set, &mut touched), touched), (0, [false; 3]));

    // Wedged between the posts, above the floor.
    simulation.step(1500).unwrap();
    assert_eq!((simulation.touching(&[object], &set, &mut touched), touched), (2, [false, true, true]));
    assert!(simulation.touch(object, left) && simulation.touch(left, object) && !simulation.touch(object, floor));
    assert_eq!(simulation.touching(&[floor, left], &[object], &mut touched[..1]), 1);
    let contact = simulation.contacts().find(|contact| contact.geoms.contains(&right)).unwrap();
    assert!(contact.distance < 0.0 && contact.distance > -5e-3, "{contact:?}");
    let outwards = if contact.geoms[1] == right { 1.0 } else { -1.0 };
    assert!(contact.position[0] > 0.0 && outwards * contact.normal[0] > 0.9, "{contact:?}");
}

#[test]
fn two_threads_give_the_same_bits() {
    let runs: Vec<_> = std::thread::scope(|scope| {
        let run = || trajectory(&mut simulation(SHAPES[1], MASS, 1.0));
        let threads = [scope.spawn(run), scope.spawn(run)];
        threads.map(|thread| thread.join().unwrap()).into()
    });
    assert_eq!(runs[0], runs[1]);
    // And nothing is left of a run after the reset, nor shared with a clone.
    let mut simulation = simulation(SHAPES[1], MASS, 1.0);
    let mut clone = simulation.clone();
    assert_eq!(trajectory(&mut simulation), runs[0]);
    simulation.reset();
    assert_eq!(trajectory(&mut simulation), runs[0]);
    assert_eq!(trajectory(&mut clone), runs[0]);
}
