//! `[controller]`: the network that commands the motors.

use serde::Serialize;

use super::names::named;
use super::section::Section;

/// The most hidden layers of a network.
pub const MOST_LAYERS: usize = 16;
/// The widest hidden layer.
pub const WIDEST_LAYER: usize = 4096;

named! {
    /// What follows each hidden layer.
    pub enum ActivationKind {
        /// Hyperbolic tangent.
        Tanh = "tanh",
        /// The positive part.
        Relu = "relu",
    }
}

/// `[controller]`.
///
/// | key | default | meaning | limits |
/// |---|---|---|---|
/// | `hidden` | [32, 32] | widths of the hidden layers | up to 16 of 1 to 4096 |
/// | `activation` | "tanh" | `tanh` or `relu` | |
/// | `squash` | true | tanh on the output, times the motor's range | |
/// | `observation_center` | zeros | subtracted from the observation | SI, ±1e6 |
/// | `observation_scale` | ones | and then divided by this | SI, 1e-6 to 1e6 |
/// | `output_gain` | 1.0 | scale of the last layer's initial weights | 0 to 100 |
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ControllerSpec {
    /// Widths of the hidden layers.
    pub hidden: Vec<usize>,
    /// What follows each of them.
    pub activation: ActivationKind,
    /// Whether a tanh keeps the output inside of the motors' range.
    pub squash: bool,
    /// Subtracted from each observation, SI.
    pub observation_center: Vec<f64>,
    /// Divides what is left, SI.
    pub observation_scale: Vec<f64>,
    /// Scale of the last layer's initial weights.
    pub output_gain: f64,
}

impl ControllerSpec {
    /// Reads the table for a controller of so many observations.
    pub(super) fn read(mut s: Section<'_>, observations: usize) -> Self {
        let spec = Self {
            hidden: s.counts("hidden", &[32, 32], MOST_LAYERS, &(1..=WIDEST_LAYER)),
            activation: s.choice("activation", ActivationKind::ALL).unwrap_or(ActivationKind::Tanh),
            squash: s.flag("squash", true),
            observation_center: s.numbers("observation_center", 0.0, observations, &(-1e6..=1e6)),
            observation_scale: s.numbers("observation_scale", 1.0, observations, &(1e-6..=1e6)),
            output_gain: s.number("output_gain", 1.0, 0.0..=100.0),
        };
        s.finish();
        spec
    }
}
