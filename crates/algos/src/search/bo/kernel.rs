//! How alike the scores of two candidates are.

/// Variance of the constant that all scores share, in units of the scores' variance: the mean of standardised scores is known
/// to within about one.
pub(super) const CONSTANT: f64 = 1.0;

/// The covariance of scores: a constant, a Matérn function of order 5/2 with one length scale for each coordinate (Rasmussen and
/// Williams 2006, eq. 4.17; Snoek et al. 2012, eq. 12), and noise.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Kernel {
    /// ℓ: how far a coordinate goes until scores are no longer alike.
    pub(super) scales: Vec<f64>,
    /// σ²: the variance of what depends on the candidate.
    pub(super) signal: f64,
    /// The variance of scores of one and the same candidate.
    pub(super) noise: f64,
}

impl Kernel {
    /// From the logarithms of length scales, signal and noise, in this order.
    pub(super) fn from_logs(logs: &[f64]) -> Self {
        let (scales, rest) = logs.split_at(logs.len() - 2);
        Self { scales: scales.iter().map(|v| v.exp()).collect(), signal: rest[0].exp(), noise: rest[1].exp() }
    }

    /// √5 r, for the distance r in length scales.
    fn distance(&self, a: &[f64], b: &[f64]) -> f64 {
        let squares = a.iter().zip(b).zip(&self.scales).map(|((a, b), scale)| ((a - b) / scale).powi(2));
        (5.0 * squares.sum::<f64>()).sqrt()
    }

    /// k(a, b) without noise.
    pub(super) fn covariance(&self, a: &[f64], b: &[f64]) -> f64 {
        CONSTANT + self.matern(a, b).0
    }

    /// The part of k(a, b) that depends on the candidates, and s = σ²·5/3·(1 + √5 r)·exp(-√5 r), by which it changes: its
    /// derivative by log ℓᵢ is s·(aᵢ - bᵢ)²/ℓᵢ², and by aᵢ it is -s·(aᵢ - bᵢ)/ℓᵢ².
    pub(super) fn matern(&self, a: &[f64], b: &[f64]) -> (f64, f64) {
        let r = self.distance(a, b);
        let decay = self.signal * (-r).exp();
        (decay * (1.0 + r + r * r / 3.0), decay * 5.0 / 3.0 * (1.0 + r))
    }

    /// k(a, a) without noise.
    pub(super) fn variance(&self) -> f64 {
        CONSTANT + self.signal
    }
}
