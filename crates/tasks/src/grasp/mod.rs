//! Grasping with the underactuated hand: what of it needs no engine. What its settings are, what its environments are from
//! outside, and its door to experiment files; the physics are in `hwasp-mujoco`.

mod env;
mod problem;
mod settings;

pub use env::env_spec;
pub use problem::{Engine, GraspProblem, Scene};
pub use settings::{GraspTaskSettings, HandRangeKind, Inertia, ShapeKind, Viewpoint};
