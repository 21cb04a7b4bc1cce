//! What a worker says of itself.

use serde::{Deserialize, Serialize};

use crate::identity::Identity;

/// A worker, as it answers whoever calls.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Card {
    /// Its name.
    pub name: String,
    /// What its bits depend on.
    pub identity: Identity,
    /// Jobs at once.
    pub threads: usize,
    /// Seconds since it began.
    pub up_s: f64,
    /// Jobs answered.
    pub jobs: u64,
    /// Seconds that they took, those at work not counted.
    pub busy_s: f64,
    /// Whether it takes no further jobs.
    pub draining: bool,
    /// What it is at.
    pub at_work: Vec<AtWork>,
}

/// A job at work.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct AtWork {
    /// Its name.
    pub job: String,
    /// The run that it is of.
    pub run: String,
    /// Episodes, candidate or training.
    pub kind: String,
    /// Seconds so far.
    pub seconds: f64,
}
