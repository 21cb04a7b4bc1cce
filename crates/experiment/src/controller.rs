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
    /// Whether centre and scale are the mean and deviation of what was observed so far in training.
    pub normalize_observations: bool,
    /// Where they are, how far from zero what the network sees may be.
    pub observation_clip: f64,
    /// Whether it sees the design beside the observation.
    pub sees_design: bool,
    /// Scale of the last layer's initial weights.
    pub output_gain: f64,
    /// The method, where it searches the controller's parameters and no training gathers statistics; none once it is judged.
    searched_by: Option<&'static str>,
}

impl ControllerSettings {
    /// The defaults for a controller of so many observations. `searched_by`: the method that searches its parameters.
    pub(crate) fn new(observations: usize, searched_by: Option<&'static str>) -> Self {
        Self {
            hidden: vec![32, 32],
            activation: ActivationKind::Tanh,
            squash: true,
            observation_center: vec![0.0; observations],
            observation_scale: vec![1.0; observations],
            normalize_observations: false,
            observation_clip: 10.0,
            sees_design: false,
            output_gain: 1.0,
            searched_by,
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
        let about = "whether running mean and deviation of what was observed in training are centre and scale";
        fields.flag("normalize_observations", &mut self.normalize_observations, about);
        let about = "where they are, the controller sees nothing beyond plus or minus this";
        fields.number("observation_clip", &mut self.observation_clip, 0.1..=1e6, about);
        let about = "whether it sees the design as well, each parameter scaled to ±1 by its limits: what was drawn for the episode, or \
                     what the parameter is at the time";
        fields.flag("sees_design", &mut self.sees_design, about);
        fields.number("output_gain", &mut self.output_gain, 0.0..=100.0, "scale of the last layer's initial weights");
        if self.normalize_observations {
            self.check_normalization(fields);
        }
        self.searched_by = None;
    }
}

impl ControllerSettings {
    fn check_normalization(&self, fields: &mut Fields<'_, '_>) {
        let own = self.observation_center.iter().any(|&center| center != 0.0)
            || self.observation_scale.iter().any(|&scale| scale != 1.0);
        fields.check("normalize_observations", !own, || {
            (
                "controller.normalize_observations = true, and controller.observation_center or controller.observation_scale \
                 says how observations are scaled"
                    .into(),
                "leave normalize_observations out, or center and scale (zeros and ones)".into(),
            )
        });
        let by = self.searched_by.unwrap_or_default();
        fields.check("normalize_observations", self.searched_by.is_none(), || {
            (
                format!("controller.normalize_observations = true, but {by} searches without a training that gathers statistics"),
                format!(
                    "write normalize_observations = false below [methods.{by}.controller]; ars.variant = \"v2\" and \"v2-t\" \
                     have a filter of their own, and cmaes can be given controller.observation_scale"
                ),
            )
        });
    }
}
