//! The driver of the motor and its emulator, which know nothing of each other, over a serial line.

#![allow(clippy::unwrap_used)] // a panic is how a test fails

mod common;

use std::f64::consts::TAU;

use common::{Bench, until};
use hwasp_drivers::dynamixel::{DynamixelIdentity, XM430_W210};
use hwasp_drivers::{DriverError, Dynamixel, DynamixelSettings, Motor, MotorState, Pose};
use hwasp_emulators::{DynamixelEmulator, FreeSpool, STEP, SpoolDrive, SpoolState, World};

const TICK: f64 = TAU / 4096.0;

#[test]
fn a_new_motor_is_prepared_once() {
    let bench = Bench::start();
    let mut motor = Dynamixel::open(bench.settings()).unwrap();
    assert_eq!(motor.identify().unwrap(), DynamixelIdentity { model: XM430_W210, firmware: 47 });
    let refused = motor.torque(true).unwrap_err().to_string();
    assert!(refused.contains("switching torque on was refused: it is not prepared"), "{refused}");
    assert!(motor.state().unwrap_err().to_string().contains("it was not prepared, or its power failed"));
    let changed = motor.prepare().unwrap();
    let told: Vec<_> = changed.iter().map(|change| (change.name, change.found, change.wanted)).collect();
    assert_eq!(told, [("return delay", 250, 0), ("operating mode", 3, 5), ("current limit", 1193, 446)]);
    assert_eq!(motor.prepare().unwrap(), []);
    let state = motor.state().unwrap();
    assert_eq!((state.voltage, state.temperature, state.hardware_error, state.torque), (12.0, 28.0, 0, false));
}

/// Goals over several turns, forwards and backwards, are where the motor goes.
#[test]
fn goals_are_reached_over_several_turns() {
    let bench = Bench::start();
    let mut motor = bench.driver();
    motor.torque(true).unwrap();
    for goal in [3.0, 9.5, -2.5] {
        motor.goal(goal, 0.5).unwrap();
        let state = until(
            || {
                motor.goal(goal, 0.5).unwrap();
                motor.state().unwrap()
            },
            |state| (state.position - goal).abs() <= 0.5 * TICK + 1e-9 && state.velocity == 0.0,
        );
        assert!(state.torque && state.hardware_error == 0);
    }
    motor.torque(false).unwrap();
    assert!(!motor.state().unwrap().torque);
}

/// Without time, so that nothing is left to it: what the spool is told, and what is read of it, to the tick.
#[test]
fn ticks_and_signs() {
    let emulator = DynamixelEmulator::start(1, 1_000_000).unwrap();
    let mut motor = Dynamixel::open(DynamixelSettings {
        port: emulator.path().into(),
        reply: common::REPLY,
        ..DynamixelSettings::default()
    })
    .unwrap();
    motor.prepare().unwrap();
    motor.torque(true).unwrap();
    // -131073 is FF FF FD FF; -3 is FD FF FF FF; a speed and a current of -1 before 0xFD are FF FF FF FF FF FF FD.
    for (ticks, speed, current) in
        [(-131_073_i32, 0, 0), (-3, -1, -1), (253, -1, -1), (-771, -1, -1), (65_533, -1, 200), (1_048_570, 350, -446)]
    {
        let told = SpoolState {
            position: TICK * f64::from(ticks),
            velocity: 0.229 * TAU / 60.0 * f64::from(speed),
            current: 2.69e-3 * f64::from(current),
        };
        emulator.tell(told);
        for _ in 0..4 {
            let MotorState { position, velocity, current, .. } = motor.state().unwrap();
            let read = SpoolState { position, velocity, current };
            let near = |a: f64, b: f64| (a - b).abs() < 1e-9;
            assert!(near(read.position, told.position), "{read:?} is not {told:?}");
            assert!(near(read.velocity, told.velocity) && near(read.current, told.current), "{read:?}, {told:?}");
        }
        let goal = told.position - 0.25 * TICK;
        for _ in 0..300 + ticks.unsigned_abs() / 400 {
            motor.goal(goal, 0.5).unwrap();
            emulator.advance(0.09);
        }
        let wanted = SpoolDrive::Position { goal: told.position, current: 185.0 * 2.69e-3 };
        assert_eq!(emulator.drive(), wanted);
    }
    motor.torque(false).unwrap();
    assert_eq!(emulator.drive(), SpoolDrive::Free);
}

#[test]
fn goals_that_are_none_never_leave() {
    let bench = Bench::start();
    let settings = DynamixelSettings { range: [-1.0, 40.0], ..bench.settings() };
    let mut motor = Dynamixel::open(settings).unwrap();
    motor.prepare().unwrap();
    let mut refused = |position, current| match motor.goal(position, current).unwrap_err() {
        DriverError::Value { name, limits, .. } => (name, limits),
        error => panic!("{error}"),
    };
    for position in [f64::NAN, f64::INFINITY, -1.1, 40.1] {
        assert_eq!(refused(position, 0.1), ("position", "-1 to 40 rad".into()));
    }
    for current in [f64::NAN, -0.1, 1.3, f64::INFINITY] {
        assert_eq!(refused(0.0, current), ("current", "0 to 1.2 A".into()));
    }
}

/// Who says nothing for as long as the watchdog waits finds the motor standing, and its goals refused until torque is
/// switched on anew. The emulator's time is moved on by hand.
#[test]
fn the_watchdog_stops_the_motor() {
    let emulator = DynamixelEmulator::start(1, 1_000_000).unwrap();
    let settings =
        DynamixelSettings { port: emulator.path().into(), reply: common::REPLY, ..DynamixelSettings::default() };
    let mut motor = Dynamixel::open(settings).unwrap();
    motor.prepare().unwrap();
    motor.torque(true).unwrap();
    let mut world = FreeSpool::default();
    let mut go = |ms: usize| {
        let mut goals = Vec::new();
        for _ in 0..ms {
            let drive = emulator.drive();
            let SpoolDrive::Position { goal, .. } = drive else { panic!("torque stays on") };
            goals.push(goal);
            emulator.tell(world.step(&Pose::default(), drive));
            emulator.advance(STEP);
        }
        goals
    };
    for _ in 0..3 {
        motor.goal(500.0, 0.5).unwrap();
        // 99 ms of silence are borne.
        let goals = go(99);
        assert!(goals.windows(2).all(|pair| pair[1] > pair[0]), "{goals:?}");
    }
    motor.goal(500.0, 0.5).unwrap();
    let goals = go(200);
    let stands = goals.iter().position(|goal| *goal >= goals[199]).unwrap();
    assert!((99..=102).contains(&stands), "it stands after {stands} ms");
    let state = motor.state().unwrap();
    assert_eq!((state.velocity, state.torque), (0.0, true));
    let refused = motor.goal(1.0, 0.5).unwrap_err().to_string();
    assert!(refused.contains("its bus watchdog stopped it, after 100 ms without a word"), "{refused}");
    motor.torque(true).unwrap();
    assert_eq!(go(50)[49], goals[199], "it stays where it stood");
    motor.goal(0.0, 0.5).unwrap();
    assert!(go(50)[49] < goals[199]);
}

/// The speed is found, changed, and kept.
#[test]
fn a_motor_of_another_speed_is_found() {
    let bench = Bench::start();
    let wrong = DynamixelSettings { baud: 57_600, ..bench.settings() };
    assert!(matches!(Dynamixel::open(wrong.clone()).unwrap_err(), DriverError::Timeout { .. }));
    assert_eq!(Dynamixel::find_baud(&wrong).unwrap(), Some(1_000_000));
    let mut motor = bench.driver();
    motor.set_baud(57_600).unwrap();
    motor.identify().unwrap();
    drop(motor);
    let mut motor = Dynamixel::open(wrong).unwrap();
    motor.set_baud(2_000_000).unwrap();
    motor.prepare().unwrap();
    motor.torque(true).unwrap();
    bench.inject("silent");
    let taken = Dynamixel::find_baud(&bench.settings()).unwrap_err().to_string();
    assert!(taken.ends_with("another program drives this motor; end that one first"), "{taken}");
    drop(motor);
    assert_eq!(Dynamixel::find_baud(&bench.settings()).unwrap(), None);
}

/// A client that others wrote sees the same registers and the same errors.
#[test]
fn another_client_agrees() {
    let bench = Bench::start();
    let mut motor = bench.driver();
    motor.torque(true).unwrap();
    drop(motor);
    let mut other = dynamixel2::Bus::open(bench.path(), 1_000_000).unwrap();
    let ping = other.ping(1).unwrap();
    assert_eq!((ping.data.model, ping.data.firmware), (XM430_W210, 47));
    assert_eq!(other.read_u16(1, 144).unwrap().data, 120);
    let number = |error: dynamixel2::TransferError| match error {
        dynamixel2::TransferError::ReadError(dynamixel2::ReadError::MotorError(error)) => error.error_number(),
        error => panic!("{error}"),
    };
    assert_eq!(number(other.write_u8(1, 11, 4).unwrap_err()), 7);
    assert_eq!(number(other.write_u16(1, 102, 447).unwrap_err()), 6);
    assert_eq!(number(other.write_u8(1, 98, 200).unwrap_err()), 4);
    assert_eq!(number(other.write_u16(1, 116, 0).unwrap_err()), 5);
    assert_eq!(number(other.action(1).unwrap_err()), 2);
    assert_eq!(number(other.factory_reset(1, dynamixel2::instructions::FactoryResetKind::KeepId).unwrap_err()), 1);
    other.write_u8(1, 98, 0).unwrap();
    other.reg_write_u32(1, 116, 1000).unwrap();
    assert_eq!(other.read_u32(1, 116).unwrap().data, 0);
    assert_eq!(other.read_u8(1, 69).unwrap().data, 1);
    other.action(1).unwrap();
    assert_eq!(other.read_u32(1, 116).unwrap().data, 1000);
    until(|| other.read_u32(1, 132).unwrap().data, |&ticks| ticks == 1000);
    other.sync_write_u32(116, [dynamixel2::instructions::SyncWriteData { motor_id: 1, data: 9000 }]).unwrap();
    until(|| other.sync_read_u32(&[1], 132).unwrap()[0].data, |&ticks| ticks == 9000);
    until(|| other.read_u8(1, 122).unwrap().data, |&moving| moving == 0);
    other.clear_revolution_counter(1).unwrap();
    assert_eq!(other.read_u32(1, 132).unwrap().data, 9000 - 8192);
}
