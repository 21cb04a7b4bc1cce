//! What episodes of an evaluation come to.

use std::collections::BTreeMap;

use hwasp_core::{End, EnvSpec, EpisodeResult, RolloutError, Stream};
use rand::SeedableRng;
use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::assemble::AssembleError;
use crate::collect::{CollectError, EpisodeAnswer};
use crate::returns::mean_terms;
use crate::stats::{Interval, Sample, StatsError, bootstrap_interval, wilson};

/// Why there is no evaluation.
#[derive(Debug, Error)]
pub enum EvaluateError {
    /// The deployed policy cannot be put together.
    #[error(transparent)]
    Assemble(#[from] AssembleError),
    /// An episode failed.
    #[error(transparent)]
    Rollout(#[from] RolloutError),
    /// Whoever was asked for episodes has not answered.
    #[error(transparent)]
    Collect(CollectError),
    /// No figure can be computed from the returns.
    #[error(transparent)]
    Stats(#[from] StatsError),
}

impl From<CollectError> for EvaluateError {
    fn from(error: CollectError) -> Self {
        match error {
            CollectError::Rollout(error) => Self::Rollout(error),
            CollectError::Setup(text) => Self::Assemble(AssembleError::Elsewhere(text)),
            CollectError::Unanswered(_) | CollectError::Interrupted => Self::Collect(error),
        }
    }
}

/// A mean over episodes with its 95 % bootstrap interval.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct MeanInterval {
    /// The mean.
    pub mean: f64,
    /// The interval, as `low` and `high`; none where the episodes [carry none](crate::stats#what-a-sample-cannot-carry).
    #[serde(flatten)]
    pub interval: Option<Interval>,
}

impl MeanInterval {
    /// The same in units of which one is `scale` of these.
    #[must_use]
    pub fn scaled(&self, scale: f64) -> Self {
        let interval = self.interval.map(|i| Interval { low: scale * i.low, high: scale * i.high });
        Self { mean: scale * self.mean, interval }
    }
}

/// With the decimals of the format, `-8.5 [-9.1, -8.0]`; `-8.5 (no interval)` where there is none.
impl std::fmt::Display for MeanInterval {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let decimals = f.precision().unwrap_or(2);
        match self.interval {
            Some(Interval { low, high }) => {
                write!(f, "{:.decimals$} [{low:.decimals$}, {high:.decimals$}]", self.mean)
            }
            None => write!(f, "{:.decimals$} (no interval)", self.mean),
        }
    }
}

/// What a design and its controller are worth.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Evaluation {
    /// Episodes run.
    pub episodes: u64,
    /// The root seed of their starts.
    pub seed: u64,
    /// Discounted return.
    pub discounted_return: MeanInterval,
    /// Undiscounted return.
    #[serde(rename = "return")]
    pub undiscounted_return: MeanInterval,
    /// The median of the discounted returns.
    pub median_discounted_return: f64,
    /// The worst discounted return.
    pub worst_discounted_return: f64,
    /// Episodes whose physics failed; they are in none of the figures.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub discarded_episodes: u64,
    /// How long episodes were and how they ended; runs of earlier versions do not tell.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ends: Option<Ends>,
    /// The share of episodes that succeeded, over all and for each kind, for tasks that know success.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub success: Vec<SuccessRate>,
    /// What each named term of the reward came to in an episode, on average; they add up to the return.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub terms: BTreeMap<String, f64>,
}

/// How long the episodes of an evaluation were, and how they ended; those whose physics failed are not among them.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Ends {
    /// Their mean length, steps.
    pub mean_steps: f64,
    /// The same, s.
    pub mean_s: f64,
    /// Episodes that ran to the time limit.
    pub time_limit: u64,
    /// Episodes that ended before.
    pub before: u64,
    /// How many of them by what, where the task has names for it.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub named: BTreeMap<String, u64>,
}

impl Ends {
    /// Of some episodes, at least one of them sound, of steps of so many s.
    fn of(results: &[EpisodeAnswer], time_step: f64) -> Self {
        let (mut count, mut steps) = (0_u64, 0_u64);
        let mut ends = Self { mean_steps: 0.0, mean_s: 0.0, time_limit: 0, before: 0, named: BTreeMap::new() };
        for episode in results.iter().flatten() {
            (count, steps) = (count + 1, steps + episode.steps as u64);
            match episode.end {
                End::Terminated => ends.before += 1,
                End::Truncated | End::Faulted => ends.time_limit += 1,
            }
            if let Some(name) = &episode.ended_by {
                *ends.named.entry((**name).to_owned()).or_default() += 1;
            }
        }
        ends.mean_steps = steps as f64 / count as f64;
        ends.mean_s = ends.mean_steps * time_step;
        ends
    }
}

/// As a sentence has it: `600 of 1000 ran to the time limit, 400 ended before it (fallen 300, tilted 100)`.
impl std::fmt::Display for Ends {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match (self.time_limit, self.before) {
            (_, 0) => return write!(f, "all ran to the time limit"),
            (0, _) => write!(f, "all ended before the time limit")?,
            (ran, before) => {
                write!(f, "{ran} of {} ran to the time limit, {before} ended before it", ran + before)?;
            }
        }
        let named: Vec<String> = self.named.iter().map(|(name, count)| format!("{name} {count}")).collect();
        if named.is_empty() { Ok(()) } else { write!(f, " ({})", named.join(", ")) }
    }
}

/// How many episodes of a kind succeeded.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SuccessRate {
    /// The kind, the object's shape for one; `all` for every episode.
    pub kind: String,
    /// Episodes that succeeded.
    pub successes: u64,
    /// Episodes run.
    pub episodes: u64,
    /// The lower end of Wilson's 95 % interval of the share.
    pub low: f64,
    /// The upper end.
    pub high: f64,
}

impl SuccessRate {
    /// The share that succeeded.
    pub fn rate(&self) -> f64 {
        self.successes as f64 / self.episodes as f64
    }
}

#[allow(clippy::trivially_copy_pass_by_ref)] // as serde calls it
fn is_zero(count: &u64) -> bool {
    *count == 0
}

/// Over all episodes, then kind by kind in the order of their names; empty where the task knows no success.
fn success_rates(results: &[EpisodeAnswer]) -> Vec<SuccessRate> {
    let mut kinds: BTreeMap<&str, (u64, u64)> = BTreeMap::new();
    for outcome in results.iter().flatten().filter_map(|e| e.outcome.as_ref()) {
        let (successes, episodes) = kinds.entry(&*outcome.kind).or_default();
        *successes += u64::from(outcome.success);
        *episodes += 1;
    }
    if kinds.is_empty() {
        return Vec::new();
    }
    let all = kinds.values().fold((0, 0), |sum, count| (sum.0 + count.0, sum.1 + count.1));
    let rate = |kind: &str, (successes, episodes)| {
        let Interval { low, high } = wilson(successes, episodes);
        SuccessRate { kind: kind.to_owned(), successes, episodes, low, high }
    };
    // A task that knows no kinds calls all of its episodes so.
    let told = kinds.iter().filter(|(kind, _)| **kind != "all");
    std::iter::once(rate("all", all)).chain(told.map(|(kind, &count)| rate(kind, count))).collect()
}

impl Evaluation {
    /// What the episodes of a world come to: so many, from the starts of a root seed.
    pub fn new(results: &[EpisodeAnswer], env: &EnvSpec, (episodes, seed): (u64, u64)) -> Result<Self, StatsError> {
        let returns = |pick: fn(&EpisodeResult) -> f64| results.iter().flatten().map(pick).collect::<Vec<_>>();
        let discounted = returns(|e| e.discounted_return);
        let mut stream = Stream::seed_from_u64(seed);
        let sample = Sample::new(&discounted)?;
        let of_terms: Vec<&[f64]> = results.iter().flatten().map(|e| &*e.terms).collect();
        Ok(Self {
            episodes,
            seed,
            discounted_return: mean_interval(&discounted, &mut stream)?,
            undiscounted_return: mean_interval(&returns(|e| e.undiscounted_return), &mut stream)?,
            median_discounted_return: sample.quantile(0.5),
            worst_discounted_return: sample.min(),
            discarded_episodes: results.iter().filter(|result| result.is_err()).count() as u64,
            ends: Some(Ends::of(results, env.time_step)),
            success: success_rates(results),
            terms: env.terms.iter().cloned().zip(mean_terms(&of_terms)).collect(),
        })
    }
}

pub(crate) fn mean_interval(values: &[f64], stream: &mut Stream) -> Result<MeanInterval, StatsError> {
    Ok(MeanInterval { mean: Sample::new(values)?.mean(), interval: bootstrap_interval(values, Sample::mean, stream)? })
}
