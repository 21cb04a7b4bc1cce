//! Settings of CMA-ES, and what is possible.

use serde::{Deserialize, Serialize};

use crate::search::{SearchError, check_limits, limits};

/// Settings of [`Cmaes`](super::Cmaes).
///
/// | name | default | limits | purpose |
/// |---|---|---|---|
/// | `sigma` | 0.5 | > 0 | σ at the start: standard deviation of every coordinate, in the candidate's units |
/// | `popsize` | 4 + ⌊3 ln n⌋ | ≥ 4 | λ, candidates of a generation |
/// | `lower`, `upper` | none | lower < upper | limits of the coordinates; infinite where there is none |
/// | `restarts` | 0 | ≤ 20 | how often a search that stopped begins again with twice the population |
/// | `separable` | false | | diagonal covariance only: cost linear in n |
/// | `active` | true | | learn from the bad candidates too, by negative weights |
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CmaesConfig {
    /// σ at the start. The optimum should lie within about 3 σ of the initial mean.
    pub sigma: f64,
    /// λ, candidates of a generation; `None` for 4 + ⌊3 ln n⌋ (eq. 48).
    pub popsize: Option<usize>,
    /// Smallest value of each coordinate; may be `-∞`.
    pub lower: Option<Vec<f64>>,
    /// Largest value of each coordinate; may be `∞`.
    pub upper: Option<Vec<f64>>,
    /// IPOP (Auger and Hansen 2005): how often a search that stopped begins again, each time with twice the population.
    pub restarts: u32,
    /// sep-CMA-ES (Ros and Hansen 2008): the covariance is diagonal and learned (n + 2)/3 times as fast.
    pub separable: bool,
    /// Whether the worse half of a generation has negative weights in the covariance (eq. 53), or none.
    pub active: bool,
}

impl Default for CmaesConfig {
    fn default() -> Self {
        Self { sigma: 0.5, popsize: None, lower: None, upper: None, restarts: 0, separable: false, active: true }
    }
}

/// The most restarts: the population has then doubled to a million times the first.
const MAX_RESTARTS: u32 = 20;

impl CmaesConfig {
    /// Whether these settings describe a search around `mean`.
    pub(super) fn check(&self, mean: &[f64]) -> Result<(), SearchError> {
        let setting = |name, value, limits| Err(SearchError::Setting { name, value, limits });
        let n = mean.len();
        if n == 0 {
            return setting("dimension", 0.0, "at least 1");
        }
        // Steps below the normal numbers would be lost, above this their squares would overflow.
        if !(1e-100..=1e100).contains(&self.sigma) {
            return setting("sigma", self.sigma, "within [1e-100, 1e100]");
        }
        if let Some(popsize) = self.popsize
            && !(4..=1 << 20).contains(&popsize)
        {
            return setting("popsize", popsize as f64, "within [4, 2^20]");
        }
        if self.restarts > MAX_RESTARTS {
            return setting("restarts", f64::from(self.restarts), "at most 20");
        }
        check_limits(self.lower.as_deref(), self.upper.as_deref(), n)?;
        for (i, &m) in mean.iter().enumerate() {
            let (lower, upper) = self.bound(i);
            if m.abs() > 1e150 || !(lower..=upper).contains(&m) {
                return setting("mean", m, "a number inside of the bounds, below 1e150");
            }
        }
        Ok(())
    }

    /// Lower and upper limit of coordinate `i`.
    pub(super) fn bound(&self, i: usize) -> (f64, f64) {
        limits(self.lower.as_deref(), self.upper.as_deref(), i)
    }

    /// λ of the first run for `n` coordinates (eq. 48).
    pub fn first_popsize(&self, n: usize) -> usize {
        self.popsize.unwrap_or_else(|| 4 + (3.0 * (n as f64).ln()).floor() as usize)
    }
}
