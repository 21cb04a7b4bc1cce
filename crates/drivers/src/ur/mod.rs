//! An arm of Universal Robots, CB3 or e-Series: RTDE for its state and its orders, a program of our own on its controller, and
//! its dashboard. Protocol, registers and what happens on faults: `docs/deploy_arm.md`.

mod dashboard;
mod drive;
mod facts;
mod field;
mod late;
mod link;
mod reading;
pub mod registers;
mod script;
mod settings;
mod stuck;
mod talk;
mod tcp;
pub mod wire;

pub use dashboard::Dashboard;
pub use drive::UrArm;
pub use facts::UrFacts;
pub use field::FieldType;
pub use reading::Reading;
pub use script::program;
pub use settings::{Payload, PoseLimits, UrSettings};
