//! A trained controller on arm and hand.
//!
//! [`Rig`](rig::Rig) says where the devices are and what they may; [`Controller`](controller::Controller) is the deterministic
//! controller of a run; [`Drive`](drive::Drive) is the loop over both, [`safety`] its rules, and [`log`] what is kept of it.
//! What a person does with them are [`check`], [`calibrate`], [`run`], [`replay`], [`identify`] and [`trials`].

#![forbid(unsafe_code)]

pub mod calibrate;
pub mod check;
pub mod clock;
pub mod controller;
pub mod date;
pub mod devices;
pub mod drive;
#[cfg(feature = "mujoco")]
pub mod dry;
mod error;
#[cfg(feature = "mujoco")]
pub mod identify;
pub mod log;
pub mod object;
pub mod pace;
pub mod record;
#[cfg(feature = "mujoco")]
pub mod replay;
pub mod rig;
pub mod run;
pub mod safety;
pub mod trials;

pub use error::DeployError;
