//! What the rules look at.

use std::time::{Duration, Instant};

use hwasp_drivers::{ArmState, MotorState};

use super::cause::Cause;
use crate::rig::Rig;

/// What the rules keep; SI.
#[derive(Clone, Debug, PartialEq)]
pub struct Limits {
    /// m.
    pub workspace: [[f64; 2]; 3],
    /// m.
    pub margin: f64,
    /// m/s.
    pub palm_speed: f64,
    /// m.
    pub following: f64,
    /// A.
    pub current: f64,
    /// For how long more is borne.
    pub current_time: Duration,
    /// The current that the hand is wound with at most, A.
    pub working_current: f64,
    /// °C.
    pub temperature: f64,
    /// V.
    pub voltage: [f64; 2],
    /// Oldest data of the arm.
    pub arm_stale: Duration,
    /// Oldest answer of the motor.
    pub motor_stale: Duration,
    /// For how long a spool may stand still that should wind.
    pub stuck: Duration,
    /// How late a step may begin.
    pub overrun: Duration,
    /// How far the spool's goal leads it, m.
    pub lead: f64,
    /// What the spool winds at most, m.
    pub travel: f64,
    /// Oldest word about the object.
    pub object_stale: Duration,
    /// For how long it is waited for.
    pub patience: Duration,
}

impl Limits {
    /// Those of a rig, for a spool that winds `travel`, m, with `working_current`, A.
    pub fn of(rig: &Rig, travel: f64, working_current: f64) -> Self {
        let limits = &rig.limits;
        let time = Duration::from_secs_f64;
        Self {
            workspace: limits.workspace,
            margin: limits.margin,
            palm_speed: limits.palm_speed,
            following: limits.following,
            current: limits.current,
            current_time: time(limits.current_time),
            working_current,
            temperature: limits.temperature,
            voltage: limits.voltage,
            arm_stale: time(limits.arm_stale),
            motor_stale: time(limits.motor_stale),
            stuck: time(limits.stuck),
            overrun: time(limits.overrun),
            lead: limits.lead,
            travel,
            object_stale: time(rig.object.tracker_stale),
            patience: time(limits.patience),
        }
    }
}

/// A step, as the rules see it.
#[allow(clippy::struct_excessive_bools, reason = "each is what one device or one person says")]
#[derive(Clone, Copy, Debug)]
pub struct Glance {
    /// When.
    pub now: Instant,
    /// How late the step began.
    pub late: Duration,
    /// The newest of the arm; none before its first word.
    pub arm: Option<ArmState>,
    /// Whether the line to it is broken.
    pub arm_lost: bool,
    /// The newest of the motor.
    pub motor: Option<MotorState>,
    /// Whether the line to it is broken.
    pub motor_lost: bool,
    /// Where the palm is, in the world, m.
    pub palm: [f64; 3],
    /// Where it was sent last, m.
    pub palm_target: [f64; 3],
    /// What is wound, m.
    pub wound: f64,
    /// What should be wound, m: the goal that the motor was sent.
    pub wound_target: f64,
    /// Whether the motor was told to hold by torque.
    pub holding: bool,
    /// How old the newest word about the object is, where it can grow old.
    pub object_age: Option<Duration>,
    /// How often a person asked to stop.
    pub interrupts: u32,
    /// Whether what is logged is lost.
    pub log_lost: bool,
}

/// What was found in a step.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Found(Option<Cause>);

impl Found {
    /// Keeps a cause if it is there and its response is the strongest so far.
    pub(super) fn is(&mut self, there: bool, cause: Cause) {
        if there && self.0.is_none_or(|kept| cause.response() > kept.response()) {
            self.0 = Some(cause);
        }
    }

    pub(super) fn worst(self) -> Option<Cause> {
        self.0
    }
}
