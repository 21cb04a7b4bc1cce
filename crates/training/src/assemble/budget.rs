//! What a search costs, in real simulator steps, and whether an experiment's budget holds it.

use hwasp_algos::CmaesConfig;
use hwasp_core::Policy;
use hwasp_experiment::Method;

use super::{AssembleError, Assembly};

/// Episodes on which the last centre and the best candidate are compared: a candidate that was best of many on few
/// episodes was lucky, too.
pub(crate) const FINAL_EPISODES: usize = 16;

impl Assembly {
    /// Real simulator steps that one candidate of a search costs, at most.
    pub(crate) fn candidate_steps(&self) -> u64 {
        let spec = self.experiment();
        if spec.method.trains_inside() {
            // A training ends with a whole iteration.
            return spec.search.inner_env_steps.next_multiple_of(spec.train.rows() as u64);
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
