//! Velocities, forces, energy and tendons, against arithmetic by hand.

#![allow(clippy::unwrap_used)] // a panic is how a test fails

mod common;

use common::HOPPER;
use hwasp_mujoco::engine::{ContactForce, Simulation};

fn close<const N: usize>(a: [f64; N], b: [f64; N], what: &str) {
    assert!(a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-9), "{what}: {a:?} is not {b:?}");
}

/// Two masses: 3 kg at the base, and 1 kg in the middle of an arm of 0.4 m that hangs down.
const ARM: &str = r#"<mujoco>
  <option gravity="0 0 -10" timestep="0.001"/>
  <worldbody>
    <site name="anchor" pos="0.3 0 0"/>
    <body name="base" pos="0 0 1">
      <joint name="slide" type="slide" axis="1 0 0"/>
      <geom name="base" size="0.1" mass="3"/>
      <body name="arm">
        <joint name="hinge" axis="0 1 0"/>
        <geom name="arm" type="capsule" size="0.02" fromto="0 0 0 0 0 -0.4" mass="1"/>
        <site name="tip" pos="0 0 -0.4" euler="0 0 90"/>
      </body>
    </body>
  </worldbody>
  <tendon>
    <fixed name="cable"><joint joint="hinge" coef="0.03"/><joint joint="slide" coef="2"/></fixed>
    <spatial name="rope"><site site="anchor"/><site site="tip"/></spatial>
  </tendon>
  <actuator>
    <motor name="turn" joint="hinge" gear="4"/>
    <general name="slow" joint="slide" dyntype="filter" dynprm="0.1"/>
  </actuator>
  <keyframe><key name="out" time="2" qpos="0.5 0.25" qvel="1 2" ctrl="3 4" act="5"/></keyframe>
</mujoco>"#;

fn arm(qpos: [f64; 2], qvel: [f64; 2]) -> Simulation {
    let mut simulation = Simulation::from_mjcf(ARM).unwrap();
    simulation.set_state(&qpos, &qvel).unwrap();
    simulation.forward().unwrap();
    simulation
}

#[test]
fn velocities_are_those_of_the_origin_in_the_worlds_frame() {
    let angle: f64 = 0.3;
    let mut simulation = arm([0.2, angle], [0.7, 2.0]);
    let [world, base, arm] = ["world", "base", "arm"].map(|name| simulation.body(name).unwrap());
    close(simulation.body_velocity(base).linear, [0.7, 0.0, 0.0], "base");
    let twist = simulation.body_velocity(arm);
    // The arm turns about its origin, which moves with the base.
    close(twist.linear, [0.7, 0.0, 0.0], "arm");
    close(twist.angular, [0.0, 2.0, 0.0], "arm");
    // Its middle is 0.2 m along it, and turning about y takes -z towards -x.
    let middle = [0.2 - 0.2 * angle.sin(), 0.0, 1.0 - 0.2 * angle.cos()];
    close(simulation.body_center(arm), middle, "middle");
    let whole = [(3.0 * 0.2 + middle[0]) / 4.0, 0.0, (3.0 + middle[2]) / 4.0];
    close(simulation.subtree_center(world), whole, "all");
    close(simulation.subtree_center(arm), middle, "arm alone");
    let middle_velocity = [0.7 - 0.2 * 2.0 * angle.cos(), 0.0, 0.2 * 2.0 * angle.sin()];
    close(simulation.subtree_velocity(arm), middle_velocity, "arm alone");
    let whole_velocity = [(3.0 * 0.7 + middle_velocity[0]) / 4.0, 0.0, middle_velocity[2] / 4.0];
    close(simulation.subtree_velocity(world), whole_velocity, "all");
    // Computed anew for another state.
    simulation.set_state(&[0.0, 0.0], &[1.0, 0.0]).unwrap();
    simulation.forward().unwrap();
    close(simulation.subtree_velocity(world), [1.0, 0.0, 0.0], "another state");
}

#[test]
fn sites_and_geoms_have_a_place_and_a_direction() {
    let angle: f64 = 0.3;
    let simulation = arm([0.2, angle], [0.0; 2]);
    let tip = simulation.site("tip").unwrap();
    close(simulation.site_position(tip), [0.2 - 0.4 * angle.sin(), 0.0, 1.0 - 0.4 * angle.cos()], "tip");
    // 0.3 rad about y, then 90° about the new z.
    let (c, s) = ((angle / 2.0).cos(), (angle / 2.0).sin());
    let half = std::f64::consts::FRAC_1_SQRT_2;
    close(simulation.site_orientation(tip), [c * half, s * half, s * half, c * half], "tip");
    let base = simulation.geom("base").unwrap();
    close(simulation.geom_orientation(base), [1.0, 0.0, 0.0, 0.0], "base");
}

#[test]
fn energy_is_kept() {
    let mut simulation = arm([0.0, 1.0], [0.5, -1.0]);
    let base = simulation.body("base").unwrap();
    let energy = simulation.energy();
    let [middle] = [simulation.body_center(simulation.body("arm").unwrap())];
    let potential = 10.0 * (3.0 * simulation.body_position(base)[2] + middle[2]);
    assert!((energy.potential - potential).abs() < 1e-9, "{energy:?} {potential}");
    let mut matrix = [0.0; 4];
    simulation.mass_matrix(&mut matrix);
    let [[a, b], [c, d]] = [[matrix[0], matrix[1]], [matrix[2], matrix[3]]];
    let kinetic = 0.5 * (0.5 * (a * 0.5 - b) - (c * 0.5 - d));
    assert!((energy.kinetic - kinetic).abs() < 1e-9, "{energy:?} {kinetic}");
    simulation.step(100).unwrap();
    simulation.forward().unwrap();
    let later = simulation.energy();
    let total = |energy: hwasp_mujoco::engine::Energy| energy.potential + energy.kinetic;
    assert!((total(later) - total(energy)).abs() < 2e-2 && (later.kinetic - energy.kinetic).abs() > 0.05, "{later:?}");
}

/// Both tendons: what their length changes by, and what their pull does.
#[test]
fn tendons_pull() {
    let mut simulation = arm([0.2, 0.3], [0.7, 2.0]);
    let [cable, rope] = ["cable", "rope"].map(|name| simulation.tendon(name).unwrap());
    let mut moment = [0.0; 2];
    simulation.tendon_moment(cable, &mut moment);
    close(moment, [2.0, 0.03], "cable");
    assert!((simulation.tendon_velocity(cable) - (2.0 * 0.7 + 0.03 * 2.0)).abs() < 1e-12);
    simulation.tendon_moment(rope, &mut moment);
    let length = simulation.tendon_length(rope);
    for dof in 0..2 {
        let mut moved = [0.2, 0.3];
        moved[dof] += 1e-6;
        let change = arm(moved, [0.0; 2]).tendon_length(rope) - length;
        assert!((change / 1e-6 - moment[dof]).abs() < 1e-5, "{dof}: {change} {moment:?}");
    }
    // A pull of 5 N is what an applied force of -5 N times the moment arms is, on top of what is there.
    simulation.qfrc_applied_mut()[0] = 1.0;
    simulation.add_tendon_tension(rope, 5.0);
    simulation.add_tendon_tension(cable, 2.0);
    close(
        [simulation.qfrc_applied()[0], simulation.qfrc_applied()[1]],
        [1.0 - 5.0 * moment[0] - 4.0, -5.0 * moment[1] - 0.06],
        "applied",
    );
    // It shortens what it pulls on.
    let mut pulled = arm([0.2, 0.3], [0.0; 2]);
    pulled.add_tendon_tension(rope, 200.0);
    pulled.step(20).unwrap();
    let mut left = arm([0.2, 0.3], [0.0; 2]);
    left.step(20).unwrap();
    assert!(pulled.tendon_length(rope) < left.tendon_length(rope));
}

#[test]
fn actuators_tell_force_length_velocity_and_activation() {
    let mut simulation = arm([0.2, 0.3], [0.7, 2.0]);
    let [turn, slow] = ["turn", "slow"].map(|name| simulation.actuator(name).unwrap());
    simulation.ctrl_mut().copy_from_slice(&[1.5, 1.0]);
    simulation.activations_mut()[0] = 0.25;
    simulation.forward().unwrap();
    assert!((simulation.actuator_force(turn) - 1.5).abs() < 1e-12);
    assert!((simulation.actuator_force(slow) - 0.25).abs() < 1e-12);
    assert!((simulation.actuator_length(turn) - 4.0 * 0.3).abs() < 1e-12);
    assert!((simulation.actuator_velocity(turn) - 4.0 * 2.0).abs() < 1e-12);
    simulation.step(1).unwrap();
    // A filter of 0.1 s: a step of 1 ms takes it a hundredth of the way.
    assert!((simulation.activations()[0] - (0.25 + 0.75 * 0.01)).abs() < 1e-12);
}

#[test]
fn keyframes_are_states_with_names() {
    let mut simulation = arm([0.1, 0.1], [0.0; 2]);
    let out = simulation.keyframe("out").unwrap();
    assert_eq!(simulation.keyframe_qpos(out), [0.5, 0.25]);
    simulation.qpos_mut()[0] = f64::NAN;
    simulation.step(1).unwrap_err();
    simulation.set_keyframe(out);
    assert_eq!((simulation.time(), simulation.qpos(), simulation.qvel()), (2.0, &[0.5, 0.25][..], &[1.0, 2.0][..]));
    assert_eq!((simulation.ctrl(), simulation.activations()), (&[3.0, 4.0][..], &[5.0][..]));
    simulation.step(1).unwrap();
    assert!(simulation.keyframe("in").unwrap_err().to_string().contains("it has: out"));
}

#[test]
fn a_state_of_another_size_is_refused() {
    let mut simulation = arm([0.1, 0.2], [0.3, 0.4]);
    let error = simulation.set_state(&[1.0], &[2.0, 3.0]).unwrap_err();
    assert_eq!(error.to_string(), "a state of 1 positions and 2 velocities does not fit a model of 2 and 2");
    assert_eq!((simulation.qpos(), simulation.qvel()), (&[0.1, 0.2][..], &[0.3, 0.4][..]));
}

/// A ball of 2 kg rests on a floor that leans by 0.2 rad: what the floor does to it holds it against gravity.
#[test]
fn contacts_carry_what_rests_on_them() {
    let mut simulation = Simulation::from_mjcf(
        r#"<mujoco><option gravity="0 0 -10" timestep="0.002" cone="elliptic" impratio="100"/><worldbody>
           <geom name="floor" type="plane" size="9 9 1" euler="0 11.459155902616466 0" friction="2 0.005 0.0001" condim="3"/>
           <body name="box" pos="0 0 0.1" euler="0 11.459155902616466 0"><freejoint/>
           <geom name="box" type="box" size="0.1 0.1 0.1" mass="2"/></body></worldbody></mujoco>"#,
    )
    .unwrap();
    simulation.step(1500).unwrap();
    simulation.forward().unwrap();
    let [floor, ball] = ["floor", "box"].map(|name| simulation.geom(name).unwrap());
    let on_box = simulation.contact_force(ball, floor);
    assert_eq!(on_box.contacts, 4);
    let near = |a: f64, b: f64| (a - b).abs() < 0.05;
    assert!(near(on_box.normal, 20.0 * 0.2_f64.cos()), "{on_box:?}");
    assert!(near(on_box.force[2], 20.0) && near(on_box.force[0], 0.0) && near(on_box.force[1], 0.0), "{on_box:?}");
    // The box does not turn, so nothing turns it about its centre.
    assert!(on_box.torque.iter().all(|&torque| near(torque, 0.0)), "{on_box:?}");
    let on_floor = simulation.contact_force(floor, ball);
    assert!(near(on_floor.force[2], -20.0) && near(on_floor.normal, on_box.normal), "{on_floor:?}");
    assert_eq!(simulation.contact_force(floor, floor), ContactForce::default());
    // The engine's sum, about the centre of mass of the box, is the same.
    let body = simulation.body("box").unwrap();
    let [tx, ty, tz, fx, fy, fz] = simulation.external_force(body);
    close([fx, fy, fz], on_box.force, "force");
    close([tx, ty, tz], on_box.torque, "torque");
    // Computed anew after a step.
    simulation.step(1).unwrap();
    assert!(near(simulation.external_force(body)[5], 20.0));
}

#[test]
fn sensors_are_read_by_name() {
    let mut simulation = Simulation::from_mjcf(
        r#"<mujoco><worldbody><body name="b" pos="1 2 3"><joint name="j" axis="0 0 1"/><geom size="0.1"/></body></worldbody>
           <sensor><framepos name="place" objtype="body" objname="b"/><jointvel name="turn" joint="j"/></sensor></mujoco>"#,
    )
    .unwrap();
    simulation.qvel_mut()[0] = 0.5;
    simulation.forward().unwrap();
    let [place, turn] = ["place", "turn"].map(|name| simulation.sensor(name).unwrap());
    assert_eq!(simulation.sensor_values(place), [1.0, 2.0, 3.0]);
    assert_eq!(simulation.sensor_values(turn), [0.5]);
}

/// Stepping and reading allocate nothing on our side of the engine, which has an arena of its own.
#[test]
fn reading_does_not_allocate() {
    let mut simulation = Simulation::from_mjcf(HOPPER).unwrap();
    let inventory = simulation.inventory();
    let floor = simulation.geom("floor").unwrap();
    let toe = simulation.site("toe").unwrap();
    let (qpos, qvel) = (simulation.qpos().to_vec(), simulation.qvel().to_vec());
    let mut sum = 0.0;
    let counted = allocation_counter::measure(|| {
        for step in 0..200 {
            simulation.ctrl_mut().fill(0.1);
            simulation.step(4).unwrap();
            simulation.forward().unwrap();
            for body in &inventory.bodies {
                sum += simulation.body_velocity(body.id).linear[0] + simulation.body_center(body.id)[2];
                sum += simulation.subtree_center(body.id)[0] + simulation.subtree_velocity(body.id)[0];
                sum += simulation.external_force(body.id)[5];
            }
            for geom in &inventory.geoms {
                sum += simulation.contact_force(geom.id, floor).normal + simulation.geom_orientation(geom.id)[0];
            }
            for actuator in &inventory.actuators {
                sum += simulation.actuator_force(actuator.id) + simulation.actuator_velocity(actuator.id);
            }
            sum += simulation.energy().kinetic + simulation.site_position(toe)[2] + simulation.site_orientation(toe)[1];
            sum += simulation.sensordata().len() as f64;
            if step == 100 {
                simulation.set_state(&qpos, &qvel).unwrap();
            }
        }
    });
    assert!(sum.is_finite());
    assert_eq!(counted.count_total, 0, "{counted:?}");
    // Tendons too.
    let mut simulation = arm([0.2, 0.3], [0.0; 2]);
    let rope = simulation.tendon("rope").unwrap();
    let mut moment = [0.0; 2];
    let counted = allocation_counter::measure(|| {
        for _ in 0..100 {
            simulation.qfrc_applied_mut().fill(0.0);
            simulation.add_tendon_tension(rope, 3.0);
            simulation.step(1).unwrap();
            simulation.tendon_moment(rope, &mut moment);
        }
    });
    assert_eq!(counted.count_total, 0, "{counted:?}");
}
