//! The robots that come with the program, against geometry and mechanics by hand.

#![allow(clippy::unwrap_used)] // a panic is how a test fails

mod common;

use common::{begin, seen};
use hwasp_core::Environment;
use hwasp_experiment::Experiment;
use hwasp_testing::{layers, resolve};

/// An experiment that comes with the program, whose controller sees something else.
fn watched(name: &str, observe: &str) -> Experiment {
    resolve(layers(name).with_override("task.observe", observe), Some("fixed")).unwrap()
}

/// What is seen at the start of an episode with a design.
fn start(robot: &mut dyn Environment, design: &[f64], episode: u64) -> Vec<f64> {
    robot.set_design(design);
    begin(robot, episode);
    seen(robot)
}

/// Every corner of the limits of a design.
fn corners(experiment: &Experiment) -> impl Iterator<Item = Vec<f64>> {
    let groups = experiment.task.built().deployment.law.design().groups().to_vec();
    (0..1_usize << groups.len())
        .map(move |number| (0..).zip(&groups).map(|(i, group)| [group.lo, group.hi][number >> i & 1]).collect())
}

/// The five bars form a closed leg that stands on the floor, whatever their lengths, and stay closed while it moves.
#[test]
fn the_leg_is_closed() {
    let experiment = watched("five-bar", "[\"site.front_foot.pos - site.rear_foot.pos\", \"geom.foot.pos.z\"]");
    let world = &experiment.task.built().deployment;
    let mut robot = world.make.make(None);
    for design in corners(&experiment) {
        let first = start(&mut *robot, &design, 0);
        assert!(first[..3].iter().all(|gap| gap.abs() < 1e-9), "{design:?}: {first:?}");
        assert!((first[3] - 0.02).abs() < 1e-9, "{design:?}: the foot has a radius of 2 cm, and is at {}", first[3]);
        for _ in 0..20 {
            robot.step(&[5.0, -5.0], &[0.0, 0.0]);
            assert_eq!(robot.fault(), None, "{design:?}");
        }
        let gap = seen(&*robot)[..3].iter().map(|gap| gap * gap).sum::<f64>().sqrt();
        assert!(gap < 5e-3, "{design:?}: the bars are {gap} m apart");
    }
}

/// At rest the motors give their gear, and nothing more where they turn as fast as they can.
#[test]
fn motors_of_the_leg_have_gears_and_a_top_speed() {
    let experiment = watched("five-bar", "[\"qpos\"]");
    let law = &experiment.task.built().deployment.law;
    let names: Vec<&str> = law.ports().state.iter().map(String::as_str).collect();
    let state = |front_speed: f64| -> Vec<f64> {
        let value = |name: &&str| match *name {
            "joint.front_hip.vel" => front_speed,
            "joint.front_hip.pos" => 0.7,
            "joint.rear_hip.pos" => -0.4,
            _ => 0.0,
        };
        names.iter().map(value).collect()
    };
    // gear, rest, shank, stiffness, thigh
    let design = [10.0, 0.5, 0.2, 3.0, 0.1];
    let mut efforts = [0.0; 2];
    law.effort(&design, &[1.0, -0.5], &state(0.0), &mut efforts);
    let springs = [-3.0 * (0.7 - 0.5), -3.0 * (-0.4 + 0.5)];
    assert!((efforts[0] - (10.0 + springs[0])).abs() < 1e-12 && (efforts[1] - (-5.0 + springs[1])).abs() < 1e-12);
    law.effort(&design, &[1.0, -0.5], &state(25.0), &mut efforts);
    assert!((efforts[0] - springs[0]).abs() < 1e-12, "{efforts:?}");
}

/// Open fingers touch no box, whatever the design, and an unwound line does not pull.
#[test]
fn fingers_start_open() {
    let contacts = ["left_distal", "left_proximal", "right_distal", "right_proximal"];
    let observe: Vec<String> = contacts.iter().map(|finger| format!("\"contact.{finger}.box\"")).collect();
    let experiment = watched("tendon-gripper", &format!("[{}, \"tension / 1 N\"]", observe.join(", ")));
    let mut robot = experiment.task.built().deployment.make.make(None);
    for (episode, design) in (0..).zip(corners(&experiment)) {
        assert_eq!(start(&mut *robot, &design, episode), [0.0; 5], "{design:?}");
    }
}

/// 10 mm of a line of 4000 N/m pull with 40 N at every pulley, and no more than 60 N.
#[test]
fn one_tension_pulls_at_every_pulley() {
    let experiment = watched("tendon-gripper", "[\"qpos\"]");
    let law = &experiment.task.built().deployment.law;
    assert_eq!(law.ports().command, ["lift", "wound"]);
    // radius, rest and stiffness of the distal joints, and of the proximal ones
    let design = [4e-3, 0.25, 0.2, 12e-3, -0.5, 0.1];
    let state: Vec<f64> =
        law.ports().state.iter().map(|name| if name.contains("distal") { 0.25 } else { -0.5 }).collect();
    for (wound, tension) in [(0.0, 0.0), (10e-3, 40.0), (30e-3, 60.0)] {
        let mut efforts = [0.0; 4];
        law.effort(&design, &[0.0, wound], &state, &mut efforts);
        let wanted = [4e-3 * tension, 12e-3 * tension, 4e-3 * tension, 12e-3 * tension];
        assert!(efforts.iter().zip(wanted).all(|(a, b)| (a - b).abs() < 1e-12), "{efforts:?} is not {wanted:?}");
    }
}
