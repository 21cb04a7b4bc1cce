//! The world of the hand: the physics of training's native tendons, a scripted grasp, and what is planted in it.

#![allow(clippy::unwrap_used)] // a panic is how a test fails

use hwasp_core::{Environment, Purpose, stream};
use hwasp_drivers::Pose;
use hwasp_emulators::hand::{Carry, HandWorldError, HandWorldSettings, Planted};
use hwasp_emulators::{HandWorld, SpoolDrive, SpoolState, World};
use hwasp_grasp::{Grasp, GraspSettings, Script, ShapeKind};
use hwasp_tasks::hand::{SEARCHED, TransmissionDescription};

/// Nothing is off, nothing pushes.
fn still(kind: ShapeKind) -> GraspSettings {
    let mut settings = GraspSettings {
        shapes: vec![kind],
        sensor_noise: [0.0; 2],
        actuation_noise: [0.0; 2],
        disturbance: [0.0; 2],
        ..GraspSettings::default()
    };
    settings.hand.transmission.tension_limit = TransmissionDescription::EASY;
    settings
}

fn world(kind: ShapeKind, carry: Carry, planted: Planted) -> HandWorld {
    // The arm stands on a table, turned by a right angle, and the palm hangs below its flange.
    let base = Pose { position: [0.5, -0.2, 0.1], rotation: [0.0, 0.0, std::f64::consts::FRAC_PI_2] };
    let settings =
        HandWorldSettings { grasp: still(kind), design: SEARCHED, base, palm: [0.0, 0.0, 0.05], carry, planted };
    HandWorld::new(settings).unwrap()
}

/// The tool that has the palm at this place of the world: pointing down, in the base of [`world`].
fn tool([x, y, z]: [f64; 3]) -> Pose {
    let [x, y, z] = [x - 0.5, y + 0.2, z - 0.1 + 0.05];
    Pose { position: [y, -x, z], rotation: [std::f64::consts::PI, 0.0, 0.0] }
}

fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

#[test]
fn the_palm_is_where_the_tool_is() {
    let world = world(ShapeKind::Box, Carry::Stiff, Planted::default());
    for place in [[0.0, 0.0, 0.3], [0.1, -0.05, 0.2]] {
        assert!(distance(&world.palm_at(&tool(place)), &place) < 1e-12);
    }
}

/// With nothing planted and the palm on training's compliant control, each step is that of `Grasp::native`.
#[test]
fn with_nothing_planted_the_physics_are_those_of_training() {
    for kind in [ShapeKind::Sphere, ShapeKind::Box] {
        let grasp = Grasp::native(still(kind), &SEARCHED).unwrap();
        let motor = grasp.settings().hand.transmission.clone();
        let most = motor.spool_radius * motor.tension_limit;
        let mut robot = grasp.robot(None);
        robot.set_design(&SEARCHED);
        robot.reset(&mut stream(3, Purpose::EvaluationReset, 0, 4));
        let mut world = world(kind, Carry::Compliant, Planted::default());
        let (object, start) = world.drawn(3, 4);
        assert_eq!((&object, start), (robot.plant().object(), robot.plant().palm()));
        world.put(object, &tool(start)).unwrap();
        let (mut script, mut palm, mut travel, mut largest) = (Script::default(), start, 0.0, [0.0_f64; 4]);
        script.start(robot.plant());
        for _ in 0..500 {
            let command = script.act(robot.plant(), &robot, most);
            robot.step(&[0.0; 7], &command);
            palm[2] += command[0];
            travel = (travel + command[1]).clamp(0.0, motor.travel);
            let drive =
                SpoolDrive::Position { goal: travel / motor.spool_radius, current: most / motor.torque_constant };
            let mut spool = SpoolState::default();
            for _ in 0..10 {
                spool = world.step(&tool(palm), drive);
            }
            let seen = world.look();
            assert_eq!(seen.fault, None);
            let plant = robot.plant();
            let joints = hwasp_tasks::hand::names::JOINTS
                .map(|name| plant.simulation().qpos()[plant.simulation().joint(name).unwrap().qpos.start]);
            largest[0] = largest[0].max(distance(&seen.palm, &plant.palm()));
            largest[1] = largest[1].max(distance(&seen.joints, &joints));
            largest[2] = largest[2].max(distance(&seen.object_pose[..3], &plant.object_position()));
            largest[3] = largest[3].max((spool.current * motor.torque_constant - plant.motor_torque()).abs());
        }
        assert!(largest.iter().all(|off| *off < 1e-6), "{kind:?}: {largest:?}");
        assert!(robot.outcome().unwrap().success && world.look().success, "{kind:?}");
    }
}

/// Down, wind, lift, at what a bench allows: 0.1 m/s and 20 mm of tendon a second. Returns the world and the most current.
fn grasp(kind: ShapeKind, planted: Planted) -> (HandWorld, f64) {
    let mut world = world(kind, Carry::Stiff, planted);
    let (object, mut palm) = world.drawn(0, 7);
    let low = (object.bounding_box()[2] + 0.005).max(0.1);
    world.put(object, &tool(palm)).unwrap();
    let radius = TransmissionDescription::default().spool_radius;
    let (mut wound, mut most, mut lifted, mut current) = (0.0_f64, 0.0_f64, None, 0.0);
    for ms in 0..7000 {
        let height = if lifted.is_some() { low + 0.17 } else { low };
        palm[2] += (height - palm[2]).clamp(-1e-4, 1e-4);
        if (palm[2] - low < 1e-9 || lifted.is_some()) && current < 0.999 {
            wound = (wound + 2e-5).min(0.045);
        }
        if lifted.is_none() && current > 0.97 {
            lifted = Some(ms);
        }
        let drive = SpoolDrive::Position { goal: wound / radius + planted.zero, current: 1.0 };
        current = world.step(&tool(palm), drive).current;
        most = most.max(current);
    }
    (world, most)
}

#[test]
fn a_scripted_motion_lifts_what_is_there() {
    for kind in ShapeKind::EACH {
        let (world, most) = grasp(kind, Planted::default());
        let seen = world.look();
        assert!(seen.success && seen.clearance > 0.1 && seen.fault.is_none(), "{kind:?}: {seen:?}");
        assert!((most - 1.0).abs() < 1e-9, "{kind:?}: {most} A");
        assert!((seen.tension - TransmissionDescription::EASY).abs() < 0.5, "{kind:?}: {} N", seen.tension);
    }
}

/// A weak motor pulls less with the same current; friction takes its part; slack is wound before anything is taut; the zero
/// is somewhere.
#[test]
fn what_is_planted_is_there() {
    let wanted = |factor: f64| factor * TransmissionDescription::default().torque_constant / 0.008;
    for (planted, tension, clearance) in [
        (Planted { torque_gain: 0.7, ..Planted::default() }, wanted(0.7), 0.1),
        (Planted { zero: 2.5, delay: 0.05, ..Planted::default() }, wanted(1.0), 0.1),
        (Planted { friction: 0.1, slack: 0.004, ..Planted::default() }, wanted(1.0) - 0.1 / 0.008, 0.1),
        (Planted { torque_gain: 0.01, ..Planted::default() }, wanted(0.01), -0.001),
    ] {
        let (world, most) = grasp(ShapeKind::Box, planted);
        let seen = world.look();
        assert!((most - 1.0).abs() < 1e-9, "{planted:?}: {most} A");
        // What the object does while it is lifted can pull by as much more as friction holds.
        let held = 0.99 * tension..=tension + 2.0 * planted.friction / 0.008 + 1e-6;
        assert!(held.contains(&seen.tension), "{planted:?}: {} N is not {held:?}", seen.tension);
        assert!(seen.clearance > clearance && seen.success == (clearance > 0.0), "{planted:?}: {seen:?}");
    }
}

/// Until it is taut nothing pulls: so much later as there is slack.
#[test]
fn slack_is_wound_first() {
    let onset = |slack: f64| {
        let mut world = world(ShapeKind::Sphere, Carry::Stiff, Planted { slack, ..Planted::default() });
        let high = tool([0.0, 0.0, 0.4]);
        (0..8000)
            .map(|ms| 1e-6 * f64::from(ms))
            .find(|wound| world.step(&high, SpoolDrive::Position { goal: wound / 0.008, current: 1.0 }).current > 0.01)
    };
    let (none, some) = (onset(0.0).unwrap(), onset(0.003).unwrap());
    assert!((some - none - 0.003).abs() < 2e-5, "{none} m and {some} m");
}

#[test]
fn what_cannot_be_planted_is_named() {
    let planted = Planted { friction: f64::NAN, ..Planted::default() };
    let settings = HandWorldSettings {
        grasp: still(ShapeKind::Box),
        design: SEARCHED,
        base: Pose::default(),
        palm: [0.0; 3],
        carry: Carry::Stiff,
        planted,
    };
    let error = HandWorld::new(settings).unwrap_err();
    assert!(matches!(error, HandWorldError::Planted { name: "friction", .. }));
    assert_eq!(error.to_string(), "friction = NaN is not 0 to 0.5 N·m");
}
