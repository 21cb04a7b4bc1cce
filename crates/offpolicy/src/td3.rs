//! Twin delayed deep deterministic policy gradients.

use hwasp_algos::{Exchange, Persist, StateError};
use hwasp_core::{Policy, Rows, share_left};
use hwasp_settings::{Fields, Settings};

use crate::config::ReplayConfig;
use crate::learner::OffPolicy;
use crate::rule::Rule;
use crate::scaling::{Affine, Scaling};

/// Twin delayed deep deterministic policy gradients (Fujimoto et al. 2018): what critics judge is the policy's mean, explored by
/// noise that is added to it.
pub type Td3<P> = OffPolicy<P, Td3Config>;

/// Settings of [`Td3`].
///
/// | name | default | purpose |
/// |---|---|---|
/// | `target_noise` | 0.2 | standard deviation of the noise of target actions, times half the range of a command, or twice the first noise of an effort |
/// | `target_noise_clip` | 0.5 | its largest size, in the same unit |
/// | `target_noise_final` | 1 | fraction of both left at the end of a linear decay |
#[derive(Clone, Debug, PartialEq)]
pub struct Td3Config {
    /// What it has in common with others.
    pub replay: ReplayConfig,
    /// σ̃ of target policy smoothing (Fujimoto et al. 2018, eq. 14).
    pub target_noise: f64,
    /// c of the same.
    pub target_noise_clip: f64,
    /// What fraction of both is left at the end: a policy that has to switch sharply is blurred by them.
    pub target_noise_final: f64,
}

impl Default for Td3Config {
    fn default() -> Self {
        Self {
            replay: ReplayConfig { policy_delay: 2, ..ReplayConfig::default() },
            target_noise: 0.2,
            target_noise_clip: 0.5,
            target_noise_final: 1.0,
        }
    }
}

impl Settings for Td3Config {
    fn fields(&mut self, fields: &mut Fields<'_, '_>) {
        self.replay.fields(fields);
        let about = "standard deviation of the noise of target actions, as a share of half the range of a command or of twice the first noise of an effort";
        fields.number("target_noise", &mut self.target_noise, 0.0..=10.0, about);
        fields.number("target_noise_clip", &mut self.target_noise_clip, 0.0..=10.0, "the largest size of that noise");
        let about = "fraction of both at the end of a linear decay";
        fields.number("target_noise_final", &mut self.target_noise_final, 0.0..=1.0, about);
    }
}

/// Nothing but settings: all that is learned is what all have.
impl Persist for Td3Config {
    fn exchange(&mut self, _: &mut Exchange<'_>) -> Result<(), StateError> {
        Ok(())
    }
}

impl<P: Policy> Rule<P> for Td3Config {
    const SLOW_POLICY: bool = true;
    const JUDGES: usize = 1;
    const METRICS: &'static [&'static str] = &["td_error", "value", "updates", "replay_steps"];

    fn replay(&self) -> &ReplayConfig {
        &self.replay
    }

    fn drawn(_: &P) -> usize {
        0
    }

    fn smoothing(&self, scaling: &Scaling, progress: f64) -> Vec<(f32, f32)> {
        let (noise, clip) = (self.target_noise as f32, self.target_noise_clip as f32);
        let left = share_left(self.target_noise_final, progress) as f32;
        let size = |a: &Affine| left * a.scale;
        scaling.action.iter().map(|a| (noise * size(a), clip * size(a))).collect()
    }

    fn act<'t>(policy: &P, rows: &Rows<'_>, _: &[f32], tape: &'t mut P::Tape) -> (&'t [f32], Option<&'t [f32]>) {
        (policy.forward(rows, tape), None)
    }

    fn pull(policy: &P, rows: &Rows<'_>, cotangent: &[f32], _: f32, tape: &mut P::Tape) {
        policy.vjp(rows, cotangent, tape);
    }

    fn temperature(&self) -> f32 {
        0.0
    }

    fn settle(&mut self, _: f64, _: f64) {}

    fn tell(&self, _: f64, _: f64) -> Vec<f64> {
        Vec::new()
    }
}
