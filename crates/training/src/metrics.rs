//! One row of a learning curve: what an iteration came to.

use hwasp_core::{NoiseSizes, bits};
use serde::{Deserialize, Serialize};

/// One iteration; what is not known is NaN.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct MetricsRow {
    /// Updates before this row, from 0.
    pub iteration: u64,
    /// Real simulator steps so far.
    pub env_steps: u64,
    /// Time since training began, s.
    #[serde(with = "bits")]
    pub wall_s: f64,
    /// Mean discounted return of this iteration's training episodes.
    #[serde(with = "bits")]
    pub discounted_return: f64,
    /// Mean undiscounted return of the same episodes (column `return`).
    #[serde(with = "bits")]
    pub undiscounted_return: f64,
    /// Training episodes that came to their end in this iteration: the returns are their means.
    #[serde(default = "unknown", with = "bits")]
    pub episodes: f64,
    /// Their mean length, steps.
    #[serde(default = "unknown", with = "bits")]
    pub episode_steps: f64,
    /// How strongly the policy explores after the update; all NaN in a search, whose noise is in the parameters.
    #[serde(default)]
    pub noise: NoiseSizes,
    /// One per metric of the learner, in the order of their names ([`Event::Started`](crate::Event)); none in a search.
    #[serde(with = "bits")]
    pub learner: Vec<f64>,
    /// What each named term of the reward came to in these episodes, on average, in the order of the names; they add up to the
    /// undiscounted return.
    #[serde(default, with = "bits")]
    pub terms: Vec<f64>,
    /// One per design total of the table, in its order, SI.
    #[serde(with = "bits")]
    pub design_totals: Vec<f64>,
}

/// Nothing is known.
impl Default for MetricsRow {
    fn default() -> Self {
        Self {
            iteration: 0,
            env_steps: 0,
            wall_s: f64::NAN,
            discounted_return: f64::NAN,
            undiscounted_return: f64::NAN,
            episodes: f64::NAN,
            episode_steps: f64::NAN,
            noise: NoiseSizes::default(),
            learner: Vec::new(),
            terms: Vec::new(),
            design_totals: Vec::new(),
        }
    }
}

/// What a row of an earlier version has not.
fn unknown() -> f64 {
    f64::NAN
}
