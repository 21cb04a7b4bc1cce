//! What trainings and searches cost, in real simulator steps, and how an experiment's budget is spent: never more than it
//! holds, and less by no more than the smallest [`Piece`] of the method.

use hwasp_algos::CmaesConfig;
use hwasp_core::{LaneSteps, Policy};
use hwasp_experiment::{MOST_MODELLED, Method};

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

/// What an iteration of a training by gradients takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Portion {
    /// So many whole episodes.
    Episodes(u64),
    /// So many steps of lanes.
    Steps(LaneSteps),
}

impl Assembly {
    /// Whether an iteration follows so many steps, in a training by gradients.
    pub fn iterates(&self, env_steps: u64) -> bool {
        self.portion(env_steps).is_some()
    }

    /// What the iteration that follows so many steps takes; none where the budget is spent.
    ///
    /// Iterations are as the experiment has them, but for the last: it takes what is left, from half to one and a half times
    /// the usual number of episodes, or of steps where those are counted. The gradient is then a mean over a sensible number,
    /// and the budget is spent to within an episode, or to the step. Where episodes are counted and end early,
    /// [`further_episodes`](Self::further_episodes) spend the rest.
    pub(crate) fn portion(&self, env_steps: u64) -> Option<Portion> {
        let train = &self.experiment().train;
        let (usual, unit) = self.counted();
        let count = match train.env_steps.saturating_sub(env_steps) / unit {
            left if 2 * left >= 3 * usual => usual,
            left if 2 * left >= usual => left,
            _ => return None,
        };
        let lanes = train.episodes_per_iteration as u64;
        let steps = train.steps_per_iteration > 0;
        Some(if steps { Portion::Steps(LaneSteps { lanes, steps: count }) } else { Portion::Episodes(count) })
    }

    /// How many of what is counted an iteration has, and the most steps of one of them.
    fn counted(&self) -> (u64, u64) {
        let train = &self.experiment().train;
        match train.steps_per_iteration {
            0 => (train.episodes_per_iteration as u64, train.episode_steps as u64),
            steps => (steps as u64, 1),
        }
    }

    /// The episodes by which the iteration at hand grows, once it has come to so many steps: where episodes are counted and end
    /// early, and what that leaves is too little for an iteration of its own. A gradient of a few episodes would be mostly noise,
    /// and be followed as far as any other.
    pub(crate) fn further_episodes(&self, env_steps: u64) -> u64 {
        let train = &self.experiment().train;
        if train.steps_per_iteration > 0 || self.portion(env_steps).is_some() {
            return 0;
        }
        train.env_steps.saturating_sub(env_steps) / train.episode_steps as u64
    }

    /// Iterations of a training, and the episodes of the last one, or its steps where steps are counted. Where episodes are
    /// counted, all have their full length.
    pub fn iterations(&self) -> (u64, u64) {
        let (usual, unit) = self.counted();
        let whole = self.experiment().train.env_steps / unit;
        match (whole / usual, whole % usual) {
            // Less than half an iteration goes into the one before.
            (iterations, rest) if iterations > 0 && 2 * rest < usual => (iterations, usual + rest),
            (iterations, rest) => (iterations + 1, rest),
        }
    }

    /// What the method cannot divide: less than it is left of the budget. A search whose episodes end early leaves besides what
    /// its last choice did not need of the `final_steps`.
    pub fn piece(&self) -> Piece {
        match self.generation() {
            Some((_, each)) if self.experiment().method.divides_generations() => {
                Piece { what: "candidate", env_steps: each }
            }
            Some((popsize, each)) => Piece { what: "generation", env_steps: popsize as u64 * each },
            None if self.experiment().train.steps_per_iteration > 0 => Piece { what: "step", env_steps: 1 },
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
            Method::BoRl => spec.bo.popsize,
            Method::RandomRl => spec.random.popsize,
            Method::Hwasp | Method::Minimal | Method::Episode | Method::Fixed => return None,
        };
        Some((popsize, self.candidate_steps()))
    }

    /// How many of the candidates of a generation the budget holds after so many steps: all of them or none, or the first ones
    /// where the method divides its last generation.
    pub(crate) fn affordable(&self, candidates: usize, env_steps: u64) -> usize {
        let spec = self.experiment();
        let left = spec.train.env_steps.saturating_sub(env_steps + self.final_steps());
        match usize::try_from(left / self.candidate_steps()).unwrap_or(usize::MAX) {
            most if most >= candidates => candidates,
            most if spec.method.divides_generations() => most,
            _ => 0,
        }
    }

    /// Refuses a search whose budget does not hold one generation, or more candidates than its model.
    pub(crate) fn check_budget(&self) -> Result<(), AssembleError> {
        let Some((popsize, each)) = self.generation() else { return Ok(()) };
        if self.experiment().method.trains_inside() && self.policy.free_design().is_empty() {
            let (method, parameters) = (self.experiment().method.name(), self.policy.space().len());
            return Err(AssembleError::NothingToSearch { method, parameters });
        }
        let (given, polish) = (self.experiment().train.env_steps, self.polish_steps());
        if self.experiment().method == Method::BoRl && given / each > MOST_MODELLED {
            return Err(AssembleError::Model { candidates: given / each });
        }
        let popsize = if self.experiment().method.divides_generations() { 1 } else { popsize };
        let needed = popsize as u64 * each + self.final_steps();
        if given - polish < needed {
            return Err(AssembleError::Budget { given, polish, needed, popsize, each });
        }
        Ok(())
    }
}
