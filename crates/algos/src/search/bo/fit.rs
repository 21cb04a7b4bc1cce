//! Length scales, signal and noise of a kernel, from scores.

use nalgebra::DVector;

use super::kernel::{CONSTANT, Kernel};
use super::minimise::{Evaluation, minimise};
use super::posterior::factorised;

/// The most points that the likelihood is computed on, evenly among all: its cost grows with their cube, and what they say of a
/// dozen numbers grows slowly.
const MOST_POINTS: usize = 250;
/// Steps of each search for the most likely kernel.
const STEPS: usize = 60;
/// Limits of the logarithms of a length scale, of the signal and of the noise. Scores have variance 1 and candidates are in the unit
/// cube; the least noise leaves the covariance a condition that its factorisation bears.
const SCALE: (f64, f64) = (-4.0, 8.0);
const SIGNAL: (f64, f64) = (-4.0, 4.0);
const NOISE: (f64, f64) = (-12.0, 1.0);

/// Normal distributions of logarithms before any score: mean and standard deviation.
#[derive(Clone, Copy, Debug)]
pub(super) struct Priors {
    /// √2 + log √n and √3 for n coordinates: scores are smooth unless they show that they are not, in many coordinates the more
    /// (Hvarfner, Hellsten and Nardi 2024, "Vanilla Bayesian optimization performs great in high dimensions").
    scale: (f64, f64),
    signal: (f64, f64),
    /// Some 2 % of the variance, from a third of a per mille to all of it within two deviations.
    noise: (f64, f64),
}

impl Priors {
    pub(super) fn new(dimension: usize) -> Self {
        let scale = (2.0_f64.sqrt() + 0.5 * (dimension as f64).ln(), 3.0_f64.sqrt());
        Self { scale, signal: (0.0, 1.0), noise: (-4.0, 2.0) }
    }

    /// Of each logarithm of a kernel.
    fn all(&self, dimension: usize) -> impl Iterator<Item = (f64, f64)> {
        std::iter::repeat_n(self.scale, dimension).chain([self.signal, self.noise])
    }
}

/// The most probable kernel, by the best of a few searches from fixed points; the scores have mean 0 and variance 1.
pub(super) fn fitted(points: &[&[f64]], scores: &[f64]) -> Kernel {
    let n = points[0].len();
    let every = points.len().div_ceil(MOST_POINTS).max(1);
    let points: Vec<&[f64]> = points.iter().step_by(every).copied().collect();
    let scores: Vec<f64> = scores.iter().step_by(every).copied().collect();
    let (priors, root) = (Priors::new(n), 0.5 * (n as f64).ln());
    let limits: Vec<(f64, f64)> = std::iter::repeat_n(SCALE, n).chain([SIGNAL, NOISE]).collect();
    // As the priors have it; hills and valleys within the cube, and hardly any noise; mostly noise.
    let starts = [(priors.scale.0, 0.0, priors.noise.0), (root - 1.0, 0.0, -8.0), (root, -1.0, -0.5)];
    let found = starts.into_iter().filter_map(|(scale, signal, noise)| {
        let start: Vec<f64> = std::iter::repeat_n(scale, n).chain([signal, noise]).collect();
        minimise(&start, &limits, STEPS, |logs| improbability(logs, &points, &scores, &priors))
    });
    let best = found.reduce(|best, other| if other.1 < best.1 { other } else { best });
    let (logs, _) = best.expect("a likelihood at the starts, where noise keeps the covariance regular");
    Kernel::from_logs(&logs)
}

/// Minus the logarithm of the posterior density of a kernel, up to a constant, and its gradient (Rasmussen and Williams 2006,
/// equations 5.8 and 5.9).
pub(super) fn improbability(logs: &[f64], points: &[&[f64]], scores: &[f64], priors: &Priors) -> Evaluation {
    let kernel = Kernel::from_logs(logs);
    let n = kernel.scales.len();
    let factor = factorised(&kernel, points, points.len());
    let weights = factor.solve(&DVector::from_column_slice(scores));
    let fit: f64 = scores.iter().zip(weights.iter()).map(|(y, w)| y * w).sum();
    let half_log_det: f64 = factor.l_dirty().diagonal().iter().map(|d| d.ln()).sum();
    let mut value = 0.5 * fit + half_log_det;
    let mut gradient = vec![0.0; n + 2];
    for ((log, slope), (mean, std)) in logs.iter().zip(&mut gradient).zip(priors.all(n)) {
        value += 0.5 * ((log - mean) / std).powi(2);
        *slope = (log - mean) / (std * std);
    }
    // ½ tr((K⁻¹ - K⁻¹·y·yᵀ·K⁻¹)·∂K), the lower triangle twice.
    let inverse = factor.inverse();
    for j in 0..points.len() {
        let excess = inverse[(j, j)] - weights[j] * weights[j];
        gradient[n] += 0.5 * excess * (kernel.variance() - CONSTANT);
        gradient[n + 1] += 0.5 * excess * kernel.noise;
        for i in j + 1..points.len() {
            let excess = inverse[(i, j)] - weights[i] * weights[j];
            let (matern, change) = kernel.matern(points[i], points[j]);
            gradient[n] += excess * matern;
            for k in 0..n {
                gradient[k] += excess * change * ((points[i][k] - points[j][k]) / kernel.scales[k]).powi(2);
            }
        }
    }
    value.is_finite().then_some((value, gradient))
}
