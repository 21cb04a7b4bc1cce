//! Table 1 of the tutorial: what follows from the dimension and the population.

use super::CmaesConfig;

/// Weights and learning rates of a run.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Constants {
    /// λ.
    pub(super) popsize: usize,
    /// μ, how many weights are positive.
    pub(super) mu: usize,
    /// `w_i`, the best candidate's first; the positive ones sum to 1.
    pub(super) weights: Vec<f64>,
    /// Σ `w_i`.
    pub(super) weight_sum: f64,
    /// Learning rate of the mean.
    pub(super) c_m: f64,
    /// Of the path behind the step size.
    pub(super) c_sigma: f64,
    /// Damping of the step size.
    pub(super) d_sigma: f64,
    /// Of the path behind the rank-one update.
    pub(super) c_c: f64,
    /// Of the rank-one update.
    pub(super) c_1: f64,
    /// Of the rank-μ update.
    pub(super) c_mu: f64,
    /// E‖N(0, I)‖.
    pub(super) chi_n: f64,
    /// Generations between decompositions.
    pub(super) eigen_gap: u64,
}

/// 1/Σw² of weights scaled to sum 1.
pub(super) fn effective(weights: &[f64]) -> f64 {
    let sum: f64 = weights.iter().sum();
    sum * sum / weights.iter().map(|w| w * w).sum::<f64>()
}

impl Constants {
    pub(super) fn new(config: &CmaesConfig, dimension: usize, popsize: usize) -> Self {
        let n = dimension as f64;
        let lambda = popsize as f64;
        let raw: Vec<f64> = (1..=popsize).map(|i| (f64::midpoint(lambda, 1.0) / i as f64).ln()).collect(); // (49)
        let mu = popsize / 2;
        let mu_eff = effective(&raw[..mu]);
        let mu_eff_minus = effective(&raw[mu..]);

        let c_sigma = (mu_eff + 2.0) / (n + mu_eff + 5.0); // (55)
        let d_sigma = 1.0 + 2.0 * (((mu_eff - 1.0) / (n + 1.0)).sqrt() - 1.0).max(0.0) + c_sigma; // (55)
        let c_c = (4.0 + mu_eff / n) / (n + 4.0 + 2.0 * mu_eff / n); // (56)
        // Ros and Hansen 2008, section 3: n + 2 instead of (n + 2)(n + 1)/2 numbers to learn allow a faster rate.
        let faster = if config.separable { (n + 2.0) / 3.0 } else { 1.0 };
        let alpha_cov = 2.0;
        let c_1 = (faster * alpha_cov / ((n + 1.3).powi(2) + mu_eff)).min(1.0); // (57)
        let c_mu =
            faster * alpha_cov * (0.25 + mu_eff + 1.0 / mu_eff - 2.0) / ((n + 2.0).powi(2) + alpha_cov * mu_eff / 2.0); // (58)
        let c_mu = c_mu.min(1.0 - c_1);

        let alpha_mu = 1.0 + c_1 / c_mu; // (50)
        let alpha_mu_eff = 1.0 + 2.0 * mu_eff_minus / (mu_eff + 2.0); // (51)
        let alpha_pos_def = (1.0 - c_1 - c_mu) / (n * c_mu); // (52)
        let positive: f64 = raw[..mu].iter().sum();
        let negative: f64 = -raw[mu..].iter().sum::<f64>();
        let alpha = if config.active { alpha_mu.min(alpha_mu_eff).min(alpha_pos_def) } else { 0.0 };
        let weights: Vec<f64> = raw
            .iter()
            .enumerate()
            .map(|(i, w)| if i < mu { w / positive } else { w * alpha / negative }) // (53)
            .collect();

        // Appendix B.2, rounded up as `cma` does: the cost of a decomposition is spread over so many generations that it
        // is O(n²) for each.
        let eigen_gap = (1.0 / (10.0 * n * (c_1 + c_mu))).ceil() as u64;
        Self {
            popsize,
            mu,
            weight_sum: weights.iter().sum(),
            weights,
            c_m: 1.0, // (54)
            c_sigma,
            d_sigma,
            c_c,
            c_1,
            c_mu,
            chi_n: n.sqrt() * (1.0 - 1.0 / (4.0 * n) + 1.0 / (21.0 * n * n)),
            eigen_gap,
        }
    }
}
