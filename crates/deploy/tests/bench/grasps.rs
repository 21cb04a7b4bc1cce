//! The shipped controller over the doubles: what it sees is what was sensed, and a step allocates nothing.

use std::path::Path;
use std::sync::{Arc, Mutex};
use std::time::Duration;

use hwasp_deploy::controller::{Controller, Sensed, Training};
use hwasp_deploy::drive::{Bench, Drive, Finish, Grasp, GraspTold, Manner};
use hwasp_deploy::object::{Object, ObjectKnown};
use hwasp_deploy::record::{NoSink, Phase};
use hwasp_deploy::run::{OnTheTable, Placed, Plan, run};
use hwasp_export::Deployed;
use hwasp_tasks::grasp::CarriedObject;

use super::doubles::{FakeArm, FakeMotor, Fault, Kept, VirtualClock, world};

pub(crate) fn deployed(run: &str) -> Deployed {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../results").join(run);
    Deployed::open(&path, &hwasp_builtin::catalogue()).unwrap()
}

const PLACED: Placed = Placed { size: [0.06, 0.06, 0.08], place: [0.0, 0.0, 0.04], shape: None, start: None };

/// The same numbers to the controller here and to the one that `hwasp export` writes.
#[test]
fn it_says_what_the_exported_controller_says() {
    for name in ["z-grasp", "3d-grasp"] {
        let deployed = deployed(name);
        let training = Training::of(deployed.spec()).unwrap();
        let mut controller = Controller::new(&deployed, &training).unwrap();
        let sensed = Sensed {
            palm: [0.01, -0.02, 0.2],
            object: [0.0, 0.01, 0.04],
            size: [0.06, 0.05, 0.08],
            travel: 0.012,
            torque: 0.2,
            travel_target: 0.014,
        };
        controller.act(&sensed);
        let seen: Vec<f32> = controller.observation().iter().map(|&x| x as f32).collect();
        assert_eq!(seen.len(), deployed.env().observation.len());
        let [palm, travel] = ["palm_z", "motor_travel"]
            .map(|name| deployed.env().observation.iter().position(|port| port.name == name).unwrap());
        assert_eq!((controller.observation()[palm], controller.observation()[travel]), (0.2, 0.012));
        // Observations are f64 here and f32 there.
        let said = deployed.commands(&seen);
        assert_eq!(said.len(), controller.command().len());
        for (here, there) in controller.command().iter().zip(&said) {
            assert!((here - there).abs() < 1e-6 * (1.0 + there.abs()), "{here}, {there}");
        }
        assert_eq!(controller.spatial(), name == "3d-grasp");
    }
}

#[test]
fn what_is_no_number_stays_none() {
    let deployed = deployed("z-grasp");
    let training = Training::of(deployed.spec()).unwrap();
    let mut controller = Controller::new(&deployed, &training).unwrap();
    controller.act(&Sensed { torque: f64::NAN, ..Sensed::default() });
    assert!(controller.command().iter().all(|x| x.is_nan()), "{:?}", controller.command());
}

#[test]
fn episodes_begin_above_the_object_and_end_on_the_table() {
    let deployed = deployed("z-grasp");
    let training = Training::of(deployed.spec()).unwrap();
    let mut controller = Controller::new(&deployed, &training).unwrap();
    let world = world(Fault::None, Duration::ZERO);
    let (events, steps) = (Arc::default(), Arc::new(Mutex::new(Vec::new())));
    let mut sink = Kept { world: Arc::clone(&world), events, steps: Arc::clone(&steps) };
    let (mut arm, mut motor) = (FakeArm(Arc::clone(&world)), FakeMotor(Arc::clone(&world)));
    let (clock, interrupts) = (VirtualClock(Arc::clone(&world)), Arc::clone(&world.lock().unwrap().interrupts));
    let (rig, spool) = {
        let world = world.lock().unwrap();
        (world.rig.clone(), world.spool)
    };
    let bench = Bench { arm: &mut arm, motor: &mut motor, clock: &clock, interrupts: &interrupts, sink: &mut sink };
    let mut drive = Drive::new(bench, Manner::new(&rig, spool, 0.01, 0.0002));
    let plan = Plan::new(2, ObjectKnown::Carried, deployed.env(), training);
    let episodes = run(&mut drive, &mut controller, &plan, &mut OnTheTable(PLACED), &mut |_| ()).unwrap();
    assert_eq!(episodes.len(), 2);
    assert!(episodes.iter().all(|episode| episode.ended.is_none() && episode.felt), "{episodes:?}");
    let steps = steps.lock().unwrap();
    for episode in 0..2 {
        let acted: Vec<_> = steps.iter().filter(|step| step.phase == Phase::Grasp && step.episode == episode).collect();
        assert_eq!(acted.len(), 500);
        // 200 mm above an object of 80 mm: the middle of what it was trained with.
        assert!((acted[0].palm[2] - 0.28).abs() < 0.003, "{:?}", acted[0].palm);
        let (lowest, last) = (acted.iter().map(|step| step.palm[2]).fold(1.0, f64::min), acted[499].palm[2]);
        assert!(last > lowest + 0.1, "it went down to {lowest} m and is at {last} m in the end");
        // Steps of at most a millimetre: 0.1 m/s.
        for pair in acted.windows(2) {
            assert!((pair[1].palm_target[2] - pair[0].palm_target[2]).abs() < 1.001e-3);
        }
        // The goal of the spool does not run away from it.
        assert!(acted.iter().all(|step| step.goal <= step.wound.max(0.0) + rig.limits.lead + 1e-9));
    }
    // After the last episode the hand is open and free.
    let world = world.lock().unwrap();
    assert!(!world.torque && world.wound < 2e-3, "{} m", world.wound);
}

#[test]
fn a_step_allocates_nothing() {
    let deployed = deployed("z-grasp");
    let training = Training::of(deployed.spec()).unwrap();
    let mut controller = Controller::new(&deployed, &training).unwrap();
    let world = world(Fault::None, Duration::ZERO);
    let (mut arm, mut motor) = (FakeArm(Arc::clone(&world)), FakeMotor(Arc::clone(&world)));
    let (clock, interrupts) = (VirtualClock(Arc::clone(&world)), Arc::clone(&world.lock().unwrap().interrupts));
    let (rig, spool) = {
        let world = world.lock().unwrap();
        (world.rig.clone(), world.spool)
    };
    let mut sink = NoSink;
    let bench = Bench { arm: &mut arm, motor: &mut motor, clock: &clock, interrupts: &interrupts, sink: &mut sink };
    let mut drive = Drive::new(bench, Manner::new(&rig, spool, 0.01, 0.0002));
    drive.grip().unwrap();
    let object = Object::Carried(CarriedObject::new(PLACED.place, 0.3));
    let told = GraspTold { object, size: PLACED.size, encoder: false, felt_at: 0.3, steps: 200 };
    let mut grasp = Grasp::new(&mut controller, told);
    let counted = allocation_counter::measure(|| assert_eq!(drive.run(&mut grasp), Finish::Done));
    assert_eq!(counted.count_total, 0, "{counted:?}");
}
