//! How strongly each action component is explored.

use serde::{Deserialize, Serialize};

use crate::bits;
use crate::schedule::share_done;

/// A change of the noise over training: geometric from 1 to `ratio` between two fractions of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Anneal {
    /// Final over initial standard deviation.
    pub ratio: f64,
    /// The fraction of training where it begins to change.
    pub from: f64,
    /// The fraction where it has changed.
    pub to: f64,
}

impl Anneal {
    /// What is added to the log standard deviation at `progress`.
    pub fn log_offset(&self, progress: f64) -> f64 {
        self.ratio.ln() * share_done(progress, self.from, self.to)
    }
}

/// A standard deviation and how it changes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spread {
    /// At the start.
    pub std: f64,
    /// Its schedule.
    pub anneal: Option<Anneal>,
}

impl From<f64> for Spread {
    fn from(std: f64) -> Self {
        Self { std, anneal: None }
    }
}

/// How strongly the parts of an action are explored.
#[derive(Clone, Debug, PartialEq)]
pub struct Noise {
    /// Of each command, as a fraction of its motor's range.
    pub command: Vec<Spread>,
    /// Of each effort, SI; needed where efforts are sampled, with a design parameter in the graph.
    pub effort: Vec<Spread>,
    /// Of each design parameter that is sampled, at every step or once an episode, as a fraction of its range.
    pub design: Spread,
    /// Whether the log standard deviations are parameters that are trained (on top of a schedule).
    pub train: bool,
}

/// How strongly the parts of an action are explored at a moment of the training: standard deviations, the mean over the components
/// of a kind; NaN where the action has none.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct NoiseSizes {
    /// Of commands, as a fraction of the motor's range.
    #[serde(with = "bits")]
    pub command: f64,
    /// Of efforts, SI.
    #[serde(with = "bits")]
    pub effort: f64,
    /// Of design parameters that are sampled, as a fraction of their range.
    #[serde(with = "bits")]
    pub design: f64,
}

/// Of nothing.
impl Default for NoiseSizes {
    fn default() -> Self {
        Self { command: f64::NAN, effort: f64::NAN, design: f64::NAN }
    }
}
