//! The hand on the bench: what of it is printed in a workshop, what is bought, and what that takes.
//!
//! A [`Workshop`] says what is bought and what the printer can do. [`parts`] makes the solids of a design for it and the springs
//! that were chosen; [`scad`] says the same shapes by parameters. [`link_bodies`] says what links weigh, [`droop_of`] whether they stay
//! open, and [`verdict`] whether the hand can be built. [`package`] is what a workshop gets: [`Bill`], assembly in [`steps`], drawings.

#![forbid(unsafe_code)]

mod assembly;
mod bill;
mod bodies;
mod bought;
mod drawing;
mod droop;
mod error;
mod package;
mod parts;
mod solid;
mod step;
mod verdict;
mod workshop;

pub use assembly::{LegHoles, Step, assembly_sheet, steps, unmatched};
pub use bill::{Bill, Item, Origin, Printing};
pub use bodies::{LinkBody, link_bodies, pads};
pub use bought::{Axle, Clip, MOTOR_MASS, PAD_FRICTION, Pad};
pub use droop::{JointDroop, droop_of};
pub use error::PartError;
pub use package::{PackageFile, bill, package, step_files};
pub use parts::{Filling, Part, Weight, coupon, parts, scad};
pub use solid::{Axis, Mesh, MeshError, Wall};
pub use step::step;
pub use verdict::{Finding, FittedSpring, LEAST_WALL, MASS_SHARE, Verdict, verdict};
pub use workshop::{SeatedSpring, Workshop};
