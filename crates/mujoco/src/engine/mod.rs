//! One model and its state: [`Simulation`].
//!
//! A simulation is built from an MJCF text, and belongs to one environment. Names are looked up once and give indices
//! ([`GeomId`], [`BodyId`], …), which hold for every simulation of the same text. Nothing here allocates after the
//! construction. SI units; forces in N and N·m, angles in rad, positions and forces of bodies in the world's frame.
//!
//! Three habits of the engine end here. When a state turns bad, the engine resets it and goes on; here that is a
//! [`PhysicsFault`]. The engine writes `MUJOCO_LOG.TXT` into the working directory; here it writes no file. Some edits of a
//! model make the engine end the process; here each of them is an [`EditError`].

mod contact;
mod edit;
mod fault;
mod log;
mod names;
#[cfg(feature = "renderer")]
mod picture;
mod shape;
mod simulation;

pub use contact::Contact;
pub use edit::{EditError, ModelEdit};
pub use fault::{PhysicsFault, Warning};
pub use names::{ActuatorId, BodyId, CameraId, GeomId, JointAddress, Kind, TendonId, UnknownName};
#[cfg(feature = "renderer")]
pub use picture::{Painter, PictureError};
pub use shape::Shape;
pub use simulation::{BuildError, Simulation, Wrench};
