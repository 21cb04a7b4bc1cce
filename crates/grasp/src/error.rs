//! What can be wrong with a grasping task.

use hwasp_mujoco::engine::{BuildError, UnknownName};
use hwasp_tasks::hand::HandError;
use thiserror::Error;

/// Why settings make no grasping task.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum GraspError {
    /// The hand cannot be.
    #[error(transparent)]
    Hand(#[from] HandError),
    /// A range that is none, or beyond what there can be.
    #[error("{name} = {value} is not {limits}")]
    Setting {
        /// The field.
        name: &'static str,
        /// What was given.
        value: String,
        /// What can be.
        limits: &'static str,
    },
    /// The engine does not take the model.
    #[error(transparent)]
    Build(#[from] BuildError),
    /// Model and code do not fit.
    #[error(transparent)]
    Name(#[from] UnknownName),
}
