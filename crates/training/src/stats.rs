//! Figures over a handful of runs: interquartile mean, bootstrap intervals, quantiles.
//!
//! A few seeds are all that one has, so results are given as an interquartile mean with a bootstrap interval over the
//! runs, as Agarwal et al. argue in "Deep reinforcement learning at the edge of the statistical precipice" (NeurIPS
//! 2021). Everything depends on the values alone, not on the order they come in, and is the same on every machine.
//!
//! # What a sample cannot carry
//!
//! One rule for every interval that a command prints, over seeds or over episodes: a bootstrap interval needs at least
//! [`LEAST_VALUES`] values that are not all alike, and a probability of improvement that many on both sides. Where there
//! is less, there is no interval ([`Option::None`]), and the values stand for themselves.
//!
//! The reasons. The percentile interval of a mean never leaves the range of its values. The range of n values of a
//! symmetric distribution holds the centre with probability 1 − 2^(1 − n), so that the nominal 95 % is at most:
//!
//! | values | 1 | 2 | 3 | 4 | 5 | 6 |
//! |---|---|---|---|---|---|---|
//! | covers at most | 0 % | 50 % | 75 % | 88 % | 94 % | 97 % |
//!
//! Up to three values, the interval is the range itself and says nothing that the values do not: n equal draws of the
//! smallest value have the probability n^−n, which is more than the 2.5 % of a tail. And two methods with four seeds each
//! are the smallest that any outcome tells apart at 5 %: when every seed of the one beats every seed of the other, chance
//! alone does so in [2 of 70 cases](separation_by_chance), with three seeds each in 2 of 20.
//!
//! Values that are all alike resample to themselves. A point would be printed as if it were certain; all that is known is
//! that this sample has no variation.

use hwasp_core::Stream;
use rand::Rng;
use serde::{Deserialize, Serialize};
use thiserror::Error;

/// The fewest values that carry an interval; the module says why.
pub const LEAST_VALUES: usize = 4;

/// Why a figure cannot be computed.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum StatsError {
    /// There are no values at all.
    #[error("a statistic needs at least one value, and there is none")]
    Empty,
    /// A value that cannot be averaged.
    #[error(
        "value {index} is {value}; only finite values can be summarised: leave out the run it came from, or repeat it"
    )]
    NotFinite {
        /// Its place, from 0.
        index: usize,
        /// What it is.
        value: f64,
    },
    /// A confidence outside the open interval from 0 to 1.
    #[error("a confidence of {0} is outside (0, 1); write 0.95 for 95 %")]
    Confidence(f64),
    /// Too few or too many resamples.
    #[error("{0} resamples are outside [1, {max}]; 2000 are usual", max = Bootstrap::MOST_RESAMPLES)]
    Resamples(usize),
    /// The statistic gave no number on a resample.
    #[error("the statistic gives {0} on a resample of the values, so it has no interval")]
    Statistic(f64),
}

/// At least one value, all finite, in ascending order. Units are those of the values.
#[derive(Clone, Debug, PartialEq)]
pub struct Sample {
    sorted: Vec<f64>,
}

impl Sample {
    /// Checks the values and sorts them.
    pub fn new(values: &[f64]) -> Result<Self, StatsError> {
        if values.is_empty() {
            return Err(StatsError::Empty);
        }
        if let Some(index) = values.iter().position(|v| !v.is_finite()) {
            return Err(StatsError::NotFinite { index, value: values[index] });
        }
        let mut sorted = values.to_vec();
        sorted.sort_unstable_by(f64::total_cmp);
        Ok(Self { sorted })
    }

    /// The values in ascending order, at least one.
    pub fn sorted(&self) -> &[f64] {
        &self.sorted
    }

    /// The arithmetic mean.
    pub fn mean(&self) -> f64 {
        mean_of(&self.sorted)
    }

    /// The mean of what is left when a quarter of the values, rounded down to a whole number of values, is cut off at
    /// each end: `scipy.stats.trim_mean(values, 0.25)`, and so the figure `rliable` reports. With fewer than four
    /// values nothing is cut.
    pub fn interquartile_mean(&self) -> f64 {
        let cut = self.sorted.len() / 4;
        mean_of(&self.sorted[cut..self.sorted.len() - cut])
    }

    /// The standard error of the mean (with `n - 1` degrees of freedom); one value has none.
    pub fn standard_error(&self) -> Option<f64> {
        let n = self.sorted.len();
        if n < 2 {
            return None;
        }
        let mean = self.mean();
        let squares: f64 = self.sorted.iter().map(|v| (v - mean).powi(2)).sum();
        Some((squares / (n - 1) as f64 / n as f64).sqrt())
    }

    /// The quantile at `q`, clamped to [0, 1], linear between neighbouring values (`numpy.quantile`'s default).
    pub fn quantile(&self, q: f64) -> f64 {
        let last = self.sorted.len() - 1;
        let place = q.clamp(0.0, 1.0) * last as f64;
        // A NaN casts to 0, so the index stays inside whatever is asked for.
        let below = (place.floor() as usize).min(last);
        let above = (below + 1).min(last);
        let (low, high) = (self.sorted[below], self.sorted[above]);
        low + (high - low) * (place - below as f64)
    }

    /// Whether a bootstrap interval of these values says more than the values themselves: there are at least
    /// [`LEAST_VALUES`], and not all are alike.
    pub fn carries_interval(&self) -> bool {
        self.sorted.len() >= LEAST_VALUES && self.min() < self.max()
    }

    /// The smallest value.
    pub fn min(&self) -> f64 {
        self.sorted[0]
    }

    /// The largest value.
    pub fn max(&self) -> f64 {
        self.sorted[self.sorted.len() - 1]
    }
}

/// The arithmetic mean.
pub fn mean(values: &[f64]) -> Result<f64, StatsError> {
    Sample::new(values).map(|s| s.mean())
}

/// See [`Sample::interquartile_mean`].
pub fn interquartile_mean(values: &[f64]) -> Result<f64, StatsError> {
    Sample::new(values).map(|s| s.interquartile_mean())
}

/// An interval, ends included, in the unit of the values.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Interval {
    /// Its lower end.
    pub low: f64,
    /// Its upper end.
    pub high: f64,
}

/// Settings of a percentile bootstrap (Efron and Tibshirani, "An introduction to the bootstrap", chapter 13).
///
/// | setting | default | what it does | range |
/// |---|---|---|---|
/// | `resamples` | 2000 | how many resamples the percentiles are taken over | 1 to 1,000,000 |
/// | `confidence` | 0.95 | the share of resamples inside the interval | between 0 and 1 |
///
/// With few values the interval is too narrow: at 20 normal values a nominal 95 % covers about 93 %, at 5 about 83 %. With
/// very few there is none: [the rule](self#what-a-sample-cannot-carry).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bootstrap {
    /// How many resamples the percentiles are taken over.
    pub resamples: usize,
    /// The share of resamples inside the interval.
    pub confidence: f64,
}

impl Default for Bootstrap {
    fn default() -> Self {
        Self { resamples: 2000, confidence: 0.95 }
    }
}

impl Bootstrap {
    /// More resamples than this are a slip, not a wish.
    pub const MOST_RESAMPLES: usize = 1_000_000;

    /// The percentile interval of `statistic` over `sample`, where the sample [carries one](Sample::carries_interval). The
    /// same values and the same stream give the same interval; the stream moves on as far with an interval as without.
    pub fn interval(
        &self,
        sample: &Sample,
        statistic: impl Fn(&Sample) -> f64,
        stream: &mut Stream,
    ) -> Result<Option<Interval>, StatsError> {
        if !(self.confidence > 0.0 && self.confidence < 1.0) {
            return Err(StatsError::Confidence(self.confidence));
        }
        if !(1..=Self::MOST_RESAMPLES).contains(&self.resamples) {
            return Err(StatsError::Resamples(self.resamples));
        }
        let mut drawn = sample.clone();
        // The sample is sorted, so how often each place was drawn sorts the resample, in linear time.
        let mut times = vec![0_u32; sample.sorted.len()];
        let mut figures = Vec::with_capacity(self.resamples);
        for _ in 0..self.resamples {
            for _ in &sample.sorted {
                let place = index_below(sample.sorted.len(), stream);
                times[place] += 1;
            }
            let mut rest = &mut drawn.sorted[..];
            for (value, times) in sample.sorted.iter().zip(&mut times) {
                let (same, others) = rest.split_at_mut(std::mem::take(times) as usize);
                same.fill(*value);
                rest = others;
            }
            let figure = statistic(&drawn);
            if !figure.is_finite() {
                return Err(StatsError::Statistic(figure));
            }
            figures.push(figure);
        }
        let figures = Sample::new(&figures)?;
        let tail = (1.0 - self.confidence) / 2.0;
        let interval = Interval { low: figures.quantile(tail), high: figures.quantile(1.0 - tail) };
        Ok(sample.carries_interval().then_some(interval))
    }
}

/// The 95 % percentile-bootstrap interval of `statistic` with 2000 resamples, where the values carry one; [`Bootstrap`] has
/// other settings.
pub fn bootstrap_interval(
    values: &[f64],
    statistic: impl Fn(&Sample) -> f64,
    stream: &mut Stream,
) -> Result<Option<Interval>, StatsError> {
    Bootstrap::default().interval(&Sample::new(values)?, statistic, stream)
}

/// A uniform index in `0..n`, by the high half of a product: the same on every machine, biased by less than n / 2^64.
fn index_below(n: usize, stream: &mut Stream) -> usize {
    ((u128::from(stream.next_u64()) * n as u128) >> 64) as usize
}

/// The mean of at least one value; values near the largest number are divided before they are added.
fn mean_of(values: &[f64]) -> f64 {
    let n = values.len() as f64;
    let sum: f64 = values.iter().sum();
    if sum.is_finite() { sum / n } else { values.iter().map(|v| v / n).sum() }
}

/// How probably a value of one sample is larger than a value of another.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Improvement {
    /// The share of all pairs in which it is, ties counted half.
    pub probability: f64,
    /// Its 95 % interval; none where all pairs agree: every resample gives the same share then.
    #[serde(flatten)]
    pub interval: Option<Interval>,
}

/// How probably a value of `one` is larger than a value of `other`: the share of all pairs, ties counted half
/// (Mann and Whitney's U over the number of pairs), with the 95 % percentile interval of 2000 resamples of both. None
/// where either has fewer than [`LEAST_VALUES`] values.
pub fn improvement(one: &[f64], other: &[f64], stream: &mut Stream) -> Result<Option<Improvement>, StatsError> {
    let (one, other) = (Sample::new(one)?, Sample::new(other)?);
    if one.sorted.len().min(other.sorted.len()) < LEAST_VALUES {
        return Ok(None);
    }
    let share = |one: &[f64], other: &[f64]| {
        let wins = one.iter().flat_map(|x| {
            other.iter().map(move |y| {
                if x > y {
                    1.0
                } else if x == y {
                    0.5
                } else {
                    0.0
                }
            })
        });
        wins.sum::<f64>() / (one.len() * other.len()) as f64
    };
    let drawn = |sample: &Sample, stream: &mut Stream| -> Vec<f64> {
        (0..sample.sorted.len()).map(|_| sample.sorted[index_below(sample.sorted.len(), stream)]).collect()
    };
    let shares: Vec<f64> = (0..Bootstrap::default().resamples)
        .map(|_| {
            let (a, b) = (drawn(&one, stream), drawn(&other, stream));
            share(&a, &b)
        })
        .collect();
    let shares = Sample::new(&shares)?;
    let interval = Interval { low: shares.quantile(0.025), high: shares.quantile(0.975) };
    let probability = share(&one.sorted, &other.sorted);
    Ok(Some(Improvement { probability, interval: shares.carries_interval().then_some(interval) }))
}

/// How probably chance alone separates two samples of these sizes, the larger values all on one side, where both come from
/// the same distribution: 2 / C(one + other, one), of all ways to deal the ranks (Mann and Whitney 1947).
pub fn separation_by_chance(one: usize, other: usize) -> f64 {
    let ways = (1..=one).fold(1.0, |ways, k| ways * (other + k) as f64 / k as f64);
    (2.0 / ways).min(1.0)
}

/// Wilson's 95 % interval of a share of successes (Wilson 1927; `scipy.stats.binomtest(…).proportion_ci(method="wilson")`);
/// without a single episode it is [0, 1].
pub fn wilson(successes: u64, episodes: u64) -> Interval {
    const Z: f64 = 1.959_963_984_540_054; // the normal distribution's quantile at 0.975
    if episodes == 0 {
        return Interval { low: 0.0, high: 1.0 };
    }
    let (n, share) = (episodes as f64, successes as f64 / episodes as f64);
    let scale = 1.0 + Z * Z / n;
    let center = (share + Z * Z / (2.0 * n)) / scale;
    let half = Z / scale * (share * (1.0 - share) / n + Z * Z / (4.0 * n * n)).sqrt();
    Interval { low: (center - half).max(0.0), high: (center + half).min(1.0) }
}
