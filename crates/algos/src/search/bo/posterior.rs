//! What scores say of candidates that nobody has tried (Rasmussen and Williams 2006, algorithm 2.1).

use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

use super::kernel::Kernel;

/// Added to the diagonal in turn, until rounding leaves the matrix positive definite; the noise of a fitted kernel is mostly
/// enough.
const JITTER: [f64; 5] = [0.0, 1e-8, 1e-6, 1e-4, 1e-2];
/// The noise of what is believed: next to none, so that nobody asks for it twice in a generation.
const BELIEVED: f64 = 1e-6;
/// The least variance that rounding leaves.
const LEAST: f64 = 1e-12;

/// A Gaussian process, conditioned on scores.
pub(super) struct Posterior<'a> {
    kernel: &'a Kernel,
    points: Vec<&'a [f64]>,
    factor: Cholesky<f64, Dyn>,
    /// K⁻¹·scores.
    weights: DVector<f64>,
}

/// The covariance of points with noisy scores, factorised; the last ones, from `believed` on, have no noise.
pub(super) fn factorised(kernel: &Kernel, points: &[&[f64]], believed: usize) -> Cholesky<f64, Dyn> {
    let with = |jitter: f64| {
        let mut covariance = DMatrix::zeros(points.len(), points.len());
        // The factorisation reads the lower triangle alone.
        for j in 0..points.len() {
            for i in j..points.len() {
                covariance[(i, j)] = kernel.covariance(points[i], points[j]);
            }
            covariance[(j, j)] += jitter + if j < believed { kernel.noise } else { BELIEVED };
        }
        covariance.cholesky()
    };
    JITTER.into_iter().find_map(with).expect("a covariance of limited condition, with a hundredth on its diagonal")
}

/// Mean and standard deviation of a score without its noise, and how they change with each coordinate.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Slope {
    pub(super) mean: f64,
    pub(super) std: f64,
    pub(super) mean_by: Vec<f64>,
    pub(super) std_by: Vec<f64>,
}

impl<'a> Posterior<'a> {
    /// Of points with scores; of those from `believed` on the scores are sure.
    pub(super) fn new(kernel: &'a Kernel, points: Vec<&'a [f64]>, scores: &[f64], believed: usize) -> Self {
        let factor = factorised(kernel, &points, believed);
        let weights = factor.solve(&DVector::from_column_slice(scores));
        Self { kernel, points, factor, weights }
    }

    /// k(x, points).
    fn covariances(&self, x: &[f64]) -> DVector<f64> {
        DVector::from_iterator(self.points.len(), self.points.iter().map(|p| self.kernel.covariance(x, p)))
    }

    /// The mean.
    pub(super) fn mean(&self, x: &[f64]) -> f64 {
        self.covariances(x).dot(&self.weights)
    }

    /// Mean and standard deviation.
    pub(super) fn at(&self, x: &[f64]) -> (f64, f64) {
        let covariances = self.covariances(x);
        let mean = covariances.dot(&self.weights);
        (mean, self.std(&self.whitened(covariances)))
    }

    /// L⁻¹·k.
    fn whitened(&self, mut covariances: DVector<f64>) -> DVector<f64> {
        self.factor.l_dirty().solve_lower_triangular_unchecked_mut(&mut covariances);
        covariances
    }

    fn std(&self, whitened: &DVector<f64>) -> f64 {
        (self.kernel.variance() - whitened.norm_squared()).max(LEAST).sqrt()
    }

    /// The same with derivatives.
    pub(super) fn slope(&self, x: &[f64]) -> Slope {
        let covariances = self.covariances(x);
        let mean = covariances.dot(&self.weights);
        let mut solved = self.whitened(covariances);
        let std = self.std(&solved);
        self.factor.l_dirty().tr_solve_lower_triangular_unchecked_mut(&mut solved); // K⁻¹·k
        let (mut mean_by, mut std_by) = (vec![0.0; x.len()], vec![0.0; x.len()]);
        for (j, point) in self.points.iter().enumerate() {
            let change = self.kernel.matern(x, point).1;
            for i in 0..x.len() {
                let by = -change * (x[i] - point[i]) / self.kernel.scales[i].powi(2);
                mean_by[i] += self.weights[j] * by;
                std_by[i] -= solved[j] * by / std;
            }
        }
        Slope { mean, std, mean_by, std_by }
    }
}
