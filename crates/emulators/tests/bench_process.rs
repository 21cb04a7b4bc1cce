//! The bench as whoever starts it sees it: lines in, lines out, and a serial port.

#![allow(clippy::unwrap_used)] // a panic is how a test fails

use std::io::{BufRead, BufReader, PipeReader, PipeWriter, Write};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use hwasp_drivers::ur::{UrArm, UrSettings};
use hwasp_drivers::{Arm, Dynamixel, DynamixelSettings, Motor};
use hwasp_emulators::bench::{BenchSettings, run_bench};
use hwasp_tasks::hand::SEARCHED;
use serde_json::{Value, json};

struct Process {
    orders: PipeWriter,
    answers: BufReader<PipeReader>,
    thread: JoinHandle<()>,
    ready: Value,
}

impl Process {
    fn start(settings: &str) -> Self {
        let bench = BenchSettings::from_json(settings).unwrap().start().unwrap();
        let ((input, orders), (answers, mut output)) = (std::io::pipe().unwrap(), std::io::pipe().unwrap());
        let thread = thread::spawn(move || run_bench(bench, BufReader::new(input), &mut output).unwrap());
        let mut process = Self { orders, answers: BufReader::new(answers), thread, ready: Value::Null };
        process.ready = process.answer();
        process
    }

    fn answer(&mut self) -> Value {
        let mut line = String::new();
        self.answers.read_line(&mut line).unwrap();
        serde_json::from_str(&line).unwrap()
    }

    fn ask(&mut self, order: &str) -> Value {
        writeln!(self.orders, "{order}").unwrap();
        self.answer()
    }

    fn motor(&self) -> Dynamixel {
        let port = self.ready["motor"]["port"].as_str().unwrap().into();
        let reply = Duration::from_millis(100);
        let watchdog = Duration::from_secs(2);
        let mut motor =
            Dynamixel::open(DynamixelSettings { port, reply, watchdog, ..DynamixelSettings::default() }).unwrap();
        motor.prepare().unwrap();
        motor
    }

    fn end(mut self) {
        assert_eq!(self.ask("quit"), json!({"ok": true}));
        self.thread.join().unwrap();
    }
}

#[test]
fn a_motor_alone() {
    let mut bench = Process::start("{}");
    assert_eq!((&bench.ready["arm"], &bench.ready["motor"]["baud"]), (&Value::Null, &json!(1_000_000)));
    let mut motor = bench.motor();
    motor.torque(true).unwrap();
    let began = Instant::now();
    while bench.ask("state")["spool"]["position"].as_f64().unwrap() < 0.999 {
        motor.goal(1.0, 0.5).unwrap();
        assert!(began.elapsed() < Duration::from_secs(10));
    }
    assert_eq!(bench.ask("fault motor heat 85"), json!({"ok": true}));
    assert_eq!(motor.state().unwrap().hardware_error, 4);
    for (order, says) in [
        ("fault arm freeze", "there is no arm on this bench"),
        ("fault motor heat", "`heat` needs a number C"),
        ("object 0 1", "there is no hand behind this bench"),
        ("jump", "`jump` is no order; there are `state`,"),
    ] {
        let answer = bench.ask(order);
        assert!(answer["error"].as_str().unwrap().contains(says), "{answer}");
    }
    assert_eq!(bench.ask("state")["hand"], Value::Null);
    bench.end();
}

/// The driver winds, the hand closes in the air, and the current is that of its tendons.
#[test]
fn a_hand_behind_the_motor() {
    let settings = json!({"arm": "cb3", "hand": {"design": SEARCHED, "base_position": [0.0, 0.0, 1.0], "zero": 0.5}});
    let mut bench = Process::start(&settings.to_string());
    assert!(bench.ready["arm"]["rtde"].as_u64().unwrap() > 0);
    let drawn = bench.ask("object 3 5");
    assert!(drawn["palm"][2].as_f64().unwrap() > drawn["object"]["size"][2].as_f64().unwrap() + 0.149);
    assert_eq!(bench.ask("state")["hand"]["object"], drawn["object"]);
    let object = r#"{"kind": "box", "size": [0.05, 0.06, 0.07], "mass": 0.2, "friction": 0.7}"#;
    assert_eq!(bench.ask(&format!("object {object}")), json!({"ok": true}));
    let mut motor = bench.motor();
    motor.torque(true).unwrap();
    let zero = motor.state().unwrap().position;
    assert!((zero - 0.5).abs() < 0.002, "{zero} rad");
    let began = Instant::now();
    let wound = loop {
        let ahead = 2.5 * began.elapsed().as_secs_f64();
        motor.goal(0.5 + ahead.min(1.5), 0.5).unwrap();
        let hand = bench.ask("state")["hand"].clone();
        if ahead > 2.5 && hand["wound"].as_f64().unwrap() > 0.0119 {
            break hand;
        }
        assert!(began.elapsed() < Duration::from_secs(20), "{hand}");
    };
    assert_eq!(wound["fault"], Value::Null);
    assert!(wound["joints"].as_array().unwrap().iter().any(|angle| angle.as_f64().unwrap() > 0.3), "{wound}");
    let state = motor.state().unwrap();
    let tension = bench.ask("state")["hand"]["tension"].as_f64().unwrap();
    let told = tension * 0.008 / (3.0 / 2.3);
    assert!((state.current - told).abs() < 0.01 && told > 0.02, "{} A, {told} A", state.current);
    bench.end();
}

/// Both drivers over both emulators lift an object: down and up at 0.1 m/s, 20 mm of tendon a second, a command every 8 ms.
#[test]
#[ignore = "in real time: `cargo test -p hwasp-emulators --test bench_process -- --ignored` on a machine that does nothing else"]
fn arm_and_motor_lift_an_object() {
    // The tool of the emulated arm begins above the origin of the world.
    let base = [0.347_542, 0.109_15, -0.12];
    let settings =
        json!({"arm": "cb3", "hand": {"design": SEARCHED, "tension_limit": 163.0, "base_position": base, "zero": 1.0}});
    let mut bench = Process::start(&settings.to_string());
    let mut arm_settings = UrSettings::new("127.0.0.1");
    let port = |bench: &Process, name: &str| bench.ready["arm"][name].as_u64().unwrap() as u16;
    (arm_settings.rtde_port, arm_settings.dashboard_port, arm_settings.script_port) =
        (port(&bench, "rtde"), port(&bench, "dashboard"), port(&bench, "script"));
    let mut arm = UrArm::connect(&arm_settings).unwrap();
    arm.start().unwrap();
    let mut motor = bench.motor();
    let object = bench.ask("object 0 7")["object"].clone();
    motor.torque(true).unwrap();
    let (mut tool, top) = (arm.state().unwrap().tool, object["size"][2].as_f64().unwrap());
    let low = (top + 0.005).max(0.1) - base[2];
    let (mut goal, mut lifts, began) = (motor.state().unwrap().position, false, Instant::now());
    let success = loop {
        let height = if lifts { low + 0.17 } else { low };
        let left = height - tool.position[2];
        tool.position[2] += left.clamp(-0.0008, 0.0008);
        arm.servo(&tool).unwrap();
        let state = motor.state().unwrap();
        if (left == 0.0 || lifts) && state.current < 0.99 {
            goal += 0.00016 / 0.008;
        }
        lifts |= state.current > 0.97;
        motor.goal(goal, 1.0).unwrap();
        thread::sleep(Duration::from_millis(8));
        let seen = bench.ask("state");
        if seen["hand"]["success"] == json!(true) {
            break seen;
        }
        assert!(began.elapsed() < Duration::from_secs(20), "{seen}");
    };
    println!("after {:?}: {success}", began.elapsed());
    assert!(success["hand"]["clearance"].as_f64().unwrap() > 0.1);
    arm.end().unwrap();
    motor.torque(false).unwrap();
    bench.end();
}

#[test]
fn settings_that_make_no_bench_are_named() {
    let refused = |text: &str| match BenchSettings::from_json(text).and_then(|settings| settings.start()) {
        Ok(_) => panic!("{text}"),
        Err(error) => error.to_string(),
    };
    assert_eq!(refused(r#"{"arm": "ur3"}"#), "arm = \"ur3\" is neither \"cb3\" nor \"e-series\"");
    assert!(refused(r#"{"hands": 1}"#).starts_with("no settings of a bench: unknown field `hands`"));
    assert_eq!(refused(r#"{"id": 254}"#), "id = 254 is not 0 to 252");
    assert!(refused(r#"{"baud": 1}"#).starts_with("baud = 1 is not one of 9600,"));
    let hand = json!({"hand": {"design": SEARCHED, "slack": -1.0}}).to_string();
    assert_eq!(refused(&hand), "slack = -1 is not 0 to 0.02 m");
}
