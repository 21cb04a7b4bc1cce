//! `[controller]`: the network that commands the motors.

use hwasp_algos::{MOST_LAYERS, WIDEST_LAYER};
use hwasp_settings::{Fields, Settings, choice};

choice! {
    /// What follows each hidden layer.
    pub enum ActivationKind {
        /// Hyperbolic tangent.
        Tanh = "tanh",
        /// The positive part.
        Relu = "relu",
    }
}

/// `[controller]`.
#[derive(Clone, Debug, PartialEq)]
pub struct ControllerSettings {
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

impl ControllerSettings {
    /// The defaults for a controller of so many observations.
    pub(crate) fn new(observations: usize) -> Self {
        Self {
            hidden: vec![32, 32],
            activation: ActivationKind::Tanh,
            squash: true,
            observation_center: vec![0.0; observations],
            observation_scale: vec![1.0; observations],
            output_gain: 1.0,
        }
    }
}

impl Settings for ControllerSettings {
    fn fields(&mut self, fields: &mut Fields<'_, '_>) {
        fields.counts("hidden", &mut self.hidden, MOST_LAYERS, 1..=WIDEST_LAYER, "widths of the hidden layers");
        fields.choice("activation", &mut self.activation, "what follows each of them");
        fields.flag("squash", &mut self.squash, "tanh on the output, times the motor's range");
        fields.default("zeros").limits("SI, ±1e6");
        let about = "subtracted from the observation";
        fields.numbers("observation_center", &mut self.observation_center, -1e6..=1e6, about);
        fields.default("ones").limits("SI, 1e-6 to 1e6");
        fields.numbers("observation_scale", &mut self.observation_scale, 1e-6..=1e6, "and then divided by this");
        fields.number("output_gain", &mut self.output_gain, 0.0..=100.0, "scale of the last layer's initial weights");
    }
}
