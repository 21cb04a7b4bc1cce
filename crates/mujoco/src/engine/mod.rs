//! One model and its state: [`Simulation`].
//!
//! A simulation is built from an MJCF text, or from a [`Spec`] of several files whose numbers are set before it is compiled.
//! It belongs to one environment. Names are looked up once and give indices ([`GeomId`], [`BodyId`], …), which hold for
//! every simulation of the same text; an [`Inventory`] has all of them. Steps and readings allocate nothing. SI units;
//! forces in N and N·m, angles in rad, positions and forces of bodies in the world's frame.
//!
//! Four habits of the engine end here. When a state turns bad, the engine resets it and goes on; here that is a
//! [`PhysicsFault`]. The engine writes `MUJOCO_LOG.TXT` into the working directory; here it writes no file. Some edits of a
//! model make the engine end the process; here each of them is an [`EditError`] or a [`SpecError`]. The engine looks on the
//! disk for files that it is not given; here it reads [`Files`] and nothing else.

mod contact;
mod edit;
mod error;
mod fault;
mod files;
mod gap;
mod inventory;
mod log;
mod motion;
mod names;
#[cfg(feature = "renderer")]
mod picture;
mod quantity;
mod sensor;
mod shape;
mod simulation;
mod spec;
mod view;

pub use contact::{Contact, ContactForce};
pub use edit::{EditError, ModelEdit};
pub use error::BuildError;
pub use fault::{PhysicsFault, Warning};
pub use files::{FileError, Files};
pub use gap::Gap;
pub use inventory::{
    ActuatorEntry, BodyEntry, Drive, GeomEntry, Inventory, JointEntry, JointType, SensorEntry, SiteEntry, TendonEntry,
    TendonPath,
};
pub use motion::{Energy, StateSize, Twist};
pub use names::{
    ActuatorId, BodyId, CameraId, GeomId, JointAddress, KeyframeId, Kind, SensorId, SiteId, TendonId, UnknownName,
};
#[cfg(feature = "renderer")]
pub use picture::{Painter, PictureError};
pub use quantity::Quantity;
pub use shape::Shape;
pub use simulation::{Simulation, Wrench};
pub use spec::{Element, FieldPath, SettableField, Spec, SpecError, settable_fields};
pub use view::View;

/// The engine that is linked, and its version, as `MuJoCo 3.17.0`.
#[allow(unsafe_code)]
pub fn version() -> String {
    // SAFETY: it takes nothing and returns a constant text of the library, which ends with a zero byte.
    let text = unsafe { std::ffi::CStr::from_ptr(mujoco_rs::mujoco_c::mj_versionString()) };
    format!("MuJoCo {}", text.to_string_lossy())
}
