//! Expected improvement (Mockus 1975; Jones, Schonlau and Welch 1998, eq. 15), by its logarithm (Ament et al. 2023, "Unexpected
//! improvements to expected improvement for Bayesian optimization"), which has a slope where the improvement itself rounds to 0.

/// log √(2π).
const LOG_ROOT: f64 = 0.918_938_533_204_672_7;
/// Where the tails begin.
const TAIL: f64 = 2.0;
/// Steps of the continued fraction: its relative error from there on is below 1e-15.
const STEPS: u32 = 100;
/// From here on the normal distribution is 1 in the numbers at hand.
const ALL: f64 = 9.0;

/// The logarithm of the expected improvement, and its derivatives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Improvement {
    pub(super) log: f64,
    pub(super) by_mean: f64,
    pub(super) by_std: f64,
}

/// φ.
fn density(z: f64) -> f64 {
    (-0.5 * z * z - LOG_ROOT).exp()
}

/// c in Φ(-t) = φ(t)/(t + c), in the tail: Laplace's continued fraction 1/(t + 2/(t + 3/(t + …))).
fn fraction(t: f64) -> f64 {
    (1..=STEPS).rev().fold(0.0, |c, k| f64::from(k) / (t + c))
}

/// Φ, but for its lower tail.
fn normal(z: f64) -> f64 {
    if z > ALL {
        return 1.0;
    }
    if z > TAIL {
        return 1.0 - density(z) / (z + fraction(z));
    }
    // Φ(z) = 1/2 + φ(z)·(z + z³/3 + z⁵/(3·5) + …).
    let (mut term, mut sum, mut k) = (z, 0.0, 1.0);
    while sum + term != sum {
        sum += term;
        k += 2.0;
        term *= z * z / k;
    }
    0.5 + density(z) * sum
}

/// How far a score with this mean and standard deviation, both without noise, is expected to be above `best`:
/// EI = σ·h(z), with z = (mean - best)/σ and h(z) = φ(z) + z·Φ(z).
pub(super) fn improvement(mean: f64, std: f64, best: f64) -> Improvement {
    let z = (mean - best) / std;
    // log h, Φ/h, φ/h.
    let (log, share, peak) = if z < -TAIL {
        // φ and Φ vanish far out, and h is the small difference of both; by the fraction nothing cancels: h = φ·c/(t + c).
        let (t, c) = (-z, fraction(-z));
        (-0.5 * z * z - LOG_ROOT + (c / (t + c)).ln(), 1.0 / c, (t + c) / c)
    } else {
        let (density, normal) = (density(z), normal(z));
        let h = density + z * normal;
        (h.ln(), normal / h, density / h)
    };
    // ∂EI/∂mean = Φ and ∂EI/∂σ = φ.
    Improvement { log: std.ln() + log, by_mean: share / std, by_std: peak / std }
}
