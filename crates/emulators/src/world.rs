//! What stands behind the emulators: how the spool turns while the arm carries the hand about.

use hwasp_drivers::Pose;

/// A step of a world, s.
pub const STEP: f64 = 0.001;

/// What the motor does to the spool.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SpoolDrive {
    /// It turns freely.
    Free,
    /// It goes to a position.
    Position {
        /// rad.
        goal: f64,
        /// The most current that it takes for it, A.
        current: f64,
    },
}

/// What the spool does to the motor.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SpoolState {
    /// rad.
    pub position: f64,
    /// rad/s.
    pub velocity: f64,
    /// A.
    pub current: f64,
}

/// The world of a bench, one millisecond after the other.
pub trait World: Send {
    /// Goes on by 1 ms with the tool at `tool`, in the arm's base, and the spool so driven.
    fn step(&mut self, tool: &Pose, spool: SpoolDrive) -> SpoolState;
}

/// A spool with nothing on it, for tries of what is spoken.
#[derive(Clone, Copy, Debug, Default)]
pub struct FreeSpool {
    spool: SpoolState,
}

impl World for FreeSpool {
    /// It is at once where the motor wants it, and stays where nothing drives it.
    fn step(&mut self, _tool: &Pose, spool: SpoolDrive) -> SpoolState {
        let before = self.spool.position;
        if let SpoolDrive::Position { goal, current } = spool
            && current > 0.0
        {
            self.spool.position = goal;
        }
        self.spool.velocity = (self.spool.position - before) / STEP;
        self.spool
    }
}
