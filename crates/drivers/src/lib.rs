//! Drivers of the bench. What runs a robot sees an [`Arm`] and a [`Motor`]; who speaks to them is its own concern.
#![forbid(unsafe_code)]

mod arm;
pub mod dynamixel;
mod error;
mod motor;
pub mod ur;

pub use arm::{Arm, ArmMode, ArmState, Pose, Safety};
pub use dynamixel::{Dynamixel, DynamixelSettings};
pub use error::DriverError;
pub use motor::{Motor, MotorState};
