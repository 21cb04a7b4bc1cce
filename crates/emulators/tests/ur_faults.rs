//! Each fault of the arm, and what the driver makes of it; times are by the emulator's clock.

mod bench;

use std::io::{Read, Write};
use std::net::TcpStream;

use bench::{driven, pause, shifted, start, until};
use hwasp_drivers::ur::UrArm;
use hwasp_drivers::{Arm, ArmMode, ArmState, DriverError, Safety};
use hwasp_emulators::ur::Generation;

/// A busy machine may let the test itself wait so long, s.
const SLACK: f64 = 1.5;

type State = Result<ArmState, DriverError>;

/// Orders a fault while the arm follows, waits for the state, and for the arm to stand within `stated`, s.
fn fault(generation: Generation, order: &str, stated: f64, expected: fn(&State) -> bool) {
    let (alone, settings) = start(generation);
    let mut arm = driven(&settings);
    let begin = arm.state().expect("a state").tool;
    for step in 0..30 {
        arm.servo(&shifted(&begin, 0.001 * f64::from(step), 0.0)).expect("followed");
        pause(8);
    }
    alone.emulator().inject(order).expect("a fault");
    let since = alone.emulator().clock();
    // Whoever drives goes on to order until the driver says no.
    let mut step = 30;
    let refused = loop {
        let tool = begin.position[0] + 0.001 * f64::from(step);
        let end = arm.servo(&hwasp_drivers::Pose { position: [tool, begin.position[1], begin.position[2]], ..begin });
        match end {
            Ok(()) => step += 1,
            Err(cause) => break cause,
        }
        let state = arm.state();
        if expected(&state) {
            break state.err().unwrap_or(DriverError::Timeout {
                device: String::new(),
                what: "",
                waited: settings.answer,
            });
        }
        assert!(alone.emulator().clock() - since < 10.0, "{order}: still followed, {state:?}");
        pause(8);
    };
    let took = alone.emulator().clock() - since;
    assert!(took < stated + SLACK, "{order}: {took} s until {refused}");
    until(&alone, &mut arm, order, expected);
    let _ = arm.stop();
    while alone.emulator().clock() < since + took + 0.75 {
        pause(5);
    }
    assert_eq!(alone.emulator().tool_speed(), 0.0, "{order}: it stands");
    // The fault is over: nothing goes on by itself.
    let rest = alone.emulator().tool();
    alone.emulator().inject("clear").expect("cleared");
    pause(100);
    assert_eq!(alone.emulator().tool(), rest, "{order}: it does not go on");
}

#[test]
fn protective_stop() {
    fault(Generation::Cb3, "protective-stop", 0.1, |state| {
        state.as_ref().is_ok_and(|state| state.safety == Safety::ProtectiveStop)
    });
}

#[test]
fn emergency_stop() {
    fault(Generation::ESeries, "emergency-stop", 0.1, |state| {
        state.as_ref().is_ok_and(|state| state.safety == Safety::EmergencyStop && state.mode == ArmMode::Off)
    });
}

#[test]
fn silence_is_a_state_that_is_too_old() {
    fault(Generation::Cb3, "silent", 0.4, |state| matches!(state, Err(DriverError::Timeout { what: "state", .. })));
}

#[test]
fn delay_beyond_the_oldest_is_a_state_that_is_too_old() {
    fault(Generation::ESeries, "delay 600", 0.6, |state| {
        matches!(state, Err(DriverError::Timeout { what: "state", .. }))
    });
}

#[test]
fn a_frozen_pose_is_noticed() {
    fault(
        Generation::Cb3,
        "freeze",
        0.2,
        |state| matches!(state, Err(cause @ DriverError::Protocol { .. }) if cause.to_string().contains("the same to the last bit")),
    );
}

#[test]
fn numbers_that_are_none_are_told() {
    fault(
        Generation::ESeries,
        "nan",
        0.1,
        |state| matches!(state, Err(cause @ DriverError::Protocol { .. }) if cause.to_string().contains("actual_TCP_pose is NaN")),
    );
}

#[test]
fn a_cut_line_is_told() {
    fault(Generation::Cb3, "cut", 0.1, |state| matches!(state, Err(DriverError::Line { .. })));
}

#[test]
fn closed_brakes_are_told() {
    fault(Generation::Cb3, "idle", 0.1, |state| state.as_ref().is_ok_and(|state| state.mode == ArmMode::Idle));
}

#[test]
fn lost_packets_and_small_delays_are_borne() {
    let (alone, settings) = start(Generation::Cb3);
    let mut arm = driven(&settings);
    let begin = arm.state().expect("a state").tool;
    alone.emulator().inject("drop 2").expect("a fault");
    alone.emulator().inject("delay 60").expect("a fault");
    let mut target = begin;
    for step in 0..60 {
        target = shifted(&begin, 0.0005 * f64::from(step), 0.0);
        arm.servo(&target).expect("followed");
        pause(8);
    }
    until(&alone, &mut arm, "it arrives", |state| {
        state.as_ref().is_ok_and(|state| state.tool.distance(&target) < 0.01)
    });
}

#[test]
fn local_control_refuses_programs() {
    let (alone, settings) = start(Generation::ESeries);
    alone.emulator().inject("not-remote").expect("a fault");
    let mut arm = UrArm::connect(&settings).expect("reading is allowed");
    let refused = arm.start().unwrap_err();
    assert!(refused.to_string().contains("switch its teach pendant to remote control"), "{refused}");
    // Whoever sends it all the same finds the port closed.
    let mut line = TcpStream::connect(("127.0.0.1", settings.script_port)).expect("the port");
    line.write_all(b"def a():\n  sync()\nend\n").expect("sent");
    assert!(matches!(line.read(&mut [0; 8]), Ok(0) | Err(_)));
}

#[test]
fn after_each_stop_it_starts_again_by_order_alone() {
    for order in ["protective-stop", "emergency-stop", "idle"] {
        let (alone, settings) = start(Generation::Cb3);
        let mut arm = driven(&settings);
        let begin = arm.state().expect("a state").tool;
        arm.servo(&begin).expect("followed");
        alone.emulator().inject(order).expect("a fault");
        until(&alone, &mut arm, order, |state| {
            state.as_ref().is_ok_and(|state| state.safety != Safety::Normal || state.mode != ArmMode::Running)
        });
        assert!(matches!(arm.start().unwrap_err(), DriverError::Refused { .. }), "{order}: not while it stands");
        alone.emulator().inject("clear").expect("cleared");
        until(&alone, &mut arm, "clear", |state| {
            state.as_ref().is_ok_and(|state| state.safety == Safety::Normal && state.mode == ArmMode::Running)
        });
        let refused = arm.servo(&begin).unwrap_err();
        assert!(refused.to_string().contains("start it again"), "{refused}");
        arm.start().expect("its program");
        arm.servo(&begin).expect("followed");
    }
}

#[test]
fn a_stop_ends_a_straight_move_with_its_reason() {
    let (alone, settings) = start(Generation::Cb3);
    let mut arm = driven(&settings);
    let begin = arm.state().expect("a state").tool;
    std::thread::scope(|scope| {
        scope.spawn(|| {
            while alone.emulator().tool_speed() < 0.015 {
                pause(2);
            }
            alone.emulator().inject("protective-stop").expect("a fault");
        });
        let refused = arm.move_to(&shifted(&begin, 0.0, -0.08), 0.02).unwrap_err();
        assert!(refused.to_string().contains("protective stop: look at the arm"), "{refused}");
    });
}

/// Bytes that are none of the protocol close a connection at most: the emulator serves the next.
#[test]
fn nonsense_at_its_ports_harms_nobody() {
    let (alone, settings) = start(Generation::Cb3);
    for port in [settings.rtde_port, settings.dashboard_port, settings.script_port] {
        for bytes in [
            &b"\0\0\0"[..],
            b"\0\x01U",
            b"\xff\xffU",
            &[0xff; 9000],
            b"end\nend\n",
            b"\0\x05V\0\x07",
            b"def a():\n((((\nend\n",
        ] {
            let mut line = TcpStream::connect(("127.0.0.1", port)).expect("the port");
            let _ = line.write_all(bytes);
            let _ = line.shutdown(std::net::Shutdown::Write);
            let _ = line.read(&mut [0; 64]);
        }
    }
    let begin = alone.emulator().tool();
    let mut arm = driven(&settings);
    arm.move_to(&shifted(&begin, 0.0, -0.01), 0.1).expect("moved");
}
