//! Any robot from two files: a model (MJCF or URDF), and an experiment that says in formulas what is seen, what is rewarded,
//! where an episode starts and ends, the law of the hardware and its design.
//!
//! ```toml
//! [task]
//! problem = "model"
//! model = "hopper.xml"
//! frame_skip = 4
//! observe = ["joint.*.pos[1:]", "clip(joint.*.vel, -10, 10)"]
//! ends = "body.torso.pos.z < 0.7 m"
//!
//! [task.reward]
//! forward = "joint.rootx.vel"
//! effort = "-1e-3 * sum(command^2)"
//!
//! [task.law]
//! "joint.leg_joint" = "gear * command.leg_joint - stiffness * (joint.leg_joint.pos - rest)"
//!
//! [task.design]
//! gear = { limits = [50, 300] }
//! stiffness = { limits = [0, "200 N*m/rad"] }
//! rest = { limits = ["-1 rad", "0.5 rad"] }
//! ```
//!
//! Formulas are read by `hwasp-expr`, models by the engine. What comes of both is one program for everything that is computed
//! after a step, one for the law, and one for each thing that happens when an episode starts. A step allocates nothing.

#![forbid(unsafe_code)]

mod anatomy;
mod begin;
mod body;
mod changes;
mod columns;
mod compile;
mod corners;
mod delay;
mod environment;
mod held;
mod manual;
mod names;
mod parameter;
mod problem;
mod ready;
mod reference;
mod robot;
mod settings;
mod source;
mod texts;

pub use parameter::{Amount, Command, Limits, Parameter};
pub use problem::ModelProblem;
pub use reference::{reference, settable};
pub use settings::{Base, ModelSettings, Readings};
