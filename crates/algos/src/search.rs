//! Searches without gradients: ask for candidates, tell their scores. They see vectors and numbers, never an environment.

mod ars;
mod bo;
mod cmaes;
mod filter;
mod random;

pub use ars::{Ars, ArsConfig};
pub use bo::{Bo, BoConfig};
pub use cmaes::{Cmaes, CmaesConfig, Stop};
pub use filter::StateFilter;
pub use random::{RandomConfig, RandomSearch};

use thiserror::Error;

use crate::archive::Persist;

/// Ask and tell; scores are returns, more is better.
///
/// Candidates are drawn from streams named by (seed, generation, candidate), so that what [`ask`](Self::ask) gives depends
/// on the state alone: asked twice, before and after a save, it gives the same.
pub trait Search: Persist + Send {
    /// The length of a candidate.
    fn dimension(&self) -> usize;

    /// The candidates of the generation at hand.
    fn ask(&mut self) -> Vec<Vec<f64>>;

    /// Takes the scores of the asked candidates, in their order, and goes on to the next generation. A candidate that
    /// failed has the score `f64::NEG_INFINITY` (or NaN, which counts as that) and ranks last. [`RandomSearch`] and [`Bo`]
    /// take the scores of the first candidates alone, too.
    ///
    /// # Errors
    /// Where there are not as many scores as candidates, or none of them is a number: the state is then as it was.
    fn tell(&mut self, scores: &[f64]) -> Result<(), SearchError>;

    /// The candidate that the search takes for best: the mean of its distribution, where it has one.
    fn center(&self) -> Vec<f64>;

    /// Generations told so far.
    fn generation(&self) -> u64;

    /// Which episodes a candidate is scored on: those of one group share their start states and noise (common random
    /// numbers), so that their difference is theirs.
    fn group(&self, candidate: usize) -> u64;

    /// Why further generations would gain nothing; `None` while they may.
    fn stopped(&self) -> Option<Stop> {
        None
    }
}

/// Why a search cannot begin or go on.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum SearchError {
    /// Not one score per candidate.
    #[error("{found} scores for {expected} candidates")]
    Scores {
        /// Scores given.
        found: usize,
        /// Candidates asked.
        expected: usize,
    },
    /// No candidate of a generation has a finite score.
    #[error("all {candidates} candidates of generation {generation} failed")]
    AllFailed {
        /// Candidates.
        candidates: usize,
        /// The generation.
        generation: u64,
    },
    /// The distribution went beyond what numbers hold; the state before it was kept.
    #[error("the distribution of generation {generation} has no bounds")]
    Diverged {
        /// The generation.
        generation: u64,
    },
    /// A setting that describes no search.
    #[error("{name} = {value} is not {limits}")]
    Setting {
        /// The setting.
        name: &'static str,
        /// What was given.
        value: f64,
        /// What is possible.
        limits: &'static str,
    },
}

/// Lower and upper limit of coordinate `i`; infinite where there is none.
fn limits(lower: Option<&[f64]>, upper: Option<&[f64]>, i: usize) -> (f64, f64) {
    (lower.map_or(f64::NEG_INFINITY, |b| b[i]), upper.map_or(f64::INFINITY, |b| b[i]))
}

/// Whether there are limits for each coordinate of a search's start, with room between them.
fn check_limits(lower: Option<&[f64]>, upper: Option<&[f64]>, dimension: usize) -> Result<(), SearchError> {
    let setting = |name, value, limits| Err(SearchError::Setting { name, value, limits });
    for (name, bound) in [("lower", lower), ("upper", upper)] {
        if let Some(bound) = bound
            && bound.len() != dimension
        {
            return setting(name, bound.len() as f64, "as long as the mean");
        }
    }
    for i in 0..dimension {
        let (lower, upper) = limits(lower, upper, i);
        // A width that overflows leaves no arithmetic inside.
        if lower.is_finite() && upper.is_finite() && !((upper - lower).is_finite() && lower < upper) {
            return setting("upper", upper, "above the lower bound, at a finite distance");
        }
        if lower.is_nan() || lower == f64::INFINITY {
            return setting("lower", lower, "a number or -inf");
        }
        if upper.is_nan() || upper == f64::NEG_INFINITY {
            return setting("upper", upper, "a number or inf");
        }
    }
    Ok(())
}

/// Scores with every failure as negative infinity; an error where they are too few or too many, or all failed.
fn failed_last(scores: &[f64], expected: usize, generation: u64) -> Result<Vec<f64>, SearchError> {
    if scores.len() != expected {
        return Err(SearchError::Scores { found: scores.len(), expected });
    }
    let scores: Vec<f64> = scores.iter().map(|&s| if s.is_finite() { s } else { f64::NEG_INFINITY }).collect();
    if scores.iter().all(|s| !s.is_finite()) {
        return Err(SearchError::AllFailed { candidates: expected, generation });
    }
    Ok(scores)
}

/// Whether a start is a point of the unit cube, and a generation has candidates.
fn check_unit(popsize: usize, start: &[f64]) -> Result<(), SearchError> {
    if popsize == 0 {
        return Err(SearchError::Setting { name: "popsize", value: 0.0, limits: "at least 1" });
    }
    if start.is_empty() {
        return Err(SearchError::Setting { name: "dimension", value: 0.0, limits: "at least 1" });
    }
    match start.iter().find(|x| !(0.0..=1.0).contains(*x)) {
        Some(&value) => Err(SearchError::Setting { name: "start", value, limits: "within [0, 1]" }),
        None => Ok(()),
    }
}

/// Scores of the first candidates of a generation, `None` for those that failed; an error where there are none or too many, or
/// where all failed and none was `scored` before.
fn sound_or_failed(
    scores: &[f64],
    popsize: usize,
    generation: u64,
    scored: bool,
) -> Result<Vec<Option<f64>>, SearchError> {
    if scores.is_empty() || scores.len() > popsize {
        return Err(SearchError::Scores { found: scores.len(), expected: popsize });
    }
    let scores: Vec<Option<f64>> = scores.iter().map(|&s| s.is_finite().then_some(s)).collect();
    if !scored && scores.iter().all(Option::is_none) {
        return Err(SearchError::AllFailed { candidates: scores.len(), generation });
    }
    Ok(scores)
}
