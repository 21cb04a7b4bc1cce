//! What is told of a step: plain numbers, so that telling them allocates nothing.

use hwasp_drivers::{ArmMode, Safety};
use hwasp_settings::choice;
use hwasp_tasks::grasp::ShapeKind;

use crate::controller::{MOST_COMMANDED, MOST_SEEN};
use crate::safety::{Cause, Response};

choice! {
    /// What is being done.
    pub enum Phase {
        /// The palm goes to where an episode begins, the hand opens.
        Approach = "approach",
        /// The controller acts.
        Grasp = "grasp",
        /// The object is put down.
        SetDown = "set down",
        /// All stands still, and the motor holds.
        Held = "held",
        /// The motor is measured.
        Measure = "measure",
    }
}

/// A step of the loop, SI, in the task's world. What was not there is not a number.
#[derive(Clone, Copy, Debug)]
pub struct Step {
    /// Since the log began, s.
    pub time: f64,
    /// Which episode, from 0.
    pub episode: u32,
    /// What is being done.
    pub phase: Phase,
    /// Which step of it.
    pub step: u32,
    /// How late it began, s.
    pub late: f64,
    /// What the controller saw, by port.
    pub seen: [f64; MOST_SEEN],
    /// What it commanded, by port.
    pub commanded: [f64; MOST_COMMANDED],
    /// Where the palm is.
    pub palm: [f64; 3],
    /// Where it is sent.
    pub palm_target: [f64; 3],
    /// How fast the tool is, in the arm's base.
    pub tool_speed: [f64; 3],
    /// The arm's clock.
    pub arm_clock: f64,
    /// How old its data are.
    pub arm_age: f64,
    /// Whether it could move.
    pub arm_mode: ArmMode,
    /// What its safety says.
    pub arm_safety: Safety,
    /// What is wound.
    pub wound: f64,
    /// What the motor is sent to, as tendon.
    pub goal: f64,
    /// What commands have added up to.
    pub travel: f64,
    /// Speed of the motor, rad/s.
    pub velocity: f64,
    /// A.
    pub current: f64,
    /// What that current is taken for, N·m.
    pub torque: f64,
    /// V.
    pub voltage: f64,
    /// °C.
    pub temperature: f64,
    /// How old the motor's answer is.
    pub motor_age: f64,
    /// What was decided.
    pub response: Response,
}

/// Something that happened, once.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Event {
    /// An episode begins, with an object of this size there.
    Episode {
        /// m.
        size: [f64; 3],
        /// m.
        place: [f64; 3],
        /// Its shape, where somebody said it.
        shape: Option<ShapeKind>,
    },
    /// A rule decided.
    Decided(Response, Cause),
    /// The grasp was felt, at this torque, N·m.
    Felt(f64),
    /// The arm stands still.
    ArmStopped,
    /// The object is on the table.
    Down,
    /// The motor turns freely.
    Freed,
    /// A device did not do what it was asked.
    ArmFault,
    /// The same of the motor.
    MotorFault,
}

/// Where it is told to. Nothing waits for it, and nothing is allocated.
pub trait Sink: Send {
    /// A step.
    fn step(&mut self, step: &Step);
    /// An event at a time, s since the log began.
    fn event(&mut self, time: f64, episode: u32, event: Event);
    /// Whether something that was told is lost: a full disk, or one that is too slow.
    fn lost(&self) -> bool;
}

/// Keeps nothing.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoSink;

impl Sink for NoSink {
    fn step(&mut self, _: &Step) {}

    fn event(&mut self, _: f64, _: u32, _: Event) {}

    fn lost(&self) -> bool {
        false
    }
}
