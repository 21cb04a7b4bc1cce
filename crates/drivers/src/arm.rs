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

impl Pose {
    /// How far its position is from another's, m.
    pub fn distance(&self, other: &Self) -> f64 {
        (0..3).map(|axis| (self.position[axis] - other.position[axis]).powi(2)).sum::<f64>().sqrt()
    }

    /// By how much it is turned from another, rad, 0 to π; turns by 2π are none.
    pub fn turn(&self, other: &Self) -> f64 {
        let (a, b) = (quaternion(self.rotation), quaternion(other.rotation));
        // Of a⁻¹ b: by its imaginary part too, since the real one alone is blind to small turns.
        let real: f64 = (0..4).map(|i| a[i] * b[i]).sum();
        let imaginary = [
            a[0] * b[1] - a[1] * b[0] - a[2] * b[3] + a[3] * b[2],
            a[0] * b[2] - a[2] * b[0] - a[3] * b[1] + a[1] * b[3],
            a[0] * b[3] - a[3] * b[0] - a[1] * b[2] + a[2] * b[1],
        ];
        2.0 * imaginary.iter().map(|part| part * part).sum::<f64>().sqrt().atan2(real.abs())
    }
}

/// The unit quaternion of an axis times an angle, real part first.
fn quaternion(rotation: [f64; 3]) -> [f64; 4] {
    let angle = rotation.iter().map(|part| part * part).sum::<f64>().sqrt();
    let scale = if angle > 0.0 { (angle / 2.0).sin() / angle } else { 0.5 };
    [(angle / 2.0).cos(), rotation[0] * scale, rotation[1] * scale, rotation[2] * scale]
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn turns_are_told_between_poses() {
        let pose = |rotation| Pose { position: [0.0; 3], rotation };
        let pi = std::f64::consts::PI;
        assert!((pose([pi, 0.0, 0.0]).turn(&pose([-pi, 0.0, 0.0]))).abs() < 1e-12, "half a turn either way");
        assert!((pose([0.3, 0.0, 0.0]).turn(&pose([0.1, 0.0, 0.0])) - 0.2).abs() < 1e-12);
        assert!((pose([0.0, 0.0, 1e-9]).turn(&pose([0.0; 3])) - 1e-9).abs() < 1e-20, "small turns too");
        assert!((pose([pi, 0.0, 0.0]).turn(&pose([0.0, pi, 0.0])) - pi).abs() < 1e-12, "about z");
    }
}
