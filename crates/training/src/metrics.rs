//! What an iteration is told by: one row of a learning curve.

/// One iteration; what is not known is NaN.
#[derive(Clone, Debug, PartialEq)]
pub struct MetricsRow {
    /// Updates before this row, from 0.
    pub iteration: u64,
    /// Real simulator steps so far.
    pub env_steps: u64,
    /// Time since training began, s.
    pub wall_s: f64,
    /// Mean discounted return of this iteration's training episodes.
    pub discounted_return: f64,
    /// Mean undiscounted return of the same episodes (column `return`).
    pub undiscounted_return: f64,
    /// Mean KL divergence of the update, nat.
    pub kl: f64,
    /// Entropy of the policy, nat.
    pub entropy: f64,
    /// Share of TRPO's full step that was taken, 0 for none; 1 for PPO, NaN for searches.
    pub step_fraction: f64,
    /// One per design total of the table, in its order, SI.
    pub design_totals: Vec<f64>,
}
