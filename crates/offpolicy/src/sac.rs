//! Soft actor-critic.

use hwasp_algos::{Adam, AdamConfig, Exchange, Persist, RATES, StateError};
use hwasp_core::{Reparameterised, Rows, share_left};
use hwasp_settings::{Fields, Settings};

use crate::config::ReplayConfig;
use crate::learner::OffPolicy;
use crate::rule::Rule;
use crate::scaling::Scaling;

/// Soft actor-critic with a temperature that is learned (Haarnoja et al. 2018, second version): the controller tells how widely its
/// commands spread, and entropy is worth something.
///
/// Entropy is that of the commands. Efforts, which the law makes of them, and what is sampled of a design have the noise that the
/// experiment gives them.
pub type Sac<P> = OffPolicy<P, SacRule>;

/// Settings of [`Sac`].
///
/// | name | default | purpose |
/// |---|---|---|
/// | `temperature` | 0.02 | α at first, in units of [`value_scale`](ReplayConfig::value_scale) |
/// | `train_temperature` | true | whether it is learned |
/// | `temperature_learning_rate` | 3e-4 | step size of Adam for log α |
/// | `target_entropy` | -1 | entropy that it is learned for, in nats for each command |
/// | `target_entropy_fall` | 0 | nats that this has fallen by at the end of the training |
#[derive(Clone, Debug, PartialEq)]
pub struct SacConfig {
    /// What it has in common with others.
    pub replay: ReplayConfig,
    /// α at first, in units of [`value_scale`](ReplayConfig::value_scale): what a nat of entropy is worth.
    pub temperature: f64,
    /// Whether it is learned (eq. 18).
    pub train_temperature: bool,
    /// Step size of Adam for log α.
    pub temperature_learning_rate: f64,
    /// H̄ for each command, in nats, of densities over [-1, 1].
    pub target_entropy: f64,
    /// By how much H̄ falls, evenly over the training: what is explored widely at first is done firmly in the end.
    pub target_entropy_fall: f64,
}

impl Default for SacConfig {
    fn default() -> Self {
        Self {
            replay: ReplayConfig { policy_delay: 1, ..ReplayConfig::default() },
            temperature: 0.02,
            train_temperature: true,
            temperature_learning_rate: 3e-4,
            target_entropy: -1.0,
            target_entropy_fall: 0.0,
        }
    }
}

impl Settings for SacConfig {
    fn fields(&mut self, fields: &mut Fields<'_, '_>) {
        self.replay.fields(fields);
        let about = "what a nat of entropy is worth at first, in units of `value_scale`";
        fields.number("temperature", &mut self.temperature, 1e-9..=1e3, about);
        fields.flag("train_temperature", &mut self.train_temperature, "whether the temperature is learned");
        let about = "Adam's, for the logarithm of the temperature";
        fields.number("temperature_learning_rate", &mut self.temperature_learning_rate, RATES, about);
        let about = "entropy that the temperature is learned for, in nats for each command, of densities over [-1, 1]";
        fields.number("target_entropy", &mut self.target_entropy, -10.0..=0.7, about);
        let about = "nats that this has fallen by at the end of the training, evenly";
        fields.number("target_entropy_fall", &mut self.target_entropy_fall, 0.0..=10.0, about);
    }
}

/// Settings, and the temperature.
#[derive(Clone, Debug)]
pub struct SacRule {
    config: SacConfig,
    /// Commands that entropy is of.
    commands: usize,
    log_temperature: Vec<f32>,
    adam: Adam,
}

impl SacRule {
    /// At the beginning, for a policy of so many commands.
    pub(crate) fn new(config: SacConfig, commands: usize) -> Self {
        let log_temperature = vec![config.temperature.ln() as f32];
        Self { config, commands, log_temperature, adam: Adam::new(AdamConfig::default(), 1) }
    }
}

impl Persist for SacRule {
    fn exchange(&mut self, with: &mut Exchange<'_>) -> Result<(), StateError> {
        with.vector("log_temperature", &mut self.log_temperature)?;
        with.part("temperature_adam", &mut self.adam)
    }
}

impl<P: Reparameterised> Rule<P> for SacRule {
    const SLOW_POLICY: bool = false;
    const JUDGES: usize = 2;
    const METRICS: &'static [&'static str] =
        &["td_error", "value", "updates", "replay_steps", "command_entropy", "temperature"];

    fn replay(&self) -> &ReplayConfig {
        &self.config.replay
    }

    fn drawn(policy: &P) -> usize {
        policy.drawn_commands()
    }

    fn smoothing(&self, _: &Scaling, _: f64) -> Vec<(f32, f32)> {
        Vec::new()
    }

    fn act<'t>(policy: &P, rows: &Rows<'_>, noise: &[f32], tape: &'t mut P::Tape) -> (&'t [f32], Option<&'t [f32]>) {
        let (actions, log_prob) = policy.sample(rows, noise, tape);
        (actions, Some(log_prob))
    }

    fn pull(policy: &P, rows: &Rows<'_>, cotangent: &[f32], of_log_prob: f32, tape: &mut P::Tape) {
        policy.vjp_sample(rows, cotangent, of_log_prob, tape);
    }

    fn temperature(&self) -> f32 {
        self.log_temperature[0].exp()
    }

    /// J(log α) = -log α·(log π + H̄): the form that stays steep for small α.
    fn settle(&mut self, log_prob: f64, progress: f64) {
        if self.config.train_temperature {
            let each = self.config.target_entropy - self.config.target_entropy_fall * progress;
            let wanted = each * self.commands as f64;
            let decay = share_left(self.config.replay.learning_rate_final, progress);
            let rate = (self.config.temperature_learning_rate * decay) as f32;
            self.adam.step(&mut self.log_temperature, &[-(log_prob + wanted) as f32], &[rate]);
        }
    }

    fn tell(&self, log_prob: f64, value_scale: f64) -> Vec<f64> {
        vec![-log_prob, value_scale * f64::from(self.log_temperature[0].exp())]
    }
}
