//! What can be wrong with a hand.

use hwasp_core::DesignError;
use thiserror::Error;

/// Why numbers do not describe a hand.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum HandError {
    /// A number that has to be positive is not.
    #[error("{name} = {value} {unit} is not a positive finite number")]
    NotPositive {
        /// Which.
        name: String,
        /// What it is.
        value: f64,
        /// In this unit.
        unit: &'static str,
    },
    /// A number outside of its limits.
    #[error("{name} = {value} {unit} is outside of [{lo}, {hi}]; choose it between them")]
    Outside {
        /// Which.
        name: String,
        /// What it is.
        value: f64,
        /// The least it may be.
        lo: f64,
        /// The most it may be.
        hi: f64,
        /// In this unit.
        unit: &'static str,
    },
    /// Principal moments of inertia that no rigid body has.
    #[error("{name} = {inertia:?} kg·m²: the largest is above the sum of the others, which no rigid body has")]
    Inertia {
        /// Whose.
        name: String,
        /// The three.
        inertia: [f64; 3],
    },
    /// Limits or starts of the design parameters.
    #[error(transparent)]
    Design(#[from] DesignError),
}

/// A positive finite number, or an error that names it.
pub fn positive(name: &str, value: f64, unit: &'static str) -> Result<(), HandError> {
    if value.is_finite() && value > 0.0 {
        return Ok(());
    }
    Err(HandError::NotPositive { name: name.to_owned(), value, unit })
}

/// A number in `[lo, hi]`, or an error that names it. NaN is outside.
pub fn within(name: &str, value: f64, lo: f64, hi: f64, unit: &'static str) -> Result<(), HandError> {
    if (lo..=hi).contains(&value) {
        return Ok(());
    }
    Err(HandError::Outside { name: name.to_owned(), value, lo, hi, unit })
}
