//! Settings.

use hwasp_core::{Stream, share_left};
use rand::RngExt;
use serde::{Deserialize, Serialize};

use crate::baseline::BaselineConfig;
use crate::gae::AdvantageConfig;

/// Settings of [`Trpo`](super::Trpo).
///
/// | name | default | purpose |
/// |---|---|---|
/// | `advantages` | see [`AdvantageConfig`] | how rewards become advantages |
/// | `max_kl` | 0.01 | δ, the most mean KL divergence of an update |
/// | `max_kl_final` | 1 | fraction of it left at the end of a linear decay |
/// | `cg_iterations` | 10 | most steps of conjugate gradients |
/// | `cg_tolerance` | 1e-10 | they end where the squared norm of what is left is below |
/// | `damping` | 1e-5 | added to the diagonal of the curvature, in units of the parameters |
/// | `design_scale` | 1.0 | the unit of the design's stand-ins in the equations of a step |
/// | `fisher_rows` | all | rows that the curvature is taken of |
/// | `backtrack_ratio` | 0.8 | a step that does not hold is shortened by this |
/// | `backtracks` | 15 | steps tried, the full one among them |
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TrpoConfig {
    /// How rewards become advantages.
    pub advantages: AdvantageConfig,
    /// The most mean KL divergence of an update, nats (δ of 14).
    pub max_kl: f64,
    /// What fraction of it is left at the end. A divergence is measured by the exploration noise: where that is small, most of a
    /// step of constant divergence is the noise of the gradient, and the policy wanders.
    pub max_kl_final: f64,
    /// Most steps of conjugate gradients.
    pub cg_iterations: usize,
    /// Conjugate gradients end where the squared norm of the residual is below this.
    pub cg_tolerance: f64,
    /// Added to the diagonal of the curvature, in units of the parameters.
    pub damping: f64,
    /// The unit of the design's stand-ins in the equations of a step; that of all other parameters is 1. The solution of
    /// H·x = g does not depend on units, but damping does, and so does what few steps of conjugate gradients find of it: in a
    /// larger unit the design goes further for the same divergence. The paper scales its stiffnesses (appendix B) to the
    /// same end.
    pub design_scale: f64,
    /// Rows that the curvature is taken of: each costs a pass forwards and backwards per step of conjugate gradients.
    pub fisher_rows: FisherRows,
    /// A step that does not hold is shortened by this.
    pub backtrack_ratio: f64,
    /// Steps that are tried, the full one among them.
    pub backtracks: usize,
}

impl TrpoConfig {
    /// The most mean KL divergence of an update at this share of the training.
    pub(super) fn max_kl_at(&self, progress: f64) -> f64 {
        self.max_kl * share_left(self.max_kl_final, progress)
    }
}

impl Default for TrpoConfig {
    fn default() -> Self {
        Self {
            advantages: AdvantageConfig::default(),
            max_kl: 0.01,
            max_kl_final: 1.0,
            cg_iterations: 10,
            cg_tolerance: 1e-10,
            damping: 1e-5,
            design_scale: 1.0,
            fisher_rows: FisherRows::Fraction(1.0),
            backtrack_ratio: 0.8,
            backtracks: 15,
        }
    }
}

/// TRPO with its baseline.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TrpoSettings {
    /// Of the policy's updates.
    pub trpo: TrpoConfig,
    /// The value baseline.
    pub baseline: BaselineConfig,
}

/// How many rows of a batch the curvature is taken of; at least one, at most all.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum FisherRows {
    /// This share of them.
    Fraction(f64),
    /// So many.
    Count(usize),
}

impl FisherRows {
    /// How many of so many rows.
    pub fn count(self, rows: usize) -> usize {
        let wanted = match self {
            Self::Fraction(fraction) => (fraction * rows as f64).round() as usize,
            Self::Count(count) => count,
        };
        wanted.clamp(1, rows.max(1))
    }

    /// Indices in ascending order: one at random from each of as many equal stretches, so that they are spread over all
    /// episodes and times without a rhythm.
    pub(super) fn pick(self, rows: usize, numbers: &mut Stream) -> Vec<u32> {
        let count = self.count(rows);
        let edge = |k: usize| k * rows / count;
        (0..count).map(|k| numbers.random_range(edge(k) as u32..edge(k + 1) as u32)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use hwasp_core::{Purpose, stream};

    #[test]
    fn rows_are_spread_and_all_where_asked() {
        let pick = |rows: FisherRows, of, i| rows.pick(of, &mut stream(0, Purpose::Minibatches, i, 0));
        let some = pick(FisherRows::Fraction(0.3), 10, 0);
        assert_eq!(some.len(), 3);
        assert!((0..3).contains(&some[0]) && (3..6).contains(&some[1]) && (6..10).contains(&some[2]), "{some:?}");
        assert!((1..20).any(|i| pick(FisherRows::Fraction(0.3), 10, i) != some));
        assert_eq!(pick(FisherRows::Count(50), 4, 0), [0, 1, 2, 3]);
        assert_eq!(pick(FisherRows::Fraction(1.0), 4, 0), [0, 1, 2, 3]);
        assert_eq!((FisherRows::Fraction(1e-9).count(100), FisherRows::Count(7).count(100)), (1, 7));
    }
}
