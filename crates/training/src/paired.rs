//! Two designs or controllers on the same held-out episodes: what the one is worth more than the other.
//!
//! Episodes of one index begin alike and meet the same noise whatever acts in them (common random numbers), so that the
//! difference of two of them varies far less than either.

use hwasp_core::{EnvSpec, EpisodeResult, Stream};
use rand::SeedableRng;
use serde::{Deserialize, Serialize};

use crate::assemble::Assembly;
use crate::collect::{Collector, EpisodeAnswer, ExperimentText, Stage};
use crate::evaluate::rollouts;
use crate::evaluation::{EvaluateError, Evaluation, MeanInterval, mean_interval};
use crate::stats::StatsError;

/// What changed between two evaluations on the same episodes: means of the differences, episode by episode, with their 95 %
/// bootstrap intervals.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Change {
    /// Episodes that both have; those whose physics failed in either are left out.
    pub episodes: u64,
    /// Of the undiscounted return.
    #[serde(rename = "return")]
    pub undiscounted_return: MeanInterval,
    /// Of the share of successes, for tasks that know success.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub success: Option<MeanInterval>,
}

/// An evaluation that others are held against, in the world where the result has to work.
pub struct Reference<'a> {
    assembly: &'a Assembly,
    /// The name of its experiment in requests.
    experiment: ExperimentText,
    /// Episodes and the root seed of their starts.
    asked: (u64, u64),
    collector: &'a dyn Collector,
    /// What it is worth.
    pub evaluation: Evaluation,
    trials: Vec<Option<Trial>>,
}

/// What the world where the result has to work is from outside.
fn env(assembly: &Assembly) -> &EnvSpec {
    &assembly.worlds.deployment.env
}

impl<'a> Reference<'a> {
    /// The controller in `params` on the hardware of `design`, SI, in episodes that `collector` gives.
    pub fn new(
        collector: &'a dyn Collector,
        assembly: &'a Assembly,
        design: &[f64],
        params: &[f32],
        asked: (u64, u64),
    ) -> Result<Self, EvaluateError> {
        let experiment = ExperimentText::of(assembly.experiment())?;
        let stage = Stage::Deployment(design.to_vec());
        let results = rollouts(collector, assembly, experiment.clone(), stage, params, asked)?;
        let (evaluation, trials) = (Evaluation::new(&results, env(assembly), asked)?, trials(&results));
        Ok(Self { assembly, experiment, asked, collector, evaluation, trials })
    }

    /// Another design or another controller on the same episodes, and what that changes.
    pub fn against(&self, design: &[f64], params: &[f32]) -> Result<(Evaluation, Change), EvaluateError> {
        let stage = Stage::Deployment(design.to_vec());
        let experiment = self.experiment.clone();
        let results = rollouts(self.collector, self.assembly, experiment, stage, params, self.asked)?;
        let change = Change::between(&self.trials, &trials(&results), self.asked.1)?;
        Ok((Evaluation::new(&results, env(self.assembly), self.asked)?, change))
    }
}

/// How one episode went.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Trial {
    undiscounted_return: f64,
    success: Option<bool>,
}

/// The episodes by index; none where the physics failed.
fn trials(results: &[EpisodeAnswer]) -> Vec<Option<Trial>> {
    let trial = |episode: &EpisodeResult| Trial {
        undiscounted_return: episode.undiscounted_return,
        success: episode.outcome.as_ref().map(|outcome| outcome.success),
    };
    results.iter().map(|result| result.as_ref().ok().map(trial)).collect()
}

impl Change {
    /// From some episodes to others that began alike; `seed` names the resamples.
    pub fn of(before: &[EpisodeAnswer], after: &[EpisodeAnswer], seed: u64) -> Result<Self, StatsError> {
        Self::between(&trials(before), &trials(after), seed)
    }

    /// From some trials to others of the same episodes; `seed` names the resamples.
    fn between(before: &[Option<Trial>], after: &[Option<Trial>], seed: u64) -> Result<Self, StatsError> {
        let pairs: Vec<(Trial, Trial)> = before.iter().zip(after).filter_map(|(b, a)| b.zip(*a)).collect();
        let mut stream = Stream::seed_from_u64(seed);
        let returns: Vec<f64> = pairs.iter().map(|(b, a)| a.undiscounted_return - b.undiscounted_return).collect();
        let share = |success: bool| f64::from(u8::from(success));
        let successes: Option<Vec<f64>> =
            pairs.iter().map(|(b, a)| Some(share(a.success?) - share(b.success?))).collect();
        Ok(Self {
            episodes: pairs.len() as u64,
            undiscounted_return: mean_interval(&returns, &mut stream)?,
            success: successes.map(|successes| mean_interval(&successes, &mut stream)).transpose()?,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn trial(undiscounted_return: f64, success: bool) -> Trial {
        Trial { undiscounted_return, success: Some(success) }
    }

    #[test]
    fn differences_are_taken_episode_by_episode() {
        let before = [Some(trial(100.0, true)), Some(trial(-50.0, false)), None, Some(trial(7.0, true))];
        let after = [Some(trial(99.0, false)), Some(trial(-51.0, false)), Some(trial(1.0, true)), None];
        let change = Change::between(&before, &after, 1).unwrap();
        // Returns far apart, and each but one lower. Two episodes carry no interval.
        let one = MeanInterval { mean: -1.0, interval: None };
        assert_eq!((change.episodes, change.undiscounted_return), (2, one));
        assert_eq!(change.success, Some(MeanInterval { mean: -0.5, interval: None }));
    }

    #[test]
    fn tasks_without_success_have_no_change_of_it() {
        let plain = [Some(Trial { undiscounted_return: 2.0, success: None })];
        assert_eq!(Change::between(&plain, &plain, 1).unwrap().success, None);
        assert_eq!(Change::between(&plain, &[None], 1), Err(StatsError::Empty));
    }
}
