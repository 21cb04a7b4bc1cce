//! One row of a learning curve: what an iteration came to.

use hwasp_core::bits;
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
