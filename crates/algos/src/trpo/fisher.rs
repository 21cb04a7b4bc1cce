//! The curvature of the divergence between policies.

use hwasp_core::{Executor, Policy};

use super::passes::Passes;
use crate::minibatch::Minibatch;

/// H of mean KL(old || new) ≈ ½·xᵀHx (appendix C): the Fisher information matrix, by exact differentiation and never as a
/// matrix.
///
/// For a diagonal Gaussian it is Jᵀ·M·J with J the derivative of the means and M = diag(1/σ²)/N, and 2 for each log
/// standard deviation, which no row changes. Both are exact: at the old policy the rest of the second derivative vanishes.
/// What is drawn once an episode counts once an episode: with the row's share of its draw in M, and 2·draws/N.
pub(super) struct Fisher<'a, P: Policy> {
    passes: &'a Passes<P>,
    rows: &'a Minibatch,
    params: &'a [f32],
    /// 1/(N·σ²) of each action component.
    weight: Vec<f32>,
}

impl<'a, P: Policy> Fisher<'a, P> {
    /// At `params`, over these rows.
    pub(super) fn new(passes: &'a Passes<P>, rows: &'a Minibatch, params: &'a [f32], progress: f64) -> Self {
        let mut log_std = vec![0.0; passes.policy().action_dim()];
        passes.policy().log_std(params, progress, &mut log_std);
        let n = rows.count.max(1) as f64;
        let weight = log_std.iter().map(|&s| ((-2.0 * f64::from(s)).exp() / n) as f32).collect();
        Self { passes, rows, params, weight }
    }

    /// Writes H·v into `product`.
    pub(super) fn product(&self, executor: &dyn Executor, v: &[f64], product: &mut [f64]) {
        let tangent: Vec<f32> = v.iter().map(|&v| v as f32).collect();
        self.passes.gauss_newton(executor, self.rows, self.params, &tangent, &self.weight, product);
        if let Some(range) = self.passes.policy().log_std_params() {
            let drawn = self.passes.policy().drawn_actions();
            let draws = self.rows.draws.count() / self.rows.count.max(1) as f64;
            for (j, (to, v)) in product[range.clone()].iter_mut().zip(&v[range]).enumerate() {
                *to = if j < drawn { 2.0 * draws * v } else { 2.0 * v };
            }
        }
    }
}
