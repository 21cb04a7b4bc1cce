//! What can go wrong between this computer and a device.

use std::time::Duration;

use thiserror::Error;

/// Why a device did not do what it was asked. Each names the device and what was asked of it.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum DriverError {
    /// The line to the device: a port that is not there, a connection that broke.
    #[error("{device}: {what}: {cause}")]
    Line {
        /// The device, with its address.
        device: String,
        /// What was done.
        what: &'static str,
        /// The system's word.
        cause: String,
    },
    /// No answer in time.
    #[error("{device}: {what}: no answer within {} ms", waited.as_millis())]
    Timeout {
        /// The device, with its address.
        device: String,
        /// What was asked.
        what: &'static str,
        /// For how long.
        waited: Duration,
    },
    /// An answer that makes no sense: a wrong checksum, a length, a type.
    #[error("{device}: {what}: {cause}")]
    Protocol {
        /// The device, with its address.
        device: String,
        /// What was asked.
        what: &'static str,
        /// What is wrong with it.
        cause: String,
    },
    /// The device understood and does not want to.
    #[error("{device}: {what} was refused: {cause}")]
    Refused {
        /// The device, with its address.
        device: String,
        /// What was asked.
        what: &'static str,
        /// Its reason.
        cause: String,
    },
    /// A value that the device must not be sent: not a number, or beyond its limits.
    #[error("{device}: {name} = {value} is not {limits}")]
    Value {
        /// The device, with its address.
        device: String,
        /// What was to be sent.
        name: &'static str,
        /// Its value.
        value: f64,
        /// What can be.
        limits: String,
    },
}
