//! Grasping with the underactuated hand, as far as it needs no engine: its settings, what its environments look like from
//! outside, and its [`Problem`](hwasp_problem::Problem). The physics are in `hwasp-mujoco`.

mod bench;
mod carried;
mod env;
mod manual;
mod problem;
pub mod rules;
mod settings;
mod targets;

pub use bench::{Bench, ObjectSensed, TravelSensed};
pub use carried::CarriedObject;
pub use env::env_spec;
pub use problem::{Engine, GraspProblem, Scene};
pub use settings::{GraspTaskSettings, HandRangeKind, Inertia, ShapeKind, Viewpoint};
pub use targets::{Bounds, Targets};
