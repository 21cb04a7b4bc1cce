//! Errors of problems.

/// Whatever a problem finds wrong.
pub type AnyError = Box<dyn std::error::Error + Send + Sync>;
