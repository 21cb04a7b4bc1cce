//! When a run has ended (the tutorial's appendix B.3).

use super::{CmaesConfig, CmaesState};

/// Why a run has ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stop {
    /// A tenth of a standard deviation along an axis of the samples (a column of L) no longer changes the mean.
    NoEffectAxis,
    /// A fifth of a standard deviation in a coordinate no longer changes it.
    NoEffectCoord,
    /// The covariance has a condition above 1e14, or none that can be computed.
    ConditionCov,
    /// The best scores of the last 10 + ⌈30n/λ⌉ generations are equal.
    EqualFunValues,
    /// Over the last fifth of the generations, at least 120 + 30n/λ, neither best nor median scores got better.
    Stagnation,
    /// The largest standard deviation has grown 1e4-fold: the first was far too small, or the scores have no end.
    TolXUp,
    /// The scores of this generation and the best of the last 10 + ⌈30n/λ⌉ are within 1e-12.
    TolFun,
    /// All standard deviations and the path times σ are below 1e-12 of the first σ.
    TolX,
}

impl Stop {
    /// All of them; a saved state has their places in this list.
    pub(super) const ALL: [Self; 8] = [
        Self::NoEffectAxis,
        Self::NoEffectCoord,
        Self::ConditionCov,
        Self::EqualFunValues,
        Self::Stagnation,
        Self::TolXUp,
        Self::TolFun,
        Self::TolX,
    ];
}

const TOL_FUN: f64 = 1e-12;
const TOL_X: f64 = 1e-12;
const TOL_X_UP: f64 = 1e4;
const MAX_CONDITION: f64 = 1e14;
/// The longest stagnation window, generations.
const MAX_WINDOW: usize = 20_000;

/// Generations over which stagnation is judged.
fn window(state: &CmaesState, popsize: usize) -> usize {
    let least = 120 + (30 * state.mean.len()).div_ceil(popsize);
    (state.run_generation / 5).clamp(least as u64, MAX_WINDOW.max(least) as u64) as usize
}

/// Keeps the scores of a generation, the best first, failed ones at `f64::MIN`.
pub(super) fn record(state: &mut CmaesState, sorted: &[f64]) {
    let half = sorted.len() / 2;
    let median = if sorted.len() % 2 == 1 { sorted[half] } else { f64::midpoint(sorted[half - 1], sorted[half]) };
    state.best_scores.push(sorted[0]);
    state.median_scores.push(median);
    let excess = state.best_scores.len().saturating_sub(window(state, sorted.len()));
    state.best_scores.drain(..excess);
    state.median_scores.drain(..excess);
}

/// Whether the run has ended, after an update by a generation with these scores, the best first. `decomposed` is false
/// where the covariance has no Cholesky factor.
pub(super) fn test(state: &CmaesState, config: &CmaesConfig, sorted: &[f64], decomposed: bool) -> Option<Stop> {
    let n = state.mean.len();
    let deviation = |i| state.sigma * state.variance(i).sqrt();
    let (shortest, longest) = state.lengths.iter().fold((f64::MAX, 0.0_f64), |(a, b), &d| (a.min(d), b.max(d)));
    let recent = 10 + (30 * n).div_ceil(sorted.len());
    let recent = state.best_scores.len().checked_sub(recent).map(|first| &state.best_scores[first..]);
    let recent_range = recent.map(range);

    if (0..n)
        .all(|i| deviation(i) < TOL_X * config.sigma && (state.sigma * state.path_c[i]).abs() < TOL_X * config.sigma)
    {
        return Some(Stop::TolX);
    }
    if state.sigma * longest > TOL_X_UP * config.sigma {
        return Some(Stop::TolXUp);
    }
    if !decomposed || longest.powi(2) > MAX_CONDITION * shortest.powi(2) {
        return Some(Stop::ConditionCov);
    }
    if recent_range == Some(0.0) {
        return Some(Stop::EqualFunValues);
    }
    if recent_range.is_some_and(|r| r < TOL_FUN) && range(sorted) < TOL_FUN {
        return Some(Stop::TolFun);
    }
    if (0..n).any(|i| state.mean[i] + 0.2 * deviation(i) == state.mean[i]) {
        return Some(Stop::NoEffectCoord);
    }
    // One axis each generation, in turn.
    let k = (state.run_generation % n as u64) as usize;
    let unchanged = |i: usize| {
        let along = match config.separable {
            true if i == k => state.lengths[k],
            true => 0.0,
            false => state.factor[i * n + k],
        };
        state.mean[i] + 0.1 * state.sigma * along == state.mean[i]
    };
    if (0..n).all(unchanged) {
        return Some(Stop::NoEffectAxis);
    }
    let window = window(state, sorted.len());
    let stagnates = |scores: &[f64]| {
        let part = window * 3 / 10;
        median(&scores[scores.len() - part..]) <= median(&scores[..part])
    };
    let enough = state.best_scores.len() >= window;
    (enough && stagnates(&state.best_scores) && stagnates(&state.median_scores)).then_some(Stop::Stagnation)
}

fn range(values: &[f64]) -> f64 {
    let (low, high) = values.iter().fold((f64::MAX, f64::MIN), |(a, b), &v| (a.min(v), b.max(v)));
    high - low
}

fn median(values: &[f64]) -> f64 {
    let mut values = values.to_vec();
    let half = values.len() / 2;
    *values.select_nth_unstable_by(half, f64::total_cmp).1
}
