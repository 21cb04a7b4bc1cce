//! The driver of the arm against its emulator, over sockets.

mod bench;

use std::time::Duration;

use bench::{driven, pause, shifted, start, until};
use hwasp_drivers::ur::{Dashboard, Payload, UrArm};
use hwasp_drivers::{Arm, ArmMode, DriverError, Pose, Safety};
use hwasp_emulators::ur::Generation;

const BOTH: [Generation; 2] = [Generation::Cb3, Generation::ESeries];

#[test]
fn it_connects_and_reads_without_moving_anything() {
    for generation in BOTH {
        let (alone, settings) = start(generation);
        let mut arm = UrArm::connect(&settings).expect("an arm");
        let state = arm.state().expect("a state");
        assert_eq!((state.mode, state.safety), (ArmMode::Running, Safety::Normal));
        assert!(state.tool.distance(&alone.emulator().tool()) < 1e-5);
        assert!(state.joints.iter().zip(alone.emulator().joints()).all(|(a, b)| (a - b).abs() < 1e-6));
        let facts = arm.facts().expect("facts");
        let new = generation == Generation::ESeries;
        assert_eq!(facts.controller[0], if new { 5 } else { 3 });
        assert!(facts.polyscope.contains(if new { "5.11" } else { "3.15" }), "{}", facts.polyscope);
        assert_eq!(facts.remote, new.then_some(true));
        assert_eq!((facts.robot_mode.as_str(), facts.safety_mode.as_str()), ("RUNNING", "NORMAL"));
        assert!(facts.program_state.starts_with("STOPPED"), "{}", facts.program_state);
        assert!(facts.serial_number.is_some());
        // Without its program it does not follow.
        let refused = arm.servo(&state.tool).unwrap_err();
        assert!(refused.to_string().contains("its program does not run: start it"), "{refused}");
    }
}

#[test]
fn it_follows_poses_moves_straight_and_stops() {
    for generation in BOTH {
        let (alone, settings) = start(generation);
        let mut arm = driven(&settings);
        let begin = arm.state().expect("a state").tool;
        let mut target = begin;
        for step in 0..60 {
            target = shifted(&begin, 0.0005 * f64::from(step), -0.0005 * f64::from(step));
            arm.servo(&target).expect("followed");
            pause(8);
        }
        until(&alone, &mut arm, "it has arrived", |state| {
            state.as_ref().is_ok_and(|s| s.tool.distance(&target) < 0.01)
        });
        arm.stop().expect("stopped");
        until(&alone, &mut arm, "it stands", |state| state.as_ref().is_ok_and(|s| s.tool_speed == [0.0; 3]));
        arm.move_to(&begin, 0.1).expect("moved");
        assert!(arm.state().expect("a state").tool.distance(&begin) < 1e-4);
        assert!(alone.emulator().tool().distance(&begin) < 1e-4);
        assert_eq!(alone.emulator().messages(), [""; 0]);
        // Once more: an order after a move is a new one.
        arm.servo(&shifted(&begin, 0.01, 0.0)).expect("followed");
        until(&alone, &mut arm, "it goes on", |state| state.as_ref().is_ok_and(|s| s.tool_speed[0] > 0.01));
    }
}

#[test]
fn speeds_are_those_of_the_tool() {
    let (alone, settings) = start(Generation::Cb3);
    let mut arm = driven(&settings);
    let begin = arm.state().expect("a state").tool;
    let interrupt = arm.interrupt();
    let watch = std::thread::scope(|scope| {
        let watch = scope.spawn(|| {
            let mut fastest: f64 = 0.0;
            for _ in 0..200 {
                fastest = fastest.max(alone.emulator().tool_speed());
                pause(5);
            }
            interrupt.store(true, std::sync::atomic::Ordering::Relaxed);
            fastest
        });
        // 80 mm at 20 mm/s take 4 s: it is interrupted after one.
        let end = arm.move_to(&shifted(&begin, 0.0, -0.08), 0.02).unwrap_err();
        assert!(end.to_string().contains("it was interrupted"), "{end}");
        watch.join().expect("watched")
    });
    assert!((watch - 0.02).abs() < 1e-4, "{watch} m/s");
    until(&alone, &mut arm, "it stands", |state| state.as_ref().is_ok_and(|s| s.tool_speed == [0.0; 3]));
    let rest = alone.emulator().tool();
    assert!(arm.move_to(&begin, 0.05).is_err(), "not while it is interrupted");
    pause(50);
    assert_eq!(alone.emulator().tool(), rest);
    let way = rest.distance(&begin);
    assert!(way > 0.005 && way < 0.06, "{way} m");
    interrupt.store(false, std::sync::atomic::Ordering::Relaxed);
    arm.move_to(&begin, 0.1).expect("moved");
}

#[test]
fn without_a_heart_it_stands_and_does_not_begin_again() {
    let (alone, settings) = start(Generation::Cb3);
    let mut arm = driven(&settings);
    let begin = arm.state().expect("a state").tool;
    for step in 0..40 {
        arm.servo(&shifted(&begin, 0.001 * f64::from(step), 0.0)).expect("followed");
        pause(8);
    }
    let since = alone.emulator().clock();
    // Watchdog, two periods, and 0.1 s for what is left of the speed; by the emulator's own clock.
    while alone.emulator().clock() < since + 0.5 + 0.016 + 0.1 {
        pause(5);
    }
    assert_eq!(alone.emulator().tool_speed(), 0.0);
    let rest = alone.emulator().tool();
    let refused = arm.servo(&begin).unwrap_err();
    assert!(refused.to_string().contains("heard nothing for 500 ms"), "{refused}");
    assert!(arm.move_to(&begin, 0.05).is_err());
    pause(100);
    assert_eq!(alone.emulator().tool(), rest);
    // A person starts it again.
    arm.start().expect("its program");
    arm.move_to(&begin, 0.1).expect("moved");
}

#[test]
fn a_driver_that_is_gone_leaves_an_arm_that_stands() {
    let (alone, settings) = start(Generation::ESeries);
    let mut arm = driven(&settings);
    let begin = arm.state().expect("a state").tool;
    for step in 0..20 {
        arm.servo(&shifted(&begin, 0.001 * f64::from(step), 0.0)).expect("followed");
        pause(8);
    }
    drop(arm);
    let since = alone.emulator().clock();
    while alone.emulator().clock() < since + 0.7 {
        pause(5);
    }
    assert_eq!(alone.emulator().tool_speed(), 0.0);
    let mut next = UrArm::connect(&settings).expect("an arm");
    let rest = next.state().expect("a state").tool;
    next.start().expect("its program");
    pause(100);
    assert!(next.state().expect("a state").tool.distance(&rest) < 1e-5, "a new program begins with nothing");
}

#[test]
fn targets_that_are_no_targets_are_refused() {
    let (_alone, settings) = start(Generation::Cb3);
    let mut arm = driven(&settings);
    let begin = arm.state().expect("a state").tool;
    let told = |end: Result<(), DriverError>, word: &str| match end {
        Err(cause @ DriverError::Value { .. }) => assert!(cause.to_string().contains(word), "{cause}"),
        other => panic!("{other:?}"),
    };
    told(arm.servo(&Pose { position: [f64::NAN, 0.0, 0.3], ..begin }), "target x = NaN is not -0.85 to 0.85 m");
    told(arm.servo(&Pose { rotation: [0.0, f64::INFINITY, 0.0], ..begin }), "target ry = inf is not -7 to 7 rad");
    told(arm.servo(&Pose { position: [0.3, 0.1, -0.01], ..begin }), "target z = -0.01 is not 0 to 0.95 m");
    told(arm.servo(&shifted(&begin, 0.06, 0.0)), "distance of the target from the tool = 0.0");
    told(arm.servo(&Pose { rotation: [2.2, 2.2, 1.0], ..begin }), "turn of the target from the tool");
    told(arm.move_to(&shifted(&begin, 0.06, 0.0), 0.2), "speed = 0.2 is not 0.001 to 0.1 m/s");
    told(arm.move_to(&Pose { position: [2.0, 0.0, 0.3], ..begin }, 0.05), "target x = 2 is not");
    assert!(arm.state().expect("a state").tool.distance(&begin) < 1e-5, "nothing of it moved the arm");
}

#[test]
fn settings_that_cannot_be_are_told() {
    let (_alone, settings) = start(Generation::Cb3);
    let fast = UrArm::connect(&hwasp_drivers::ur::UrSettings { frequency: 500.0, ..settings.clone() }).unwrap_err();
    assert!(fast.to_string().contains("frequency = 500 is not 1 to 125: the controller's version is 3"), "{fast}");
    let soft = UrArm::connect(&hwasp_drivers::ur::UrSettings { gain: 10.0, ..settings }).unwrap_err();
    assert!(soft.to_string().contains("gain = 10 is not 100 to 2000"), "{soft}");
}

#[test]
fn tool_and_payload_are_told_back() {
    let (alone, mut settings) = start(Generation::Cb3);
    let flange = alone.emulator().tool();
    let tcp = Pose { position: [0.0, 0.0, 0.15], rotation: [0.0; 3] };
    settings.tcp = Some(tcp);
    settings.payload = Some(Payload { mass: 0.7, center: [0.0, 0.0, 0.05] });
    let mut arm = driven(&settings);
    let facts = arm.facts().expect("facts");
    assert_eq!((facts.tcp, facts.payload), (Some(tcp), Some(0.7)));
    assert!((arm.state().expect("a state").tool.distance(&flange) - 0.15).abs() < 1e-5);
    assert!(facts.program_state.starts_with("PLAYING hwasp_arm"), "{}", facts.program_state);
}

#[test]
fn two_drivers_do_not_drive_one_arm() {
    let (_alone, settings) = start(Generation::Cb3);
    let _first = driven(&settings);
    let second = UrArm::connect(&settings).unwrap_err();
    assert!(second.to_string().contains("input_int_register_36 is in use by another client"), "{second}");
}

#[test]
fn another_program_in_its_place_is_noticed() {
    let (alone, settings) = start(Generation::Cb3);
    let mut arm = driven(&settings);
    let begin = arm.state().expect("a state").tool;
    arm.servo(&begin).expect("followed");
    let mut line = std::net::TcpStream::connect(("127.0.0.1", settings.script_port)).expect("the port");
    let other = "def other():\n  while True:\n    sync()\n  end\nend\n";
    std::io::Write::write_all(&mut line, other.as_bytes()).expect("sent");
    let since = alone.emulator().clock();
    let refused = loop {
        match arm.servo(&begin) {
            Ok(()) => assert!(alone.emulator().clock() - since < 5.0, "still followed"),
            Err(cause) => break cause,
        }
        pause(8);
    };
    assert!(refused.to_string().contains("takes no orders: another one may play"), "{refused}");
}

#[test]
fn the_dashboard_unlocks_when_a_person_asks_and_not_at_once() {
    let (alone, settings) = start(Generation::ESeries);
    let mut dashboard = Dashboard::connect(&settings).expect("a dashboard");
    alone.emulator().inject("protective-stop").expect("a fault");
    assert_eq!(dashboard.safety_mode().expect("a mode"), "PROTECTIVE_STOP");
    let refused = dashboard.unlock_protective_stop().unwrap_err();
    assert!(refused.to_string().contains("until 5s after"), "{refused}");
    for _ in 0..5 {
        alone.emulator().advance(1.0);
    }
    dashboard.unlock_protective_stop().expect("unlocked");
    assert_eq!(dashboard.safety_mode().expect("a mode"), "NORMAL");
}

#[test]
fn nobody_there_is_told_in_time() {
    let (alone, mut settings) = start(Generation::Cb3);
    drop(alone);
    settings.answer = Duration::from_millis(500);
    let gone = UrArm::connect(&settings).unwrap_err();
    assert!(matches!(gone, DriverError::Line { what: "connecting to RTDE", .. }), "{gone}");
}
