//! An arm, as what runs a robot sees it.

use std::time::Instant;

use crate::error::DriverError;

/// Where a tool is, in the arm's base.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pose {
    /// m.
    pub position: [f64; 3],
    /// Axis times angle, rad.
    pub rotation: [f64; 3],
}

/// Whether the arm could move.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ArmMode {
    /// Brakes released, ready.
    Running,
    /// On, brakes closed.
    Idle,
    /// Everything else: off, starting, shutting down.
    Off,
}

/// What the arm's own safety says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Safety {
    /// Nothing.
    Normal,
    /// Slower than asked for.
    Reduced,
    /// Stopped by a contact or a limit; a person has to look and to unlock it.
    ProtectiveStop,
    /// A button was pressed.
    EmergencyStop,
    /// Stopped for any other reason.
    Stopped,
}

/// The newest that the arm told of itself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ArmState {
    /// When it arrived here.
    pub at: Instant,
    /// The arm's own clock, s.
    pub clock: f64,
    /// Where the tool is.
    pub tool: Pose,
    /// How fast it is, m/s.
    pub tool_speed: [f64; 3],
    /// Angles of the joints, rad.
    pub joints: [f64; 6],
    /// Whether it could move.
    pub mode: ArmMode,
    /// What its safety says.
    pub safety: Safety,
}

/// An arm that follows poses.
pub trait Arm: Send {
    /// The newest state; never waits for longer than a packet may take.
    fn state(&mut self) -> Result<ArmState, DriverError>;
    /// Follows this pose from now on, for a few of its periods; whoever wants it to go on says so again.
    fn servo(&mut self, target: &Pose) -> Result<(), DriverError>;
    /// Moves straight to a pose, at `speed`, m/s, and returns when it is there.
    fn move_to(&mut self, target: &Pose, speed: f64) -> Result<(), DriverError>;
    /// Stands still, and waits for nothing.
    fn stop(&mut self) -> Result<(), DriverError>;
}
