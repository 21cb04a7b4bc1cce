//! What goes wrong with a motor, and what the driver makes of it, in which time.

#![allow(clippy::unwrap_used)] // a panic is how a test fails

mod common;

use std::fs::{File, OpenOptions};
use std::io::{Read, Write};
use std::os::unix::ffi::OsStringExt;
use std::path::PathBuf;
use std::thread;
use std::time::{Duration, Instant};

use common::{Bench, REPLY, until};
use hwasp_drivers::{DriverError, Dynamixel, DynamixelSettings, Motor};
use hwasp_emulators::DynamixelEmulator;
use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};

/// How much later than the driver's patience a busy machine may notice.
const LATE: Duration = Duration::from_millis(300);

/// The error of the next question for the state, which has to come in time.
fn error(motor: &mut Dynamixel) -> DriverError {
    let asked = Instant::now();
    let error = motor.state().unwrap_err();
    assert!(asked.elapsed() < REPLY + LATE, "{error} after {:?}", asked.elapsed());
    error
}

#[test]
fn an_answer_that_does_not_come_right_is_told_in_time() {
    let bench = Bench::start();
    let mut motor = bench.driver();
    for (fault, timeout) in [("drop 1", true), ("silent", true), ("delay 320", true), ("wrong-crc 1", false)] {
        bench.inject(fault);
        let error = error(&mut motor);
        assert_eq!(matches!(error, DriverError::Timeout { waited: REPLY, .. }), timeout, "{fault}: {error}");
        assert_eq!(matches!(error, DriverError::Protocol { .. }), !timeout, "{fault}: {error}");
        bench.inject("clear");
        // What comes late is the answer to no question.
        thread::sleep(Duration::from_millis(350));
        motor.state().unwrap();
    }
    let mut lost = 0;
    bench.inject("drop 0.3");
    for _ in 0..40 {
        lost += usize::from(motor.state().is_err());
    }
    assert!((3..25).contains(&lost), "{lost} of 40 lost at 30 %");
    bench.inject("clear");
    bench.inject("noise 1");
    for _ in 0..20 {
        motor.state().unwrap();
    }
    bench.inject("delay 5");
    let asked = Instant::now();
    motor.state().unwrap();
    assert!(asked.elapsed() >= Duration::from_millis(5));
}

/// Answers that come later than the driver waits are never taken for those to the next questions.
#[test]
fn late_answers_are_no_answers() {
    let bench = Bench::start();
    let mut motor = bench.driver();
    motor.torque(true).unwrap();
    bench.inject("delay 300");
    for _ in 0..8 {
        let answer = motor.state();
        assert!(matches!(answer, Err(DriverError::Timeout { .. })), "{answer:?}");
        thread::sleep(Duration::from_millis(3));
    }
}

#[test]
fn a_motor_that_is_hot_lets_go_until_a_person_reboots_it() {
    let bench = Bench::start();
    let mut motor = bench.driver();
    motor.torque(true).unwrap();
    bench.inject("heat 75");
    assert_eq!(motor.state().unwrap().temperature, 75.0);
    motor.goal(0.1, 0.5).unwrap();
    bench.inject("heat 85");
    let state = motor.state().unwrap();
    assert_eq!((state.hardware_error, state.torque), (0b100, false));
    for refused in [motor.goal(0.2, 0.5), motor.torque(true)] {
        let refused = refused.unwrap_err().to_string();
        assert!(refused.contains("hardware error 0x04: it is too hot. Find out why, then reboot it"), "{refused}");
    }
    // Cool again, it still does nothing by itself.
    bench.inject("clear");
    assert!(motor.torque(true).is_err());
    motor.reboot().unwrap();
    assert!(motor.torque(true).unwrap_err().to_string().contains("it is not prepared"));
    assert_eq!(motor.prepare().unwrap(), []);
    motor.torque(true).unwrap();
    motor.goal(0.2, 0.5).unwrap();
}

#[test]
fn every_hardware_error_is_told() {
    for (fault, bits, torque) in [
        ("overload", 0x20, false),
        ("shock", 0x10, false),
        ("encoder", 0x08, true),
        ("voltage 8", 0x01, true),
        ("voltage 17", 0x01, true),
    ] {
        let bench = Bench::start();
        let mut motor = bench.driver();
        motor.torque(true).unwrap();
        bench.inject(fault);
        let state = motor.state().unwrap();
        assert_eq!((state.hardware_error, state.torque), (bits, torque), "{fault}");
        assert_eq!(motor.goal(0.1, 0.1).is_ok(), torque, "{fault}");
    }
}

#[test]
fn readings_can_be_wrong() {
    let bench = Bench::start();
    let mut motor = bench.driver();
    motor.torque(true).unwrap();
    for amperes in [1.5, -0.8] {
        bench.inject(&format!("over-current {amperes}"));
        let read = motor.state().unwrap().current;
        assert!((read - amperes).abs() <= 0.5 * 2.69e-3, "{read} A");
    }
    bench.inject("voltage 11.1");
    assert!((motor.state().unwrap().voltage - 11.1).abs() < 1e-9);
    bench.inject("stuck present-position");
    let moved = until(
        || {
            motor.goal(3.0, 0.5).unwrap();
            motor.state().unwrap()
        },
        |state| state.velocity > 1.0,
    );
    assert_eq!(moved.position, 0.0);
    bench.inject("clear");
    let state = until(
        || {
            motor.goal(3.0, 0.5).unwrap();
            motor.state().unwrap()
        },
        |state| state.position > 2.9,
    );
    assert_eq!(state.current, 0.0);
}

/// A motor that lost its power is never read as one that stands at zero.
#[test]
fn a_restart_is_told() {
    let bench = Bench::start();
    let mut motor = bench.driver();
    motor.torque(true).unwrap();
    motor.goal(1.0, 0.5).unwrap();
    bench.inject("restart");
    assert!(matches!(error(&mut motor), DriverError::Timeout { .. }));
    let error = until(|| motor.state().unwrap_err(), |error| !matches!(error, DriverError::Timeout { .. })).to_string();
    assert!(error.contains("its power failed since: torque is off and turns are forgotten"), "{error}");
    assert!(motor.torque(true).unwrap_err().to_string().contains("prepare it first"));
    motor.prepare().unwrap();
    assert!(!motor.state().unwrap().torque);
}

#[test]
fn a_cut_cable_is_a_broken_line() {
    let bench = Bench::start();
    let mut motor = bench.driver();
    bench.inject("cut");
    let told = error(&mut motor);
    assert!(matches!(told, DriverError::Line { .. }), "{told:?}");
    let missing = Dynamixel::open(bench.settings()).unwrap_err().to_string();
    assert!(missing.contains("opening the port"), "{missing}");
    let nowhere = DynamixelSettings { port: "/dev/no-such-port".into(), ..bench.settings() };
    let missing = Dynamixel::open(nowhere).unwrap_err().to_string();
    assert!(missing.contains("Dynamixel 1 at /dev/no-such-port: opening the port: "), "{missing}");
    assert!(missing.ends_with("plug the adapter in, and see `ls /dev/serial/by-id`"), "{missing}");
}

fn random(state: &mut u64) -> u64 {
    // xorshift64* (Vigna 2016).
    *state ^= *state >> 12;
    *state ^= *state << 25;
    *state ^= *state >> 27;
    state.wrapping_mul(0x2545_F491_4F6C_DD1D)
}

/// The checksum a bit at a time, so that hostile packets can be right where it matters.
fn packet(id: u8, length: u16, body: &[u8]) -> Vec<u8> {
    let mut bytes = vec![0xFF, 0xFF, 0xFD, 0x00, id];
    bytes.extend(length.to_le_bytes());
    bytes.extend(body);
    let sum = bytes.iter().fold(0_u16, |sum, &byte| {
        (0..8)
            .fold(sum ^ (u16::from(byte) << 8), |sum, _| if sum & 0x8000 == 0 { sum << 1 } else { (sum << 1) ^ 0x8005 })
    });
    bytes.extend(sum.to_le_bytes());
    bytes
}

/// Bytes that mean harm: noise, headers, and packets of every instruction with few or odd parameters.
fn hostile(state: &mut u64) -> Vec<u8> {
    let count = (random(state) % 24) as usize;
    let bytes: Vec<u8> =
        (0..count).map(|_| [random(state) as u8, 0xFF, 0xFD, 0x00, 0x01][(random(state) % 5) as usize]).collect();
    let id = [0, 1, 1, 1, 254, 255][(random(state) % 6) as usize];
    let right = bytes.len() as u16 + 2;
    match random(state) % 4 {
        0 => bytes,
        1 => packet(id, right, &bytes),
        2 => packet(id, random(state) as u16, &bytes),
        _ => {
            let instructions = [0x01, 0x02, 0x03, 0x04, 0x05, 0x06, 0x10, 0x20, 0x55, 0x82, 0x83, 0x8A, 0x92, 0x93];
            let mut body = vec![instructions[(random(state) % 14) as usize]];
            body.extend(bytes);
            packet(id, right + 1, &body)
        }
    }
}

#[test]
fn hostile_bytes_do_the_emulator_no_harm() {
    let emulator = DynamixelEmulator::start(1, 1_000_000).unwrap();
    // Sets the speed of the line.
    drop(dynamixel2::Bus::open(emulator.path(), 1_000_000).unwrap());
    let mut line = OpenOptions::new().read(true).write(true).open(emulator.path()).unwrap();
    let mut state = 7;
    for _ in 0..3000 {
        line.write_all(&hostile(&mut state)).unwrap();
        emulator.advance(0.001);
    }
    drop(line);
    // Some of the bytes may have started it anew, or have set another identity or speed, and some may still wait to be read.
    let mut ping = |baud: &u32| {
        emulator.advance(1.0);
        let mut everybody = dynamixel2::Bus::open(emulator.path(), *baud).unwrap();
        everybody.write_instruction(254, 1, 0, |_| ()).unwrap();
        everybody.read_status_response_deadline(Instant::now() + Duration::from_millis(200)).is_ok()
    };
    let bauds = [1_000_000, 9_600, 57_600, 115_200, 2_000_000, 3_000_000, 4_000_000, 4_500_000];
    until(|| bauds.iter().any(&mut ping), |&answers| answers);
}

/// A device that answers whatever it likes.
fn liar() -> (File, PathBuf, File) {
    let ours = openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY).unwrap();
    grantpt(&ours).unwrap();
    unlockpt(&ours).unwrap();
    let path = PathBuf::from(std::ffi::OsString::from_vec(ptsname(&ours, Vec::new()).unwrap().into_bytes()));
    let theirs = OpenOptions::new().read(true).write(true).open(&path).unwrap();
    (ours.into(), path, theirs)
}

#[test]
fn hostile_bytes_do_the_driver_no_harm() {
    let (mut ours, path, theirs) = liar();
    let answering = thread::spawn(move || {
        let (mut state, mut bytes, mut asked) = (11, [0; 256], 0_usize);
        while ours.read(&mut bytes).is_ok_and(|count| count > 0) {
            asked += 1;
            let answer = match asked {
                1 => packet(1, 7, &[0x55, 0x00, 0x06, 0x04, 0x26]),
                // Every short length, with the right checksum.
                2..=12 => packet(1, (asked - 2) as u16, &[0x55, 0x00, 0, 0][..(asked % 5).min(4)]),
                // The right length, and voltage and all else zero or random.
                13..=60 => {
                    let body: Vec<u8> = (0..15 + asked % 4).map(|_| random(&mut state) as u8).collect();
                    packet(1, body.len() as u16 + 4, &[&[0x55, 0x00][..], &body].concat())
                }
                _ => hostile(&mut state),
            };
            if ours.write_all(&answer).is_err() {
                break;
            }
        }
    });
    let reply = Duration::from_millis(3);
    let mut motor = Dynamixel::open(DynamixelSettings { port: path, reply, ..DynamixelSettings::default() }).unwrap();
    let mut errors = 0;
    for i in 0..600 {
        let asked = Instant::now();
        let failed = match i % 3 {
            0 => motor.goal(1.0, 0.1).is_err(),
            1 => motor.state().is_err(),
            _ => motor.identify().is_err(),
        };
        errors += usize::from(failed);
        assert!(asked.elapsed() < 3 * reply + LATE, "question {i} took {:?}", asked.elapsed());
    }
    assert!(errors > 400, "{errors} of 600");
    drop((motor, theirs));
    answering.join().unwrap();
}
