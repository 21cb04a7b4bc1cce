//! Robots from text: what is seen, rewarded and done to them, against mechanics by hand.

#![allow(clippy::unwrap_used)] // a panic is how a test fails

mod common;

use std::sync::Arc;

use common::{begin, files, from, seen};
use hwasp_core::{End, Environment, Form};
use hwasp_experiment::{Experiment, Files};
use hwasp_problem::StandInKind;

/// A load on a slide and a rod on a hinge, without gravity, so that what acts is what a test applies.
const BENCH: &str = r#"<mujoco model="bench">
  <option timestep="0.001" gravity="0 0 0" integrator="Euler"/>
  <worldbody>
    <body name="load" pos="0 0 0">
      <joint name="slide" type="slide" axis="1 0 0"/>
      <geom name="load" type="box" size="0.1 0.1 0.1" mass="2"/>
    </body>
    <body name="rod" pos="0 1 0">
      <joint name="hinge" type="hinge" axis="0 1 0"/>
      <geom name="rod" type="capsule" size="0.02 0.25" pos="0 0 -0.25" mass="1"/>
      <site name="tip" pos="0 0 -0.5"/>
    </body>
  </worldbody>
  <tendon><fixed name="cord"><joint joint="slide" coef="1"/></fixed></tendon>
  <actuator>
    <motor name="push" joint="slide" ctrllimited="true" ctrlrange="-10 10"/>
    <motor name="turn" joint="hinge" ctrllimited="true" ctrlrange="-1 1"/>
  </actuator>
  <keyframe><key name="apart" qpos="0.3 0.4"/></keyframe>
</mujoco>"#;

/// The bench with keys and tables of `[task]`.
fn experiment(text: &str) -> Experiment {
    common::experiment(BENCH, text)
}

fn robot(text: &str) -> Box<dyn Environment> {
    common::robot(BENCH, text)
}

fn near(found: &[f64], wanted: &[f64], within: f64) {
    assert_eq!(found.len(), wanted.len(), "{found:?}");
    assert!(found.iter().zip(wanted).all(|(a, b)| (a - b).abs() <= within), "{found:?} is not {wanted:?}");
}

#[test]
fn what_is_seen_is_the_state_and_what_follows_of_it() {
    let mut robot = robot(
        "keyframe = \"apart\"\nobserve = [\"qpos\", \"site.tip.pos\", \"body.load.com.x\", \"yaw(body.rod.quat)\", \"com.pos.x\", \"time\"]\n",
    );
    begin(&mut *robot, 0);
    let (x, angle) = (0.3, 0.4_f64);
    // 2 kg at x and 1 kg in the middle of the rod.
    let centre = (2.0 * x - 0.25 * angle.sin()) / 3.0;
    let tip = [-0.5 * angle.sin(), 1.0, -0.5 * angle.cos()];
    near(&seen(&*robot), &[x, angle, tip[0], tip[1], tip[2], x, 0.0, centre, 0.0], 1e-12);
    robot.step(&[], &[0.0, 0.0]);
    assert_eq!(seen(&*robot)[8], 0.001);
}

/// A force of 4 N moves 2 kg by 2 m/s² (the engine's Euler: the speed first), and the terms of the reward add up.
#[test]
fn commands_move_and_rewards_add_up() {
    let mut robot = robot(
        "frame_skip = 10\nobserve = [\"joint.slide.pos\", \"diff(joint.slide.pos)\"]\nends = \"joint.slide.pos > 1 mm\"\n\
         [task.reward]\nspeed = \"diff(joint.slide.pos) / dt\"\neffort = \"-0.5 * command.push^2\"\n",
    );
    begin(&mut *robot, 0);
    near(&seen(&*robot), &[0.0, 0.0], 0.0);
    let place = |steps: f64| 2.0 * 1e-6 * steps * (steps + 1.0) / 2.0;
    let mut ended = None;
    for step in 1..=5 {
        let result = robot.step(&[], &[4.0, 0.0]);
        let (here, before) = (place(10.0 * f64::from(step)), place(10.0 * f64::from(step - 1)));
        near(&seen(&*robot), &[here, here - before], 1e-12);
        near(&[result.reward], &[(here - before) / 0.01 - 8.0], 1e-9);
        // By name: effort, speed.
        near(robot.terms(), &[-8.0 * f64::from(step), here / 0.01], 1e-9);
        ended = ended.or(result.end.map(|end| (step, end)));
    }
    assert_eq!(
        (ended, &robot.spec().terms[..]),
        (Some((4, End::Terminated)), &["effort", "speed"].map(String::from)[..])
    );
    begin(&mut *robot, 0);
    assert_eq!(robot.terms(), [0.0; 2]);
}

/// The law acts on joints and tendons beside the motors that it leaves alone, and takes the motors that it reads.
#[test]
fn efforts_act_where_they_are_said_to() {
    let text = "observe = [\"qvel\"]\n[task.law]\n\"joint.hinge\" = \"stiffness * (0.5 rad - joint.hinge.pos) + gear * command.turn\"\n\
                \"tendon.cord\" = \"max(3 N - 10 N/m * joint.slide.pos, 0 N)\"\n\
                [task.design]\nstiffness = { limits = [\"1 N*m/rad\", \"3 N*m/rad\"] }\ngear = { limits = [1, 9] }\n";
    let experiment = experiment(text);
    let world = &experiment.task.built().deployment;
    let ports = world.law.ports();
    assert_eq!(ports.command, ["push", "turn"]);
    assert_eq!(ports.state, ["joint.hinge.pos", "joint.slide.pos"]);
    assert_eq!(ports.effort, ["joint.hinge", "tendon.cord"]);
    let mut efforts = [0.0; 2];
    world.law.effort(&[4.0, 2.0], &[5.0, 0.25], &[0.1, 0.2], &mut efforts);
    near(&efforts, &[2.0 * 0.4 + 4.0 * 0.25, 1.0], 1e-12);
    let mut robot = world.make.make(None);
    begin(&mut *robot, 0);
    // 5 N of the motor less 3 N of the tendon, on 2 kg; the motor of the hinge rests, whatever it is told.
    robot.step(&[0.0, 3.0], &[5.0, 1.0]);
    near(&seen(&*robot), &[1e-3, 0.0], 1e-12);
    robot.step(&[0.7, 0.0], &[0.0, 1.0]);
    let inertia = 0.0857; // of the capsule about its end, nearly
    near(&seen(&*robot), &[1e-3, 0.7e-3 / inertia], 1e-5);
}

/// Held for a step, a stiff spring is another one than at the rate of the physics.
#[test]
fn the_law_at_the_rate_of_the_physics() {
    let text = "frame_skip = 20\nobserve = [\"qpos\"]\n[task.start]\n\"joint.slide.pos\" = \"0.1\"\n\
                [task.law]\n\"joint.slide\" = \"-stiffness * joint.slide.pos\"\n\
                [task.design]\nstiffness = { limits = [\"1 N/m\", \"3999 N/m\"] }\n";
    let experiment = experiment(text);
    let built = experiment.task.built();
    let stand_in = built.stand_in.as_ref().unwrap();
    assert_eq!(stand_in.kind, StandInKind::FastLaw);
    let fast = (stand_in.make)(&[2000.0]).unwrap();
    let mut robot = fast.make.make(None);
    robot.set_design(&[2000.0]);
    begin(&mut *robot, 0);
    // ω² = 1000/s²: the engine's Euler keeps the amplitude to a part in a hundred over 0.2 s.
    for _ in 0..10 {
        robot.step(&[9e9], &[0.0, 0.0]);
        assert!(seen(&*robot)[0].abs() < 0.102, "{:?}", seen(&*robot));
    }
    near(&seen(&*robot)[..1], &[0.1 * (1000.0_f64.sqrt() * 0.2).cos()], 0.01);
}

/// Lengths and masses of the model follow the design, whatever episode it is.
#[test]
fn the_model_follows_the_design() {
    let text = "observe = [\"site.tip.pos.z\", \"joint.hinge.vel\"]\nset = [\"body.load.mass = weight\"]\n\
                [task.random]\nweight = \"uniform(1 kg, 3 kg)\"\n\
                [task.design]\nlength = { limits = [\"0.2 m\", \"0.8 m\"], sets = [\"geom.rod.size[1] = length / 2\", \
                \"geom.rod.pos.z = -length / 2\", \"site.tip.pos.z = -length\"] }\n";
    let mut robot = robot(&text.replace("body.load.mass", "geom.load.mass"));
    let mut accelerations = Vec::new();
    for (episode, length) in [(0, 0.3), (1, 0.7), (2, 0.3)] {
        robot.set_design(&[length]);
        begin(&mut *robot, episode);
        near(&seen(&*robot)[..1], &[-length], 1e-12);
        robot.step(&[], &[0.0, 1.0]);
        accelerations.push(seen(&*robot)[1] / 1e-3);
    }
    assert_eq!(accelerations[0].to_bits(), accelerations[2].to_bits());
    assert!(accelerations[0] > 4.0 * accelerations[1], "{accelerations:?}");
}

/// Draws of an episode are its own, those of a start are one for each joint, and the same stream gives the same bits.
#[test]
fn chance_has_a_seed() {
    let text = "observe = [\"qpos\", \"push\", \"joint.slide.pos + normal(0, 1)\"]\nkeyframe = \"apart\"\n\
                [task.random]\npush = \"uniform(0, 1)\"\n[task.start]\n\"joint.*.pos\" = \"joint.*.pos + uniform(-0.1, 0.1)\"\n";
    let mut robot = robot(text);
    let mut episode = |number: u64| {
        begin(&mut *robot, number);
        let first = seen(&*robot);
        robot.step(&[], &[0.0, 0.0]);
        (first, seen(&*robot))
    };
    let (first, later) = episode(0);
    assert!(
        (first[0] - 0.3).abs() <= 0.1
            && (first[1] - 0.4).abs() <= 0.1
            && (first[0] - 0.3 - first[1] + 0.4).abs() > 1e-6
    );
    assert_eq!(first[2], later[2]);
    assert!((first[3] - later[3]).abs() > 1e-6, "noise is drawn anew");
    let other = episode(1);
    assert!(other.0[2] != first[2]);
    assert_eq!(episode(0), (first, later));
}

/// What is seen and what is done come late by the times that are said.
#[test]
fn delays_are_whole_steps() {
    let text = "observe = [\"time\", \"joint.slide.vel\"]\nobservation_delay = \"3 ms\"\ncommand_delay = \"2 ms\"\n";
    let mut robot = robot(text);
    begin(&mut *robot, 0);
    let mut all = vec![seen(&*robot)];
    for _ in 0..8 {
        robot.step(&[], &[2.0, 0.0]);
        all.push(seen(&*robot));
    }
    let times: Vec<f64> = all.iter().map(|seen| seen[0]).collect();
    near(&times, &[0.0, 0.0, 0.0, 0.0, 1e-3, 2e-3, 3e-3, 4e-3, 5e-3], 1e-12);
}

/// Bodies are pushed while it is said, and no longer.
#[test]
fn pushes_end() {
    let text =
        "observe = [\"joint.slide.vel\"]\n[task.forces]\n\"body.load\" = \"where(time < 3 ms, [2 N, 0, 0], 0)\"\n";
    let mut robot = robot(text);
    begin(&mut *robot, 0);
    for _ in 0..6 {
        robot.step(&[], &[0.0, 0.0]);
    }
    near(&seen(&*robot), &[3e-3], 1e-12);
}

#[test]
fn success_is_told_by_kinds() {
    let text = "success = \"joint.slide.pos > 0\"\n[task.kinds]\nfar = \"joint.slide.pos > 0.05\"\n\
                near = \"joint.slide.pos > -1\"\n[task.start]\n\"joint.slide.pos\" = \"uniform(-0.1, 0.1)\"\n";
    let mut robot = robot(text);
    for episode in 0..20 {
        begin(&mut *robot, episode);
        robot.step(&[], &[0.0, 0.0]);
        let (outcome, place) = (robot.outcome().unwrap(), seen(&*robot)[0]);
        assert_eq!((&*outcome.kind, outcome.success), (if place > 0.05 { "far" } else { "near" }, place > 0.0));
    }
}

/// What is written of it is read back to the same, with the model's files and their digest; another model is refused.
#[test]
fn a_robot_is_written_and_read_back() {
    let first = experiment(
        "observe = [\"qpos\"]\nends = \"joint.slide.pos > 1\"\n[task.define]\na = \"2 * b\"\nb = 3\n\
         [task.law]\n\"joint.hinge\" = \"-k * joint.hinge.pos\"\n[task.design]\nk = { limits = [0, \"3 N*m/rad\"], initial = \"1 N*m/rad\" }\n",
    );
    let text = first.to_toml().unwrap();
    let again = |files: &Arc<Files>| from(&text, files, None);
    assert_eq!(again(first.files()).unwrap(), first);
    assert_eq!(again(first.files()).unwrap().to_toml().unwrap(), text);
    let error = again(&files(&BENCH.replace("mass=\"2\"", "mass=\"3\""))).unwrap_err().to_string();
    assert!(error.contains("not those that it was trained with"), "{error}");
}

/// Ends by name are written and read back, and what is wrong in one is told at its place; one alone needs no name.
#[test]
fn ends_have_names() {
    let text = "[task.ends]\nfast = \"joint.slide.vel > 1\"\nright = \"joint.slide.pos > 0.02\"\n\
                [task.start]\n\"joint.slide.pos\" = \"0.05\"\n";
    let first = experiment(text);
    let written = first.to_toml().unwrap();
    assert_eq!(from(&written, first.files(), None).unwrap(), first);
    let mut robot = robot(text);
    begin(&mut *robot, 0);
    assert_eq!(robot.step(&[], &[0.0, 0.0]).end, Some(End::Terminated));
    assert_eq!(robot.ended_by().as_deref(), Some("right"));
}

/// A step allocates nothing, whatever is read, drawn, remembered and pushed.
#[test]
fn a_step_allocates_nothing() {
    let text = "observe = [\"qpos\", \"body.rod.vel\", \"diff(qvel)\", \"normal(qpos, 0.1)\", \"contact.load\"]\n\
                [task.forces]\n\"body.load\" = \"[uniform(-1, 1), 0, 0]\"\n[task.law]\n\"joint.hinge\" = \"-k * joint.hinge.pos\"\n\
                [task.design]\nk = { limits = [0, \"3 N*m/rad\"] }\n";
    let mut robot = robot(text);
    begin(&mut *robot, 0);
    robot.step(&[0.1], &[1.0, 0.0]);
    let mut out = vec![0.0; robot.spec().observation.len()];
    let counted = allocation_counter::measure(|| {
        for _ in 0..100 {
            robot.step(&[0.1], &[1.0, 0.0]);
            robot.observe(&mut out);
        }
    });
    assert_eq!(counted.count_total, 0);
}

/// Whoever looks sees the model where the state says it is, visuals and tendons included, and changes no bit of what follows.
#[test]
fn looking_changes_nothing() {
    let text = "frame_skip = 10\nobserve = [\"qpos\", \"qvel\"]\n[task.law]\n\"joint.hinge\" = \"stiffness * (0.5 rad - joint.hinge.pos)\"\n\
                [task.design]\nstiffness = { limits = [\"1 N*m/rad\", \"3 N*m/rad\"] }\n\
                edge = { limits = [\"0.1 m\", \"0.5 m\"], sets = [\"geom.load.size[0] = edge\"] }\n";
    let (mut looked, mut alone) = (robot(text), robot(text));
    for edge in [0.2, 0.3] {
        for robot in [&mut looked, &mut alone] {
            robot.set_design(&[edge, 2.0]);
            begin(&mut **robot, 0);
        }
        for _ in 0..20 {
            let sight = looked.look().unwrap();
            let state = seen(&*looked);
            let [load, rod] = &sight.solids[..] else { panic!("{sight:?}") };
            near(&load.at, &[state[0], 0.0, 0.0], 1e-12);
            near(&rod.at, &[-0.25 * state[1].sin(), 1.0, -0.25 * state[1].cos()], 1e-12);
            near(&rod.axes[2], &[state[1].sin(), 0.0, state[1].cos()], 1e-12);
            assert_eq!((&load.form, load.fixed), (&Form::Box([edge, 0.1, 0.1]), false));
            assert_eq!(rod.form, Form::Capsule { radius: 0.02, half_length: 0.25 });
            // One over joints has no way through space.
            assert!(sight.cords.iter().all(|cord| cord.parts.is_empty()));
            let steps = [&mut looked, &mut alone].map(|robot| robot.step(&[1.0], &[4.0, 0.0]));
            assert_eq!(steps[0], steps[1]);
            let bits = |robot: &dyn Environment| seen(robot).iter().map(|x| x.to_bits()).collect::<Vec<_>>();
            assert_eq!(bits(&*looked), bits(&*alone));
        }
    }
}
