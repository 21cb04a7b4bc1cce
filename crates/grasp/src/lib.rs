//! Grasping with the underactuated hand (paper, section 6 and appendix B): from above, wind, lift, hold.
//!
//! # Observation
//! | port | unit | |
//! |---|---|---|
//! | `palm_x`, `palm_y`, `palm_z` | m | noisy |
//! | `object_x`, `object_y`, `object_z` | m | its centre, noisy; relative to the palm where [`Viewpoint`] says so |
//! | `size_x`, `size_y`, `size_z` | m | its bounding box as it lies at the start |
//! | `motor_travel` | m | tendon wound, as commanded or by the encoder, noisy |
//! | `motor_torque` | N·m | of the last step |
//!
//! [`Bench`] says what of it is sensed, how late and how wrong.
//!
//! # Command
//! | port | unit | range |
//! |---|---|---|
//! | `palm_z`, or `palm_x`, `palm_y`, `palm_z` | m per step | ±2 mm |
//! | `motor` | m per step | ±0.2 mm |
//!
//! # State, effort and design
//! Those of the hand's law, [`TendonHand`](hwasp_tasks::hand::TendonHand): motor travel and joint angles; joint torques and the motor's torque; twelve
//! parameters of the transmission. The controller never sees the joint angles: the real hand has no sensors for them.
//!
//! # Reward
//! -2·|palm - object|/m + 0.1·(distal links touching) + 0, 0.5, 1, 2 or 4 by the height of the object's lowest point.
//!
//! # Success
//! Over the last 100 steps the object stays 100 mm above the floor and within 10 mm of where it was in the hand, and thumb
//! and a finger touch it in at least 90 of them.
//!
//! # End
//! Truncated after 500 steps of 10 ms. An episode whose physics fail is discarded.

#![forbid(unsafe_code)]

mod carried_hand;
mod error;
mod film;
mod grasp;
mod hold;
mod object;
mod places;
mod plant;
mod problem;
mod script;
mod sensors;
mod settings;
mod task;

pub use carried_hand::CarriedHand;
pub use error::GraspError;
pub use film::{Film, Filmed, Stage, Still};
pub use grasp::Grasp;
pub use hold::Hold;
pub use object::Object;
pub use plant::{GraspPlant, yielding};
pub use problem::{engine, settings_of};
pub use script::Script;
pub use settings::{Bench, GraspReward, GraspSettings, Inertia, Ramp, ShapeKind, Viewpoint};
pub use task::GraspTask;
