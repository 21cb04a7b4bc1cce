//! What tells one off-policy learner from another.

use hwasp_algos::Persist;
use hwasp_core::{Policy, Rows};

use crate::config::ReplayConfig;
use crate::scaling::Scaling;

/// How actions come from the policy, what they are judged by, and what else is learned. All the rest is the same for all:
/// replay, critics, their targets, jobs.
pub(crate) trait Rule<P: Policy>: Persist + Clone + Send + Sync {
    /// Whether the actions at the next moments come from a copy of the policy that follows it slowly.
    const SLOW_POLICY: bool;
    /// How many critics judge the policy's own actions: the least of them counts.
    const JUDGES: usize;
    /// What an update tells.
    const METRICS: &'static [&'static str];

    /// The settings that all have.
    fn replay(&self) -> &ReplayConfig;

    /// Standard normal numbers that the actions of one row take.
    fn drawn(policy: &P) -> usize;

    /// Spread and largest size of what is added to the actions at the next moments, for each component, at `progress` of the
    /// training; nothing is where it is empty.
    fn smoothing(&self, scaling: &Scaling, progress: f64) -> Vec<(f32, f32)>;

    /// The policy's actions in a block `[A × tape rows]` and their log-probabilities, where entropy counts.
    fn act<'t>(policy: &P, rows: &Rows<'_>, noise: &[f32], tape: &'t mut P::Tape) -> (&'t [f32], Option<&'t [f32]>);

    /// Adds the gradient of Σ cotangent·action + `of_log_prob`·Σ log-probability of the last [`act`](Self::act).
    fn pull(policy: &P, rows: &Rows<'_>, cotangent: &[f32], of_log_prob: f32, tape: &mut P::Tape);

    /// What a nat of entropy is worth, in the unit of the critics.
    fn temperature(&self) -> f32;

    /// A gradient step of the policy was taken, on actions of this mean log-probability. The training is at
    /// `progress`.
    fn settle(&mut self, log_prob: f64, progress: f64);

    /// What it tells beside the rest, at the end of [`METRICS`](Self::METRICS): `log_prob` is the mean over the update.
    fn tell(&self, log_prob: f64, value_scale: f64) -> Vec<f64>;
}
