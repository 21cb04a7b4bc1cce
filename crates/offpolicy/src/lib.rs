//! Learners that live on old experience.
//!
//! With the mechanism in the policy, the action is what the mechanism does to the world: a force, with the commands that pass it
//! by. A step that was taken is a fact about the world, and it stays true while the design moves. So a replay serves co-design as
//! well as it serves control.

#![forbid(unsafe_code)]

mod config;
mod critic;
mod design;
mod earned;
mod kind;
mod learner;
mod replay;
mod rule;
mod sac;
mod sample;
mod scaling;
mod td3;
mod watch;
mod worker;

pub use config::ReplayConfig;
pub use kind::{SacKind, Td3Kind};
pub use learner::OffPolicy;
pub use sac::{Sac, SacConfig, SacRule};
pub use td3::{Td3, Td3Config};
