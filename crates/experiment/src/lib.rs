//! Experiment files. [`resolve`] makes of them an [`Experiment`] in which every setting has a value, or a list of all faults.
//!
//! An experiment names problems and learners. A [`Catalogue`] has those that can be named; it is a value that the caller
//! hands over. An experiment has layers, and later ones win: the file; its `[methods.<method>]` tables, which hold the same
//! tables as the file; and what the command line sets.

#![forbid(unsafe_code)]

mod built;
mod catalogue;
mod controller;
mod design;
mod efforts;
mod experiment;
mod group;
mod initial;
mod learner;
mod load;
mod method;
mod noise;
mod placements;
mod polish;
mod reference;
mod search;
mod task;
mod train;

pub use built::{MOST_GROUPS, MOST_STEPS, total_name};
pub use catalogue::{Catalogue, CatalogueError};
pub use controller::{ActivationKind, ControllerSettings};
pub use design::DesignSettings;
pub use experiment::{Experiment, resolve};
pub use group::{Group, Place};
pub use hwasp_settings::{Choice, Excerpt, Fault, Faults, Files, Folder, LONGEST_FILE, Layers};
pub use initial::{InitialDesign, InitialValue};
pub use learner::LearnerSettings;
pub use load::{EXPERIMENT, load};
pub use method::Method;
pub use noise::NoiseSettings;
pub use placements::PlacedRange;
pub use polish::{PolishSettings, PolishWorld};
pub use reference::{reference, schema};
pub use search::{MOST_CORRELATED, MOST_MODELLED, Score, SearchSettings};
pub use task::Task;
pub use train::TrainSettings;
