//! The figures of one method over its seeds, and of pairs of methods.

use hwasp_core::Stream;
use hwasp_runs::metrics::MetricsTable;
use hwasp_training::TRAILING;
use hwasp_training::stats::{self, Bootstrap, Improvement, Interval, Sample, StatsError, improvement};
use rand::SeedableRng;
use serde::{Deserialize, Serialize};

use crate::cell::CellResult;
use crate::failure::MissingSeed;
use crate::outcome::Contest;

/// The bootstrap of a comparison draws the same resamples every time.
const RESAMPLES: [u8; 32] = *b"bootstrap of hwasp's comparisons";

/// An interquartile mean over seeds with its 95 % bootstrap interval.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Figure {
    /// The interquartile mean.
    pub iqm: f64,
    /// The interval, as `low` and `high`; none where the seeds
    /// [carry none](hwasp_training::stats#what-a-sample-cannot-carry).
    #[serde(flatten)]
    pub interval: Option<Interval>,
}

impl Figure {
    pub(super) fn of(values: &[f64]) -> Result<Self, StatsError> {
        let sample = Sample::new(values)?;
        let mut stream = Stream::from_seed(RESAMPLES);
        let interval = Bootstrap::default().interval(&sample, Sample::interquartile_mean, &mut stream)?;
        Ok(Self { iqm: sample.interquartile_mean(), interval })
    }

    /// Of values that there may be none of.
    fn of_any(values: &[f64]) -> Result<Option<Self>, StatsError> {
        if values.is_empty() { Ok(None) } else { Self::of(values).map(Some) }
    }
}

/// When a threshold was reached.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Reached {
    /// Seeds that reached it.
    pub seeds: usize,
    /// The median of their real steps; none where less than half of all seeds reached it.
    pub median_env_steps: Option<f64>,
}

impl Reached {
    /// Of the steps of each seed, where it reached it.
    fn of(steps: Vec<Option<f64>>) -> Self {
        let seeds = steps.iter().flatten().count();
        let mut steps: Vec<f64> = steps.into_iter().map(|steps| steps.unwrap_or(f64::INFINITY)).collect();
        steps.sort_unstable_by(f64::total_cmp);
        let middle = |place: usize| steps.get(place).copied();
        let median = middle(steps.len().saturating_sub(1) / 2).zip(middle(steps.len() / 2)).map(|(a, b)| 0.5 * (a + b));
        Self { seeds, median_env_steps: median.filter(|steps| steps.is_finite()) }
    }
}

/// What one method reached. Where no seed finished there are no figures.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct MethodFigures {
    /// The method.
    pub label: String,
    /// How many seeds finished.
    pub seeds: usize,
    /// Those seeds. Comparisons written before 0.1.0 do not name them, nor those that did not finish.
    #[serde(default)]
    pub finished_seeds: Vec<u64>,
    /// The other seeds, each with the reason.
    #[serde(default)]
    pub missing: Vec<MissingSeed>,
    /// Deterministic discounted return on held-out starts, on the hardware as built.
    pub evaluation: Option<Figure>,
    /// The same, seed by seed.
    pub evaluations: Vec<f64>,
    /// Area under the learning curve: the training return's mean over the whole budget.
    pub area_under_curve: Option<Figure>,
    /// Steps to the threshold.
    pub threshold: Reached,
    /// Distance of a design total as built from the known optimum, by group, SI; empty where none is known.
    pub design_error: Vec<(String, Figure)>,
    /// Design totals as built, by group, seed by seed, SI.
    pub design_totals: Vec<(String, Vec<f64>)>,
    /// Real simulator steps charged, the mean over seeds.
    pub env_steps: Option<f64>,
    /// Real simulator steps that each seed may take, at most.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub budget: Option<u64>,
    /// What of them the method takes whole or not at all.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub piece: Option<Indivisible>,
    /// Time of training, s, the mean over seeds.
    pub wall_s: Option<f64>,
    /// Candidates that failed, over all seeds.
    pub failed_candidates: u64,
    /// Finished seeds whose training changed no parameter.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub unchanged_seeds: Vec<u64>,
}

/// The smallest part of a training that its method does whole or not at all.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Indivisible {
    /// `episode` or `generation`.
    pub what: String,
    /// Real simulator steps that it takes, at most.
    pub env_steps: u64,
}

impl MethodFigures {
    /// `cells`: those that finished.
    pub(super) fn of(
        contest: &Contest,
        cells: &[&CellResult],
        missing: Vec<MissingSeed>,
        threshold: Option<f64>,
    ) -> Result<Self, StatsError> {
        let each = |pick: &dyn Fn(&CellResult) -> f64| cells.iter().map(|cell| pick(cell)).collect::<Vec<f64>>();
        let mean = |pick: &dyn Fn(&CellResult) -> f64| stats::mean(&each(pick)).ok();
        let evaluations = each(&|c| c.summary.evaluation.discounted_return.mean);
        let budget = cells.iter().map(|c| c.summary.env_steps).max().unwrap_or(0);
        let mut design_error: Vec<(String, Figure)> = Vec::new();
        let mut design_totals = Vec::new();
        for (group, first) in cells.first().map(|c| &c.summary.design).into_iter().flatten() {
            let totals = each(&|c| c.summary.design.get(group).map_or(f64::NAN, |g| g.total_as_built));
            if let Some(optimum) = first.optimum {
                let errors: Vec<f64> = totals.iter().map(|total| (total - optimum).abs()).collect();
                design_error.push((group.clone(), Figure::of(&errors)?));
            }
            design_totals.push((group.clone(), totals));
        }
        let reached = |c: &&CellResult| threshold.and_then(|threshold| steps_to(&c.metrics, threshold));
        Ok(Self {
            label: contest.label.clone(),
            seeds: cells.len(),
            finished_seeds: cells.iter().map(|c| c.summary.seed).collect(),
            missing,
            evaluation: Figure::of_any(&evaluations)?,
            evaluations,
            area_under_curve: Figure::of_any(&each(&|c| area(&c.metrics, budget)))?,
            threshold: Reached::of(cells.iter().map(reached).collect()),
            design_error,
            design_totals,
            env_steps: mean(&|c| c.summary.env_steps as f64),
            budget: Some(contest.budget),
            piece: Some(Indivisible { what: contest.piece.what.to_owned(), env_steps: contest.piece.env_steps }),
            wall_s: mean(&|c| c.summary.wall_s),
            failed_candidates: cells.iter().filter_map(|c| c.summary.failed_candidates).sum(),
            unchanged_seeds: cells.iter().filter(|c| c.unchanged).map(|c| c.summary.seed).collect(),
        })
    }

    /// How many seeds there should be; none where an old comparison does not say.
    pub fn asked(&self) -> Option<usize> {
        (self.finished_seeds.len() == self.seeds).then(|| self.seeds + self.missing.len())
    }

    /// The seeds whose training changed no parameter, in words: `seeds 0, 2`; none where there are none.
    pub fn unchanged(&self) -> Option<String> {
        let seeds: Vec<String> = self.unchanged_seeds.iter().map(ToString::to_string).collect();
        let many = if seeds.len() == 1 { "seed" } else { "seeds" };
        (!seeds.is_empty()).then(|| format!("{many} {}", seeds.join(", ")))
    }

    /// How many seeds finished, in words: `3 of 5`.
    pub fn finished(&self) -> String {
        self.asked().map_or(self.seeds.to_string(), |asked| format!("{} of {asked}", self.seeds))
    }
}

/// How probably one method is better than another: the share of pairs of seeds in which it is, ties counted half
/// (Agarwal et al. 2021, section 4.3), with the 95 % interval of a bootstrap that resamples both.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Pair {
    /// The one.
    pub method: String,
    /// The other.
    pub other: String,
    /// The probability that the one is better, as `probability`, `low` and `high`; none where the seeds
    /// [carry none](hwasp_training::stats#what-a-sample-cannot-carry).
    #[serde(flatten)]
    pub improvement: Option<Improvement>,
}

impl Pair {
    pub(super) fn of(one: &MethodFigures, other: &MethodFigures) -> Result<Self, StatsError> {
        let mut stream = Stream::from_seed(RESAMPLES);
        let improvement = match (&one.evaluations[..], &other.evaluations[..]) {
            ([], _) | (_, []) => None,
            (one, other) => improvement(one, other, &mut stream)?,
        };
        Ok(Self { method: one.label.clone(), other: other.label.clone(), improvement })
    }
}

/// The mean of the training return over a budget: each row holds for the steps that it took, the last one to the end.
fn area(metrics: &MetricsTable, budget: u64) -> f64 {
    let mut before = 0;
    let mut sum = 0.0;
    let rows = metrics.rows.iter().filter(|row| row.discounted_return.is_finite());
    let mut last = None;
    for row in rows {
        sum += row.discounted_return * (row.env_steps - before) as f64;
        before = row.env_steps;
        last = Some(row.discounted_return);
    }
    sum += last.unwrap_or(f64::NAN) * budget.saturating_sub(before) as f64;
    sum / budget.max(1) as f64
}

/// The mean over the last rows at each row.
pub(super) fn trailing(metrics: &MetricsTable) -> impl Iterator<Item = (u64, f64)> + '_ {
    (0..metrics.rows.len()).map(|end| {
        let rows = &metrics.rows[(end + 1).saturating_sub(TRAILING)..=end];
        let mean = rows.iter().map(|row| row.discounted_return).sum::<f64>() / rows.len() as f64;
        (metrics.rows[end].env_steps, mean)
    })
}

/// Real steps at which the trailing mean of the training return reached a threshold.
fn steps_to(metrics: &MetricsTable, threshold: f64) -> Option<f64> {
    trailing(metrics).find(|(_, mean)| *mean >= threshold).map(|(steps, _)| steps as f64)
}

/// Nine tenths of the way from the worst first return of all runs to the best last one.
pub(super) fn default_threshold(cells: &[CellResult]) -> Option<f64> {
    let firsts = cells.iter().filter_map(|c| c.metrics.rows.first()).map(|row| row.discounted_return);
    let lasts = cells.iter().filter_map(|c| trailing(&c.metrics).last()).map(|(_, mean)| mean);
    let (worst, best) = (firsts.fold(f64::INFINITY, f64::min), lasts.fold(f64::NEG_INFINITY, f64::max));
    Some(worst + 0.9 * (best - worst)).filter(|threshold| threshold.is_finite())
}

#[cfg(test)]
mod tests {
    use hwasp_training::MetricsRow;

    use super::*;

    fn table(rows: &[(u64, f64)]) -> MetricsTable {
        let row = |(i, &(env_steps, discounted_return)): (usize, &(u64, f64))| MetricsRow {
            iteration: i as u64,
            env_steps,
            discounted_return,
            ..MetricsRow::default()
        };
        MetricsTable { rows: rows.iter().enumerate().map(row).collect(), ..MetricsTable::default() }
    }

    #[test]
    fn the_area_by_hand() {
        let metrics = table(&[(100, -10.0), (300, -4.0)]);
        assert_eq!(area(&metrics, 300), (-10.0 * 100.0 - 4.0 * 200.0) / 300.0);
        // What ended early keeps its last return.
        assert_eq!(area(&metrics, 600), (-10.0 * 100.0 - 4.0 * 500.0) / 600.0);
    }

    #[test]
    fn steps_to_a_threshold_count_the_trailing_mean() {
        let metrics = table(&[(100, -10.0), (200, 0.0), (300, 0.0), (400, 0.0)]);
        assert_eq!(steps_to(&metrics, -5.0), Some(200.0));
        assert_eq!(steps_to(&metrics, -3.0), Some(400.0), "one lucky row does not do");
        assert_eq!(steps_to(&metrics, -1.0), None);
    }
}
