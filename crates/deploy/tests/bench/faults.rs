//! Faults in virtual time: each ends in the stated state within the stated time.

use std::sync::atomic::Ordering;
use std::sync::{Arc, Mutex};
use std::time::Duration;

use hwasp_deploy::drive::{Bench, Drive, Finish, Manner, Motion, Progress, Senses};
use hwasp_deploy::record::{Event, Phase};
use hwasp_deploy::safety::{Cause, Response, Verdict, reaction};
use hwasp_tasks::grasp::Targets;

use super::doubles::{FakeArm, FakeMotor, Fault, Kept, VirtualClock, world};

const ONSET: Duration = Duration::from_millis(1500);
const STEP: Duration = Duration::from_millis(10);

/// Down, wind, up: what a grasp does, without a controller.
struct Scripted {
    taken: u32,
    nan_at: Option<u32>,
}

impl Motion for Scripted {
    fn phase(&self) -> Phase {
        Phase::Grasp
    }

    fn step(&mut self, _: &Senses, targets: &mut Targets, _: &Manner) -> Progress {
        self.taken += 1;
        if self.nan_at == Some(self.taken) {
            targets.palm = [f64::NAN; 3];
            return Progress::NotFinite { controller: true };
        }
        match self.taken {
            ..100 => targets.advance([0.0, 0.0, -0.002], 0.0),
            100..250 => targets.advance([0.0; 3], 0.0002),
            250..400 => targets.advance([0.0, 0.0, 0.002], 0.0001),
            _ => return Progress::Done,
        }
        Progress::Going
    }

    fn lowest(&self) -> Option<f64> {
        Some(0.2)
    }
}

/// What a run under a fault came to.
struct Outcome {
    finish: Finish,
    /// From the fault to the decision, and to the arm's stop and the motor's freedom.
    decided: Option<(Duration, Response, Cause)>,
    stopped: Option<Duration>,
    freed: Option<Duration>,
    holding: bool,
    last_phase: Option<Phase>,
    height: f64,
    events: Vec<(f64, Event)>,
}

fn run(fault: Fault, nan_at: Option<u32>, hold: Duration) -> Outcome {
    let world = world(fault, ONSET);
    let (events, steps) = (Arc::new(Mutex::new(Vec::new())), Arc::new(Mutex::new(Vec::new())));
    let mut sink = Kept { world: Arc::clone(&world), events: Arc::clone(&events), steps: Arc::clone(&steps) };
    let (mut arm, mut motor) = (FakeArm(Arc::clone(&world)), FakeMotor(Arc::clone(&world)));
    let (clock, interrupts) = (VirtualClock(Arc::clone(&world)), Arc::clone(&world.lock().unwrap().interrupts));
    let (rig, spool) = {
        let world = world.lock().unwrap();
        (world.rig.clone(), world.spool)
    };
    let manner = Manner { hold, ..Manner::new(&rig, spool, 0.01, 0.0002) };
    let bench = Bench { arm: &mut arm, motor: &mut motor, clock: &clock, interrupts: &interrupts, sink: &mut sink };
    let mut drive = Drive::new(bench, manner);
    drive.grip().unwrap();
    let finish = drive.run(&mut Scripted { taken: 0, nan_at });
    let events = events.lock().unwrap().clone();
    let onset = if nan_at.is_some() { Duration::from_millis(1490) } else { ONSET };
    let since = |time: f64| Duration::from_secs_f64(time).saturating_sub(onset);
    let decided = events.iter().find_map(|(time, event)| match event {
        Event::Decided(response, cause) => Some((since(*time), *response, *cause)),
        _ => None,
    });
    let world = world.lock().unwrap();
    Outcome {
        finish,
        decided,
        stopped: world.stopped_at.map(|at| at.saturating_sub(onset)),
        freed: world.freed_at.map(|at| at.saturating_sub(onset)),
        holding: world.torque,
        last_phase: steps.lock().unwrap().last().map(|step| step.phase),
        height: world.palm[2],
        events,
    }
}

/// The faults, each with what is found and what is done about it.
const FAULTS: [(&str, Fault, Cause); 26] = [
    ("the arm falls silent", Fault::ArmSilent, Cause::ArmStale),
    ("the arm's cable is cut", Fault::ArmCut, Cause::ArmLost),
    ("the arm's packets repeat themselves", Fault::ArmFrozen, Cause::ArmFrozen),
    ("the arm's packets are late", Fault::ArmLate(60), Cause::ArmStale),
    ("protective stop", Fault::Protective, Cause::ProtectiveStop),
    ("emergency stop", Fault::Emergency, Cause::EmergencyStop),
    ("another stop by the arm", Fault::SafetyStop, Cause::ArmStopped),
    ("the arm's brakes close", Fault::ArmIdle, Cause::ArmNotRunning),
    ("the arm says NaN", Fault::ArmNan, Cause::SensorNotFinite),
    ("the palm leaves the workspace", Fault::ArmOutside, Cause::Workspace),
    ("the palm races", Fault::ArmFast(0.3), Cause::Speed),
    ("the motor falls silent", Fault::MotorSilent, Cause::MotorStale),
    ("the motor's cable is cut", Fault::MotorCut, Cause::MotorLost),
    ("every checksum is wrong", Fault::WrongCrc(1), Cause::MotorStale),
    ("the motor answers late", Fault::MotorLate(80), Cause::MotorStale),
    ("the position register is stuck", Fault::StuckRegister, Cause::MotorStuck),
    ("the motor says NaN", Fault::MotorNan, Cause::SensorNotFinite),
    ("over-current", Fault::Current(1.3, 9.0), Cause::OverCurrent),
    ("over-current the other way", Fault::Current(-1.3, 9.0), Cause::OverCurrent),
    ("heat", Fault::Heat(71.0), Cause::Heat),
    ("the supply breaks down", Fault::Voltage(7.0), Cause::Voltage),
    ("a hardware error", Fault::HardwareError(0x20), Cause::HardwareError),
    ("the motor's torque is off", Fault::MotorFree, Cause::MotorFree),
    ("the motor's position jumps", Fault::Jump(-0.06), Cause::Travel),
    ("full disk", Fault::FullDisk, Cause::LogLost),
    ("the computer hangs", Fault::Overrun(45), Cause::Overrun),
];

#[test]
fn each_fault_ends_in_the_stated_state_in_the_stated_time() {
    for (name, fault, cause) in FAULTS {
        let outcome = run(fault, None, Duration::from_secs(2));
        let (after, response, found) = outcome.decided.unwrap_or_else(|| panic!("{name}: nothing was decided"));
        assert_eq!((found, response), (cause, cause.response()), "{name}");
        let limits = hwasp_deploy::safety::Limits::of(&hwasp_deploy::rig::Rig::default(), 0.045, 0.46);
        // The hang itself is what has to be noticed, and it lasts.
        let lasts = if let Fault::Overrun(ms) = fault { Duration::from_millis(ms) } else { Duration::ZERO };
        // Delayed data are as old as that at once: the rule finds what was true then.
        let stated = reaction(cause, &limits, STEP) + lasts;
        assert!(after <= stated, "{name}: {after:?} after it, stated {stated:?}");
        assert!(
            matches!(outcome.finish, Finish::Ended(Verdict { cause: Some(kept), .. }) if kept == cause),
            "{name}: {:?}",
            outcome.finish
        );
        safe(name, fault, &outcome, response, stated);
    }
}

/// The state that a response leaves.
fn safe(name: &str, fault: Fault, outcome: &Outcome, response: Response, stated: Duration) {
    let cut = matches!(fault, Fault::MotorCut | Fault::MotorSilent);
    match response {
        Response::SetDown => {
            assert!(outcome.stopped.is_none(), "{name}: the arm goes down, it is not stopped");
            assert!(outcome.height < 0.201, "{name}: the palm is at {} m", outcome.height);
            assert!(outcome.events.iter().any(|(_, event)| *event == Event::Down), "{name}");
            assert!(!outcome.holding && outcome.last_phase == Some(Phase::SetDown), "{name}");
        }
        Response::StopArm => {
            // A cut arm hears no stop: its own program notices that nobody speaks.
            if fault != Fault::ArmCut {
                assert!(outcome.stopped.is_some_and(|after| after <= stated), "{name}: {:?}", outcome.stopped);
            }
            if !cut {
                // The motor held for the time that was set, and was freed then.
                let freed = outcome.freed.unwrap_or_else(|| panic!("{name}: it holds for ever"));
                let held = freed.saturating_sub(outcome.decided.unwrap().0);
                assert!(
                    held >= Duration::from_millis(1980) && held <= Duration::from_millis(2030),
                    "{name}: held {held:?}"
                );
                assert_eq!(outcome.last_phase, Some(Phase::Held), "{name}");
            }
        }
        Response::Release => {
            assert!(outcome.stopped.is_some_and(|after| after <= stated), "{name}");
            assert!(
                outcome.freed.is_some_and(|after| after <= stated) && !outcome.holding,
                "{name}: {:?}",
                outcome.freed
            );
        }
        Response::GoOn | Response::Hold => panic!("{name}: {response} ends nothing"),
    }
}

#[test]
fn what_passes_is_borne() {
    for (name, fault) in [
        ("nothing", Fault::None),
        ("one checksum in five is wrong", Fault::WrongCrc(5)),
        ("over-current for 0.3 s", Fault::Current(1.5, 0.3)),
        ("the arm's packets are 30 ms late", Fault::ArmLate(30)),
        ("the motor answers 30 ms late", Fault::MotorLate(30)),
        ("one packet says that the arm is fast", Fault::ArmFastOnce),
        ("a step begins 20 ms late", Fault::Overrun(20)),
    ] {
        let outcome = run(fault, None, Duration::ZERO);
        assert_eq!(outcome.finish, Finish::Done, "{name}: {:?}", outcome.decided);
        assert!(outcome.stopped.is_none() && outcome.holding, "{name}");
    }
}

#[test]
fn an_arm_that_does_not_follow_is_stopped() {
    // It stands from the beginning; the target leaves it by 30 mm after 0.3 s at 0.1 m/s.
    let outcome = run(Fault::ArmStays, None, Duration::ZERO);
    // By the onset the palm winds and stays; it is found when the palm should rise.
    let (_, response, cause) = outcome.decided.unwrap();
    assert_eq!((response, cause), (Response::StopArm, Cause::Following));
    assert!(outcome.stopped.is_some());
}

#[test]
fn a_command_that_is_no_number_is_not_obeyed() {
    let outcome = run(Fault::None, Some(150), Duration::ZERO);
    let (after, response, cause) = outcome.decided.unwrap();
    assert_eq!((response, cause), (Response::StopArm, Cause::CommandNotFinite));
    assert!(after <= STEP && outcome.stopped.unwrap() <= STEP, "{after:?} {:?}", outcome.stopped);
    assert!(outcome.height.is_finite());
}

#[test]
fn a_person_is_obeyed() {
    let outcome = run(Fault::Interrupt, None, Duration::from_secs(9));
    assert!(matches!(outcome.decided, Some((after, Response::SetDown, Cause::Interrupt)) if after <= STEP));
    safe("Ctrl-C", Fault::Interrupt, &outcome, Response::SetDown, STEP);
    let outcome = run(Fault::InterruptTwice, None, Duration::from_secs(9));
    assert!(matches!(outcome.decided, Some((after, Response::Release, Cause::InterruptTwice)) if after <= STEP));
    safe("Ctrl-C twice", Fault::InterruptTwice, &outcome, Response::Release, STEP);
}

/// A protective stop that somebody unlocks while the motor holds: the arm stays where it is.
#[test]
fn a_protective_stop_never_resumes_by_itself() {
    let world = world(Fault::Protective, ONSET);
    let (events, steps) = (Arc::default(), Arc::default());
    let mut sink = Kept { world: Arc::clone(&world), events, steps };
    let (mut arm, mut motor) = (FakeArm(Arc::clone(&world)), FakeMotor(Arc::clone(&world)));
    let (clock, interrupts) = (VirtualClock(Arc::clone(&world)), Arc::clone(&world.lock().unwrap().interrupts));
    let (rig, spool) = {
        let world = world.lock().unwrap();
        (world.rig.clone(), world.spool)
    };
    let manner = Manner { hold: Duration::from_secs(1), ..Manner::new(&rig, spool, 0.01, 0.0002) };
    let bench = Bench { arm: &mut arm, motor: &mut motor, clock: &clock, interrupts: &interrupts, sink: &mut sink };
    let mut drive = Drive::new(bench, manner);
    drive.grip().unwrap();
    drive.run(&mut Scripted { taken: 0, nan_at: None });
    world.lock().unwrap().fault = Fault::None;
    let servos = world.lock().unwrap().servos;
    let again = drive.run(&mut Scripted { taken: 0, nan_at: None });
    assert!(matches!(again, Finish::Ended(Verdict { cause: Some(Cause::ProtectiveStop), .. })), "{again:?}");
    assert_eq!(world.lock().unwrap().servos, servos);
    assert_eq!(interrupts.load(Ordering::Relaxed), 0);
}
