//! How strongly each action component is explored.

use crate::environment::CommandPort;

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
        let done = ((progress - self.from) / (self.to - self.from).max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
        self.ratio.ln() * done
    }
}

/// Initial standard deviations of the parts of an action, and how they change.
#[derive(Clone, Debug, PartialEq)]
pub struct Noise {
    /// Of each command, as a fraction of the motor's range.
    pub command: f64,
    /// Of each effort, SI.
    pub effort: f64,
    /// Of each design parameter in the action, as a fraction of its range.
    pub design: f64,
    /// Schedule of the commands' noise.
    pub command_anneal: Option<Anneal>,
    /// Schedule of the efforts' noise.
    pub effort_anneal: Option<Anneal>,
    /// Schedule of the design's noise.
    pub design_anneal: Option<Anneal>,
    /// Whether the log standard deviations are parameters that are trained (on top of a schedule).
    pub train: bool,
}

impl Noise {
    /// Of one command, SI.
    pub(crate) fn command_std(&self, port: &CommandPort) -> f64 {
        self.command * (port.hi - port.lo)
    }
}
