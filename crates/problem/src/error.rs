//! Errors of problems.

use thiserror::Error;

/// A problem cannot be built from settings whose faults were told while they were read, each at its place. Nothing more is told.
#[derive(Clone, Copy, Debug, Error)]
#[error("its settings have faults")]
pub struct FaultsTold;

/// Whatever a problem finds wrong.
pub type AnyError = Box<dyn std::error::Error + Send + Sync>;
