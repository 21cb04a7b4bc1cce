//! What trainings and searches cost, in real simulator steps, and how an experiment's budget is spent: never more than it
//! holds, and less by no more than the smallest [`Piece`] of the method.

use hwasp_algos::CmaesConfig;
use hwasp_core::Policy;
use hwasp_experiment::Method;

use super::{AssembleError, Assembly};

/// Episodes on which the last centre and the best candidate are compared: a candidate that was best of many on few
/// episodes was lucky, too.
pub(crate) const FINAL_EPISODES: usize = 16;

/// The smallest part of a training that a method does whole or not at all.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Piece {
    /// What it is, in a word.
    pub what: &'static str,
    /// Real simulator steps that it takes, at most.
    pub env_steps: u64,
}

impl Assembly {
    /// The episodes of the iteration that follows so many steps, 0 where the budget is spent.
    ///
    /// Iterations are as the experiment has them, but for the last: it takes what is left, from half to one and a half times
    /// the usual number of episodes. The gradient is then a mean over a sensible number of episodes, and the budget is spent to
    /// within an episode. Where episodes end early, [`further_episodes`](Self::further_episodes) spend the rest.
    pub(crate) fn iteration_episodes(&self, env_steps: u64) -> u64 {
        let usual = self.experiment().train.episodes_per_iteration as u64;
        match self.whole_episodes(env_steps) {
            left if 2 * left >= 3 * usual => usual,
            left if 2 * left >= usual => left,
            _ => 0,
        }
    }

    /// The episodes by which the iteration at hand grows, once it has come to so many steps: where episodes end early, and what
    /// that leaves is too little for an iteration of its own. A gradient of a few episodes would be mostly noise, and be followed
    /// as far as any other.
    pub(crate) fn further_episodes(&self, env_steps: u64) -> u64 {
        if self.iteration_episodes(env_steps) > 0 { 0 } else { self.whole_episodes(env_steps) }
    }

    /// Episodes of the full length that the budget holds after so many steps.
    fn whole_episodes(&self, env_steps: u64) -> u64 {
        let train = &self.experiment().train;
        train.env_steps.saturating_sub(env_steps) / train.episode_steps as u64
    }

    /// Iterations of a training whose episodes all have their full length, and the episodes of the last one.
    pub fn iterations(&self) -> (u64, u64) {
        let (whole, usual) = (self.whole_episodes(0), self.experiment().train.episodes_per_iteration as u64);
        match (whole / usual, whole % usual) {
            // Less than half an iteration goes into the one before.
            (iterations, rest) if iterations > 0 && 2 * rest < usual => (iterations, usual + rest),
            (iterations, rest) => (iterations + 1, rest),
        }
    }

    /// What the method cannot divide: less than it is left of the budget. A search whose episodes end early leaves besides what
    /// its last choice did not need of the [`final_steps`](Self::final_steps).
    pub fn piece(&self) -> Piece {
        match self.generation() {
            Some((popsize, each)) => Piece { what: "generation", env_steps: popsize as u64 * each },
            None => Piece { what: "episode", env_steps: self.experiment().train.episode_steps as u64 },
        }
    }

    /// Real simulator steps that one candidate of a search costs, at most.
    pub(crate) fn candidate_steps(&self) -> u64 {
        let spec = self.experiment();
        if spec.method.trains_inside() {
            return spec.search.inner_env_steps;
        }
        spec.search.episodes as u64 * spec.train.episode_steps as u64
    }

    /// What the choice at the end of a search costs, at most.
    pub(crate) fn final_steps(&self) -> u64 {
        let spec = self.experiment();
        if spec.method.trains_inside() { 0 } else { 2 * FINAL_EPISODES as u64 * spec.train.episode_steps as u64 }
    }

    /// Candidates of a generation of the method's search, and the steps of each at most; none where it does not search.
    pub fn generation(&self) -> Option<(usize, u64)> {
        let spec = self.experiment();
        let dimension =
            if spec.method.trains_inside() { self.policy.free_design().len() } else { self.policy.param_count() };
        let popsize = match spec.method {
            Method::Ars | Method::ArsRl => 2 * spec.ars.config.directions,
            Method::Cmaes | Method::CmaesRl => {
                CmaesConfig { popsize: spec.cmaes.popsize, ..CmaesConfig::default() }.first_popsize(dimension)
            }
            Method::Hwasp | Method::Minimal | Method::Fixed => return None,
        };
        Some((popsize, self.candidate_steps()))
    }

    /// Refuses a search whose budget does not hold one generation.
    pub(crate) fn check_budget(&self) -> Result<(), AssembleError> {
        let Some((popsize, each)) = self.generation() else { return Ok(()) };
        if self.experiment().method.trains_inside() && self.policy.free_design().is_empty() {
            return Err(AssembleError::NothingToSearch { method: self.experiment().method.name() });
        }
        let given = self.experiment().train.env_steps;
        let needed = popsize as u64 * each + self.final_steps();
        if given < needed {
            return Err(AssembleError::Budget { given, needed, popsize, each });
        }
        Ok(())
    }
}
