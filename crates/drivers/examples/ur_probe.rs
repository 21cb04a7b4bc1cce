//! `ur_probe HOST RTDE DASHBOARD SCRIPT FREQUENCY FACTS|DRIVE`: the driver against an arm or an emulator, its answers as JSON.
//!
//! `facts` reads alone. `drive` follows a small circle of 50 poses and then moves straight back to where it began: the same that
//! `scripts/ur_peer.py` has `ur_rtde` do.

use std::io::Write;
use std::time::{Duration, Instant};

use hwasp_drivers::ur::{UrArm, UrSettings};
use hwasp_drivers::{Arm, DriverError, Pose};

fn main() -> Result<(), String> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let [host, rtde, dashboard, script, frequency, what] = words.as_slice() else {
        return Err("give HOST RTDE DASHBOARD SCRIPT FREQUENCY and facts or drive".to_owned());
    };
    let port = |text: &str| text.parse::<u16>().map_err(|_| format!("{text:?} is no port"));
    let mut settings = UrSettings::new(host);
    (settings.rtde_port, settings.dashboard_port, settings.script_port) =
        (port(rtde)?, port(dashboard)?, port(script)?);
    settings.frequency = frequency.parse().map_err(|_| format!("{frequency:?} is no frequency"))?;
    let text = match what.as_str() {
        "facts" => facts(&settings),
        "drive" => drive(&settings),
        other => return Err(format!("{other:?} is neither facts nor drive")),
    };
    let text = text.map_err(|cause| cause.to_string())?;
    writeln!(std::io::stdout(), "{text}").map_err(|cause| cause.to_string())
}

fn six(pose: &Pose) -> Vec<f64> {
    [pose.position, pose.rotation].concat()
}

fn facts(settings: &UrSettings) -> Result<String, DriverError> {
    let mut arm = UrArm::connect(settings)?;
    let (facts, reading) = (arm.facts()?, arm.reading()?);
    Ok(format!(
        concat!(
            r#"{{"controller": {:?}, "polyscope": {:?}, "serial": {:?}, "robot_mode": {}, "safety_mode": {}, "#,
            r#""runtime_state": {}, "registers": {:?}, "joints": {:?}, "pose": {:?}, "tcp": {:?}, "payload": {:?}}}"#
        ),
        facts.controller,
        facts.polyscope,
        facts.serial_number.unwrap_or_default(),
        reading.robot_mode,
        reading.safety_mode,
        reading.runtime_state,
        [reading.doing, reading.taken, reading.heard, reading.program],
        reading.joints,
        six(&reading.tool),
        facts.tcp.as_ref().map(six).unwrap_or_default(),
        facts.payload.unwrap_or(-1.0),
    ))
}

fn drive(settings: &UrSettings) -> Result<String, DriverError> {
    let mut arm = UrArm::connect(settings)?;
    arm.start()?;
    let start = arm.state()?.tool;
    let mut target = start;
    for step in 1..=50_u32 {
        let angle = f64::from(step) * std::f64::consts::TAU / 100.0;
        target.position[0] = start.position[0] + 0.02 * (1.0 - angle.cos());
        target.position[2] = start.position[2] + 0.02 * angle.sin();
        arm.servo(&target)?;
        std::thread::sleep(Duration::from_millis(8));
    }
    let held = Instant::now();
    while held.elapsed() < Duration::from_millis(600) {
        arm.servo(&target)?;
        std::thread::sleep(Duration::from_millis(8));
    }
    let circle = arm.state()?.tool;
    arm.stop()?;
    arm.move_to(&start, 0.05)?;
    let back = arm.state()?.tool;
    let reading = arm.reading()?;
    arm.end()?;
    Ok(format!(
        r#"{{"start": {:?}, "circle": {:?}, "target": {:?}, "back": {:?}, "doing": {}, "taken": {}, "heard": {}}}"#,
        six(&start),
        six(&circle),
        six(&target),
        six(&back),
        reading.doing,
        reading.taken,
        reading.heard,
    ))
}
