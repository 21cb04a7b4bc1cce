//! What arm and motor said last.

use std::time::Instant;

use hwasp_drivers::{Arm, ArmMode, ArmState, DriverError, Motor, MotorState, Safety};

use super::Manner;
use crate::controller::{MOST_COMMANDED, MOST_SEEN};
use crate::record::{Phase, Step};
use crate::safety::Response;

/// What arm and motor said last, and where palm and spool are by that.
#[derive(Clone, Copy, Debug)]
pub struct Senses {
    /// The arm's newest; none before its first word.
    pub arm: Option<ArmState>,
    /// Whether the line to it is broken.
    pub arm_lost: bool,
    /// The motor's newest.
    pub motor: Option<MotorState>,
    /// Whether the line to it is broken.
    pub motor_lost: bool,
    /// Where the palm is, m.
    pub palm: [f64; 3],
    /// What is wound, m.
    pub wound: f64,
    /// The motor's torque, N·m.
    pub torque: f64,
    /// When the step began.
    pub now: Option<Instant>,
}

impl Default for Senses {
    fn default() -> Self {
        Self {
            arm: None,
            arm_lost: false,
            motor: None,
            motor_lost: false,
            palm: [f64::NAN; 3],
            wound: f64::NAN,
            torque: f64::NAN,
            now: None,
        }
    }
}

impl Senses {
    /// Asks both. One that does not answer stays as it was, and grows old; whether arm and motor failed.
    pub(super) fn sense(&mut self, arm: &mut dyn Arm, motor: &mut dyn Motor, manner: &Manner) -> [bool; 2] {
        let mut failed = [false; 2];
        match arm.state() {
            Ok(state) => {
                self.arm = Some(state);
                self.palm = manner.frame.place(&state.tool);
            }
            Err(error) => {
                self.arm_failed(&error);
                failed[0] = true;
            }
        }
        match motor.state() {
            Ok(state) => {
                self.motor = Some(state);
                self.wound = manner.spool.wound(state.position);
                self.torque = manner.spool.torque(state.current);
            }
            Err(error) => {
                self.motor_failed(&error);
                failed[1] = true;
            }
        }
        failed
    }

    /// A broken line is known at once; whatever else went wrong may go right the next time, and shows in the age of the data.
    pub(super) fn arm_failed(&mut self, error: &DriverError) {
        tracing::debug!("{error}");
        self.arm_lost |= is_line(error);
    }

    pub(super) fn motor_failed(&mut self, error: &DriverError) {
        tracing::debug!("{error}");
        self.motor_lost |= is_line(error);
    }

    /// As it is told.
    pub(super) fn told(&self, now: Instant) -> Step {
        let age = |at: Option<Instant>| at.map_or(f64::NAN, |at| now.saturating_duration_since(at).as_secs_f64());
        let of_motor = |f: fn(&MotorState) -> f64| self.motor.as_ref().map_or(f64::NAN, f);
        Step {
            time: 0.0,
            episode: 0,
            phase: Phase::Approach,
            step: 0,
            late: 0.0,
            seen: [f64::NAN; MOST_SEEN],
            commanded: [f64::NAN; MOST_COMMANDED],
            palm: self.palm,
            palm_target: [f64::NAN; 3],
            tool_speed: self.arm.map_or([f64::NAN; 3], |arm| arm.tool_speed),
            arm_clock: self.arm.map_or(f64::NAN, |arm| arm.clock),
            arm_age: age(self.arm.map(|arm| arm.at)),
            arm_mode: self.arm.map_or(ArmMode::Off, |arm| arm.mode),
            arm_safety: self.arm.map_or(Safety::Stopped, |arm| arm.safety),
            wound: self.wound,
            goal: f64::NAN,
            travel: f64::NAN,
            velocity: of_motor(|motor| motor.velocity),
            current: of_motor(|motor| motor.current),
            torque: self.torque,
            voltage: of_motor(|motor| motor.voltage),
            temperature: of_motor(|motor| motor.temperature),
            motor_age: age(self.motor.map(|motor| motor.at)),
            response: Response::GoOn,
        }
    }
}

fn is_line(error: &DriverError) -> bool {
    matches!(error, DriverError::Line { .. })
}
