//! A motor that winds, as what runs a robot sees it.

use std::time::Instant;

use crate::error::DriverError;

/// What the motor told of itself in one answer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotorState {
    /// When the answer arrived here.
    pub at: Instant,
    /// Turned, rad, over any number of turns, from the motor's own zero.
    pub position: f64,
    /// rad/s.
    pub velocity: f64,
    /// A; positive where it drives towards larger positions.
    pub current: f64,
    /// V.
    pub voltage: f64,
    /// °C.
    pub temperature: f64,
    /// Bits of its hardware error; 0 is none.
    pub hardware_error: u8,
    /// Whether it holds its position by torque.
    pub torque: bool,
}

/// A motor that goes to positions with at most so much current.
pub trait Motor: Send {
    /// Everything at once, in one exchange.
    fn state(&mut self) -> Result<MotorState, DriverError>;
    /// Goes to `position`, rad, with at most `current`, A.
    fn goal(&mut self, position: f64, current: f64) -> Result<(), DriverError>;
    /// Holds by torque, or turns freely.
    fn torque(&mut self, on: bool) -> Result<(), DriverError>;
}
