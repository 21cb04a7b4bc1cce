//! Grasping: the law against the engine's own tendons, what is randomised, what a controller by hand achieves, and faults.

#![allow(clippy::unwrap_used)] // a panic is how a test fails

use hwasp_core::{End, Environment, Purpose, Stream, check_env, stream};
use hwasp_grasp::{
    Grasp, GraspError, GraspPlant, GraspSettings, GraspTask, Inertia, Ramp, Script, ShapeKind, Viewpoint,
};
use hwasp_mujoco::engine::Simulation;
use hwasp_tasks::hand::{
    Drive, FreeClosing, HandDescription, MjcfOptions, PAPER_HWASP, PAPER_MINIMAL, SEARCHED, SMALL_CENTRE, TendonHand,
    TendonHandSettings, mjcf, names, urdf,
};
use rand::RngExt;

fn rng(episode: u64) -> Stream {
    stream(5, Purpose::Check, 0, episode)
}

fn settings(kind: ShapeKind) -> GraspSettings {
    GraspSettings { shapes: vec![kind], ..GraspSettings::default() }
}

fn bare(drive: Drive) -> Simulation {
    let options = MjcfOptions { drive, gravity: false, object: false };
    let hand = HandDescription::default();
    let mut sim = Simulation::from_mjcf(&mjcf(&hand, &options).unwrap()).unwrap();
    // The palm stays where it is, high above the floor.
    let height = sim.actuator(names::PALM_ACTUATORS[2]).unwrap().index();
    sim.ctrl_mut()[height] = hand.palm.home_height;
    sim
}

/// The generalised forces of springs and tendons in MuJoCo are the law's torques, to the last digits.
#[test]
fn the_law_is_the_engines_own_tendons() {
    let mut random = rng(0);
    for design in [SMALL_CENTRE, PAPER_HWASP, PAPER_MINIMAL] {
        let mut sim = bare(Drive::NativeTendon { design });
        let joints = names::JOINTS.map(|name| sim.joint(name).unwrap());
        let winches = names::TENDON_ACTUATORS.map(|name| sim.actuator(name).unwrap().index());
        let mut transmission = HandDescription::default().transmission;
        transmission.tension_limit = 1e6; // the engine's tendons know no limit
        let law = TendonHand::new(&transmission, &TendonHandSettings::default()).unwrap();
        let law = hwasp_core::Law::new(law);
        let mut largest = 0.0_f64;
        for _ in 0..200 {
            let mut state = [0.0; 7];
            state[0] = 0.02 * random.random::<f64>();
            for (angle, joint) in state[1..].iter_mut().zip(&joints) {
                *angle = 1.57 * random.random::<f64>();
                sim.qpos_mut()[joint.qpos.start] = *angle;
            }
            for winch in winches {
                sim.ctrl_mut()[winch] = state[0];
            }
            sim.forward().unwrap();
            let mut effort = [0.0; 7];
            law.effort(&design, &[0.0, 0.0], &state, &mut effort);
            for (joint, torque) in joints.iter().zip(effort) {
                let dof = joint.dof.start;
                largest = largest.max((sim.qfrc_actuator()[dof] + sim.qfrc_passive()[dof] - torque).abs());
            }
        }
        assert!(largest < 1e-12, "{largest} N·m");
    }
}

/// Without gravity and object the fingers come to rest where the closed form says. The slow mode takes seconds.
#[test]
fn free_closing_is_the_closed_form() {
    let hand = HandDescription::default();
    for design in [PAPER_HWASP, PAPER_MINIMAL] {
        for travel in [0.004, 0.008] {
            let mut sim = bare(Drive::NativeTendon { design });
            for name in names::TENDON_ACTUATORS {
                let winch = sim.actuator(name).unwrap().index();
                sim.ctrl_mut()[winch] = travel;
            }
            sim.step(12_000).unwrap();
            let angle = |name: &str| sim.qpos()[sim.joint(name).unwrap().qpos.start];
            let (thumb, finger) =
                (FreeClosing::thumb(&hand, &design, travel), FreeClosing::finger(&hand, &design, travel));
            for (name, wanted) in [
                ("thumb_proximal", thumb.angles[0]),
                ("thumb_distal", thumb.angles[1]),
                ("finger1_proximal", finger.angles[0]),
                ("finger2_distal", finger.angles[1]),
            ] {
                assert!((angle(name) - wanted).abs() < 0.02, "{name} at {travel} m: {} is not {wanted}", angle(name));
            }
        }
    }
}

/// The URDF has the links where the MJCF has them, with the same inertia: but for the armature, which it does not know, its
/// mass matrix is that of the joints.
#[test]
fn the_urdf_is_the_same_hand() {
    let hand = HandDescription::default();
    let mut urdf = Simulation::from_mjcf(&urdf(&hand, &SEARCHED).unwrap()).unwrap();
    let mut native = bare(Drive::NativeTendon { design: SEARCHED });
    let (n, palm_slides) = (names::JOINTS.len(), names::PALM_JOINTS.len());
    assert_eq!((urdf.qvel().len(), native.qvel().len()), (n, n + palm_slides));
    let mut random = rng(3);
    let mut largest = [0.0_f64; 3];
    for _ in 0..20 {
        for name in names::JOINTS {
            let angle = 1.57 * random.random::<f64>();
            for sim in [&mut urdf, &mut native] {
                let at = sim.joint(name).unwrap().qpos.start;
                sim.qpos_mut()[at] = angle;
            }
        }
        urdf.forward().unwrap();
        native.forward().unwrap();
        for name in names::LINK_BODIES {
            let (ours, theirs) = (native.body(name).unwrap(), urdf.body(name).unwrap());
            let place = native.body_position(ours).into_iter().zip([0.0, 0.0, hand.palm.home_height]);
            for ((ours, above), theirs) in place.zip(urdf.body_position(theirs)) {
                largest[0] = largest[0].max((ours - above - theirs).abs());
            }
            // A turn is a quaternion or its opposite.
            let turns = native.body_orientation(ours).into_iter().zip(urdf.body_orientation(theirs));
            largest[1] = largest[1].max(1.0 - turns.map(|(a, b)| a * b).sum::<f64>().abs());
        }
        let mut matrices = [vec![0.0; n * n], vec![0.0; (n + palm_slides) * (n + palm_slides)]];
        urdf.mass_matrix(&mut matrices[0]);
        native.mass_matrix(&mut matrices[1]);
        for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))) {
            let armature = if i == j { hand.joint.armature } else { 0.0 };
            let wanted = matrices[1][(i + palm_slides) * (n + palm_slides) + j + palm_slides] - armature;
            largest[2] = largest[2].max((matrices[0][i * n + j] - wanted).abs());
        }
    }
    assert!(largest[0] < 1e-12 && largest[1] < 1e-12 && largest[2] < 1e-15, "{largest:?} m, -, kg·m²");
}

#[test]
fn masses_and_stops_are_sane() {
    let mut sim = bare(Drive::JointTorque);
    let n = sim.qvel().len();
    assert_eq!(n, 9);
    sim.forward().unwrap();
    let mut matrix = vec![0.0; n * n];
    sim.mass_matrix(&mut matrix);
    for i in 0..n {
        assert!(matrix[i * n + i] > 1e-4 * 0.99 && matrix[i * n + i] < 1.2, "{}", matrix[i * n + i]);
        assert!((0..n).all(|j| (matrix[i * n + j] - matrix[j * n + i]).abs() < 1e-12));
    }
    // The open stop holds against the springs, the closed one against the motor.
    for (torque, from, to) in [(-0.06, -0.01, 0.01), (0.3, 1.56, 1.59)] {
        for name in names::TORQUE_ACTUATORS {
            let actuator = sim.actuator(name).unwrap().index();
            sim.ctrl_mut()[actuator] = torque;
        }
        sim.step(2000).unwrap();
        for name in names::JOINTS {
            let angle = sim.qpos()[sim.joint(name).unwrap().qpos.start];
            assert!((from..=to).contains(&angle), "{name}: {angle} rad at {torque} N·m");
        }
    }
}

/// Each range moves what it is about, and only that; with no width it gives its one value.
#[test]
fn every_randomised_quantity_changes_the_model() {
    type Change = (&'static str, fn(&mut GraspSettings), fn(&GraspPlant) -> f64);
    let changes: [Change; 8] = [
        ("size", |s| s.size = [0.05; 2], |p| p.object().size[0]),
        ("mass", |s| s.mass = [0.2; 2], |p| p.simulation().mass(p.simulation().body(names::OBJECT).unwrap())),
        (
            "friction",
            |s| s.friction = [0.8; 2],
            |p| p.simulation().friction(p.simulation().geom(names::OBJECT_GEOM).unwrap())[0],
        ),
        (
            "floor",
            |s| s.friction = [0.8; 2],
            |p| p.simulation().friction(p.simulation().geom(names::FLOOR).unwrap())[0],
        ),
        ("inertia", |s| s.inertia = Inertia::Independent([1e-3; 2]), |p| p.object().inertia[0]),
        ("height", |s| s.height = [0.2; 2], |p| p.palm()[2] - p.object().bounding_box()[2]),
        ("offset", |s| s.offset = 0.05, |p| p.object_position()[0]),
        ("yaw", |s| s.yaw = 0.5, |p| p.object().pose()[6]),
    ];
    for (name, change, look) in changes {
        let looks = |settings: GraspSettings| -> Vec<f64> {
            let mut robot = Grasp::new(settings).unwrap().robot(None);
            let mut look_after = |episode| {
                robot.reset(&mut rng(episode));
                look(robot.plant())
            };
            (0..6).map(&mut look_after).collect()
        };
        let base = settings(ShapeKind::Box);
        let mut changed = base.clone();
        change(&mut changed);
        let varies = |values: &[f64]| values.iter().any(|v| (v - values[0]).abs() > 1e-9);
        let widened = matches!(name, "offset" | "yaw");
        assert_eq!((varies(&looks(base)), varies(&looks(changed))), (!widened, widened), "{name}");
    }
}

/// Offset and load change evenly between two fractions of training; who says nothing of training gets what comes last.
#[test]
fn what_changes_while_training_goes_on() {
    let ramp = |first, last| Some(Ramp { first, last, progress: [0.2, 0.6] });
    let settings = GraspSettings {
        offset: 0.05,
        offset_ramp: ramp(0.01, 0.05),
        load_ramp: ramp(1.0, 1.5),
        ..settings(ShapeKind::Box)
    };
    let mut robot = Grasp::new(settings).unwrap().robot(None);
    let mut start = |progress: Option<f64>| {
        if let Some(progress) = progress {
            robot.set_progress(progress);
        }
        robot.reset(&mut rng(3));
        (robot.plant().object_position()[0], robot.plant().object().mass)
    };
    let (place, mass) = start(None);
    for (progress, offset, load) in [(0.0, 0.01, 1.0), (0.2, 0.01, 1.0), (0.3, 0.02, 1.125), (1.0, 0.05, 1.5)] {
        let found = start(Some(progress));
        let wanted = (place * offset / 0.05, mass * load / 1.5);
        assert!((found.0 - wanted.0).abs() < 1e-12 && (found.1 - wanted.1).abs() < 1e-12, "{found:?} for {wanted:?}");
    }
    assert!(place != 0.0 && mass > 0.15);
}

/// Seen from the palm, the object is where the difference of both sensors says.
#[test]
fn the_object_seen_from_the_palm() {
    let seen = |viewpoint| {
        let settings = GraspSettings { viewpoint, offset: 0.05, ..settings(ShapeKind::Box) };
        let mut robot = Grasp::new(settings).unwrap().robot(None);
        robot.reset(&mut rng(1));
        let mut seen = [0.0; 11];
        robot.observe(&mut seen);
        seen
    };
    let mut wanted = seen(Viewpoint::World);
    for i in 0..3 {
        wanted[3 + i] -= wanted[i];
    }
    assert_eq!(seen(Viewpoint::Palm), wanted);
    assert!(wanted[3].abs() > 0.005 && wanted[5] < -0.1, "{wanted:?}");
}

/// Noise and disturbances are there, and can be switched off.
#[test]
fn noise_can_be_switched_off() {
    let episode = |settings: &GraspSettings| {
        let mut robot = Grasp::new(settings.clone()).unwrap().robot(None);
        robot.reset(&mut rng(0));
        let mut seen = [0.0; 11];
        for _ in 0..20 {
            robot.step(&[0.0; 7], &[-0.001, 0.0]);
        }
        robot.observe(&mut seen);
        (seen, robot.plant().palm())
    };
    let noisy = settings(ShapeKind::Sphere);
    let silent = GraspSettings {
        sensor_noise: [0.0; 2],
        actuation_noise: [0.0; 2],
        disturbance: [0.0; 2],
        ..settings(ShapeKind::Sphere)
    };
    let (seen, palm) = episode(&noisy);
    assert!((seen[2] - palm[2]).abs() > 1e-6, "sensors are off by something");
    let (seen_silent, palm_silent) = episode(&silent);
    assert!((seen_silent[2] - palm_silent[2]).abs() < 1e-15 && seen_silent[9].abs() < 1e-15);
    assert!((palm[2] - palm_silent[2]).abs() > 1e-6, "actuators are off by something");
    assert!(seen_silent[0].abs() < 1e-6, "nothing pushes the palm aside: {}", seen_silent[0]);
}

/// A good design with a strong motor grasps and lifts every shape, by the law and by the engine's own tendons.
#[test]
fn the_script_grasps_every_shape() {
    for &(_, kind) in ShapeKind::ALL {
        let mut settings = settings(kind);
        settings.hand.transmission.tension_limit = 163.0;
        for grasp in [Grasp::new(settings.clone()).unwrap(), Grasp::native(settings, &SEARCHED).unwrap()] {
            let mut robot = grasp.robot(None);
            let (total, end) = Script::default().play(&mut robot, &grasp, &SEARCHED, &mut rng(1));
            assert_eq!(end, End::Truncated);
            let outcome = robot.outcome().unwrap();
            assert_eq!((&*outcome.kind, outcome.success), (kind.name(), true), "return {total}");
            assert!(total > 500.0 && robot.plant().clearance() > 0.1, "{kind:?}: {total}");
            // Thumb and both fingers hold it.
            let touching = robot.plant().touching();
            assert!((0..3).all(|digit| touching[2 * digit] || touching[2 * digit + 1]), "{kind:?}: {touching:?}");
        }
    }
}

/// A hand that does nothing succeeds at nothing and is punished for its distance.
#[test]
fn doing_nothing_is_no_success() {
    let grasp = Grasp::new(settings(ShapeKind::Box)).unwrap();
    let mut robot = grasp.robot(None);
    robot.reset(&mut rng(3));
    let mut total = 0.0;
    loop {
        let step = robot.step(&[-0.01, -0.01, -0.01, -0.01, -0.01, -0.01, 0.0], &[0.0, 0.0]);
        total += step.reward;
        if step.end.is_some() {
            break;
        }
    }
    assert!((-320.0..-170.0).contains(&total), "{total}");
    assert!(!robot.outcome().unwrap().success && !robot.plant().touching().contains(&true));
}

/// What is paid for coming nearer adds up to how much nearer the palm is at the end.
#[test]
fn training_can_pay_for_approach() {
    let play = |approach: f64| {
        let mut settings = GraspSettings { offset: 0.02, ..settings(ShapeKind::Sphere) };
        settings.reward.approach = approach;
        let grasp = Grasp::new(settings).unwrap();
        let mut robot = grasp.robot(None);
        let beside = |robot: &hwasp_core::Robot<GraspTask>| {
            let (palm, object) = (robot.plant().palm(), robot.plant().object_position());
            (palm[0] - object[0]).hypot(palm[1] - object[1])
        };
        robot.reset(&mut rng(1));
        let before = beside(&robot);
        let (total, _) = Script::default().play(&mut robot, &grasp, &SEARCHED, &mut rng(1));
        (total, before - beside(&robot))
    };
    let ((without, _), (with, nearer)) = (play(0.0), play(300.0));
    assert!((with - without - 300.0 * nearer).abs() < 1e-9, "{with} - {without} is not 300 times {nearer}");
    assert!(nearer.abs() > 1e-4, "{nearer}");
}

/// What a baseline may be told is the object that is there, by the names of the ports.
#[test]
fn the_context_is_the_object() {
    let mut robot = Grasp::new(settings(ShapeKind::Cylinder)).unwrap().robot(None);
    let names: Vec<String> = robot.spec().context.iter().map(|port| port.name.clone()).collect();
    for seed in 0..3 {
        robot.reset(&mut rng(seed));
        let mut about = vec![f64::NAN; names.len()];
        robot.context(&mut about);
        let told = |name: &str| about[names.iter().position(|n| n == name).unwrap()];
        let object = robot.plant().object();
        assert_eq!([told("mass"), told("friction")], [object.mass, object.friction]);
        assert_eq!(["inertia_x", "inertia_y", "inertia_z"].map(told), object.inertia);
        for &(name, kind) in ShapeKind::ALL {
            assert_eq!(told(name), f64::from(kind == object.kind), "{name}");
        }
    }
}

#[test]
fn the_environment_keeps_its_promises() {
    for palm in [hwasp_tasks::hand::PalmMotion::Vertical, hwasp_tasks::hand::PalmMotion::Spatial] {
        let settings = GraspSettings { palm, horizon: 40, offset: 0.02, ..GraspSettings::default() };
        let grasp = Grasp::new(settings).unwrap();
        let law = grasp.law();
        check_env(&grasp, &law, false).unwrap();
    }
}

/// Torques that are no numbers end the episode as a fault that says what happened; the next episode is sound.
#[test]
fn a_poisoned_state_is_caught() {
    let mut robot = Grasp::new(settings(ShapeKind::Sphere)).unwrap().robot(None);
    robot.reset(&mut rng(0));
    let step = robot.step(&[1e300; 7], &[0.0, 0.0]);
    assert_eq!(step.end, Some(End::Faulted));
    let fault = robot.fault().unwrap();
    assert!(fault.starts_with("the physics broke down at 0"), "{fault}");
    robot.reset(&mut rng(0));
    assert_eq!(robot.step(&[0.0; 7], &[0.0, 0.0]).end, None);
}

#[test]
fn settings_that_make_no_task_are_named() {
    let refused = |change: fn(&mut GraspSettings)| {
        let mut settings = GraspSettings::default();
        change(&mut settings);
        Grasp::new(settings).unwrap_err()
    };
    assert!(matches!(refused(|s| s.shapes.clear()), GraspError::Setting { name: "shapes", .. }));
    assert!(matches!(refused(|s| s.mass = [0.5, 0.1]), GraspError::Setting { name: "mass", .. }));
    assert!(matches!(refused(|s| s.disturbance[0] = f64::NAN), GraspError::Setting { name: "disturbance[0]", .. }));
    let error = refused(|s| s.size = [0.0, 0.1]).to_string();
    assert_eq!(error, "size = 0 to 0.1 is not a range of positive finite numbers, the smaller one first");
}
