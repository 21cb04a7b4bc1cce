//! The devices of a rig, opened.

use std::time::{Duration, Instant};

use hwasp_drivers::ur::{Payload, PoseLimits, UrArm, UrSettings};
use hwasp_drivers::{Arm, ArmState, DriverError, Dynamixel, DynamixelSettings, Pose};

use crate::drive::Courier;
use crate::error::DeployError;
use crate::rig::Rig;

/// How the arm of a rig is reached and what it may do.
pub fn arm_settings(rig: &Rig) -> UrSettings {
    let (lowest, highest) = corners(rig);
    let port = |port: u64| port as u16;
    UrSettings {
        rtde_port: port(rig.arm.rtde_port),
        dashboard_port: port(rig.arm.dashboard_port),
        script_port: port(rig.arm.script_port),
        frequency: rig.arm.rate,
        oldest: Duration::from_secs_f64(rig.limits.arm_stale),
        tcp: Some(Pose { position: rig.arm.tcp_position, rotation: rig.arm.tcp_rotation }),
        payload: Some(Payload { mass: rig.arm.payload, center: rig.arm.payload_centre }),
        limits: PoseLimits {
            lowest,
            highest,
            leap: 2.0 * rig.limits.following,
            speed: rig.limits.palm_speed,
            ..PoseLimits::default()
        },
        ..UrSettings::new(&rig.arm.host)
    }
}

/// The box in the arm's base that has the whole workspace in it, m.
fn corners(rig: &Rig) -> ([f64; 3], [f64; 3]) {
    let (frame, [x, y, z]) = (rig.frame(), rig.limits.workspace);
    let (mut lowest, mut highest) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    for corner in 0..8 {
        let place = [x[corner & 1], y[corner >> 1 & 1], z[corner >> 2]];
        let at = frame.pose(place).position;
        for axis in 0..3 {
            // What arithmetic rounds is no leap out of the box.
            lowest[axis] = lowest[axis].min(at[axis] - 1e-6);
            highest[axis] = highest[axis].max(at[axis] + 1e-6);
        }
    }
    (lowest, highest)
}

/// How the motor of a rig is reached and what it may do.
pub fn motor_settings(rig: &Rig) -> DynamixelSettings {
    DynamixelSettings {
        port: rig.motor.port.clone(),
        id: rig.motor.id as u8,
        baud: rig.motor.baud as u32,
        current_limit: rig.motor.current_limit,
        watchdog: Duration::from_secs_f64(rig.motor.watchdog),
        // Two answers that are lost, one after the other, are borne.
        reply: Duration::from_secs_f64(0.2 * rig.limits.motor_stale),
        ..DynamixelSettings::default()
    }
}

/// Connects to the arm. Nothing moves, and no program is sent.
///
/// # Errors
/// The driver's.
pub fn arm(rig: &Rig) -> Result<UrArm, DeployError> {
    Ok(UrArm::connect(&arm_settings(rig))?)
}

/// Opens the motor, sets what the driver needs, and puts it on a thread of its own. Its torque is off.
///
/// # Errors
/// The driver's.
pub fn motor(rig: &Rig) -> Result<Courier, DeployError> {
    let mut motor = Dynamixel::open(motor_settings(rig))?;
    motor.prepare()?;
    let device = format!("motor {}", rig.motor.port.display());
    let courier = Courier::new(Box::new(motor), &device);
    courier.map_err(|source| DeployError::File { action: "begun", path: "motor thread".into(), source })
}

/// How long a first state is waited for.
const PATIENCE: Duration = Duration::from_secs(1);

/// The arm's state, once it is fresh: starting a program may hold packets up.
fn first_state(arm: &mut UrArm) -> Result<ArmState, DriverError> {
    let begin = Instant::now();
    loop {
        match arm.state() {
            Err(DriverError::Timeout { .. }) if begin.elapsed() < PATIENCE => {
                std::thread::sleep(Duration::from_millis(2));
            }
            answer => return answer,
        }
    }
}

/// How far the tool may be turned from where it has to be, rad, before it is turned first.
const UPRIGHT: f64 = 0.02;
/// How often the way there is begun anew where a packet was late.
const ATTEMPTS: u32 = 5;
/// The palm's height while it is brought into the workspace, m.
const READY: f64 = 0.35;

/// Starts the arm's program, and brings the palm into the workspace where it is outside of it or turned: straight, slowly.
///
/// # Errors
/// The driver's.
pub fn ready(arm: &mut UrArm, rig: &Rig) -> Result<(), DeployError> {
    arm.start()?;
    let (frame, tool) = (rig.frame(), first_state(arm)?.tool);
    let (place, [x, y, z]) = (frame.place(&tool), rig.limits.workspace);
    let inside = |axis: usize| (rig.limits.workspace[axis][0]..=rig.limits.workspace[axis][1]).contains(&place[axis]);
    if (0..3).all(inside) && tool.turn(&frame.pose(place)) < UPRIGHT {
        return Ok(());
    }
    let middle = |[lo, hi]: [f64; 2]| 0.0_f64.clamp(lo, hi);
    let target = frame.pose([middle(x), middle(y), READY.clamp(z[0], z[1])]);
    for left in (0..ATTEMPTS).rev() {
        match arm.move_to(&target, rig.limits.palm_speed) {
            // The arm stands then; where it is is where it goes on from.
            Err(DriverError::Timeout { .. }) if left > 0 => drop(first_state(arm)?),
            answer => return Ok(answer?),
        }
    }
    Ok(())
}
