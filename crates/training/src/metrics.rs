//! One row of a learning curve: what an iteration came to.

use hwasp_core::{NoiseSizes, bits};
use serde::{Deserialize, Serialize};

/// One iteration; what is not known is NaN.
#[derive(Clone, Debug, Serialize, Deserialize)]
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

impl MetricsRow {
    /// All but `iteration` and `env_steps`, in the order of the columns of `metrics.csv`.
    pub fn values(&self) -> impl Iterator<Item = f64> {
        let NoiseSizes { command, effort, design } = self.noise;
        let fixed = [self.wall_s, self.discounted_return, self.undiscounted_return, self.episodes, self.episode_steps];
        let own = self.learner.iter().chain(&self.terms).chain(&self.design_totals).copied();
        fixed.into_iter().chain([command, effort, design]).chain(own)
    }
}

/// To the bit; what both do not know is alike.
impl PartialEq for MetricsRow {
    fn eq(&self, other: &Self) -> bool {
        let counts = |row: &Self| (row.iteration, row.env_steps, row.learner.len(), row.terms.len());
        // Of what is not known there is but one kind.
        let bits = |value: f64| if value.is_nan() { f64::NAN } else { value }.to_bits();
        counts(self) == counts(other) && self.values().map(bits).eq(other.values().map(bits))
    }
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
