//! What is searched: coordinates of candidates, and the policy's parameters that act for them.

use hwasp_algos::{Archive, Ars, ArsConfig, Bo, Cmaes, CmaesConfig, RandomSearch, Search, SearchError, StateFilter};
use hwasp_core::Policy;
use hwasp_experiment::{Method, Score};

use super::state::{Scored, State};
use crate::assemble::Assembly;
use crate::error::TrainError;

/// The space of a search: all parameters of a policy, or the design alone.
pub(super) struct SearchSpace<'a> {
    pub(super) assembly: &'a Assembly,
    /// The policy's parameters at the start.
    pub(super) start: Vec<f32>,
}

impl<'a> SearchSpace<'a> {
    pub(super) fn new(assembly: &'a Assembly) -> Self {
        Self { assembly, start: assembly.init() }
    }

    /// A search at its beginning, or where it was interrupted.
    pub(super) fn state(&self, from: Option<&Archive>) -> Result<State, TrainError> {
        let spec = self.assembly.experiment();
        let filters = spec.method == Method::Ars && spec.ars.variant.filters();
        let filter = filters.then(|| StateFilter::new(self.assembly.policy.obs_dim()));
        Ok(State::new(self.searcher()?, filter, self.start.len(), from)?)
    }

    pub(super) fn searcher(&self) -> Result<Box<dyn Search>, SearchError> {
        let spec = self.assembly.experiment();
        let (cmaes, ars) = (&spec.cmaes, &spec.ars);
        let start = self.coordinates();
        // Fractions of ranges have limits.
        let limits = |at: f64| spec.method.trains_inside().then(|| vec![at; start.len()]);
        match spec.method {
            Method::Ars | Method::ArsRl => {
                let config = ArsConfig { lower: limits(0.0), upper: limits(1.0), ..ars.config.clone() };
                Ok(Box::new(Ars::new(config, start, spec.seed)?))
            }
            Method::BoRl => Ok(Box::new(Bo::new(spec.bo.clone(), start, spec.seed)?)),
            Method::RandomRl => Ok(Box::new(RandomSearch::new(spec.random.clone(), start, spec.seed)?)),
            _ => {
                let config = CmaesConfig { lower: limits(0.0), upper: limits(1.0), ..cmaes.clone() };
                Ok(Box::new(Cmaes::new(config, &start, spec.seed)?))
            }
        }
    }

    /// The start as the search sees it: all parameters, or the design as fractions of its ranges.
    pub(super) fn coordinates(&self) -> Vec<f64> {
        let policy = &self.assembly.policy;
        if !self.assembly.experiment().method.trains_inside() {
            return self.start.iter().map(|&p| f64::from(p)).collect();
        }
        let design = policy.design(&self.start);
        let fraction = |&i: &usize| {
            let (lo, hi) = policy.space().bounds(i);
            (design[i] - lo) / (hi - lo)
        };
        policy.free_design().iter().map(fraction).collect()
    }

    /// A candidate as parameters of the policy, without a filter.
    pub(super) fn params(&self, candidate: &[f64]) -> Vec<f32> {
        if !self.assembly.experiment().method.trains_inside() {
            return candidate.iter().map(|&x| x as f32).collect();
        }
        let policy = &self.assembly.policy;
        let mut params = self.start.clone();
        let at = policy.design_params().start;
        for (k, (&i, &x)) in policy.free_design().iter().zip(candidate).enumerate() {
            let (lo, hi) = policy.space().bounds(i);
            params[at + k] = policy.space().unsquash(i, lo + x * (hi - lo)) as f32;
        }
        params
    }

    /// The parameters that act for a candidate.
    pub(super) fn acting(&self, candidate: &[f64], filter: Option<&StateFilter>) -> Vec<f32> {
        let mut params = self.params(candidate);
        if let Some(filter) = filter {
            filter.fold(&mut params, self.assembly.policy.controller().sizes()[1]);
        }
        params
    }

    /// What a candidate is worth to the search; a failed one ranks last.
    pub(super) fn score(&self, scored: &Scored) -> f64 {
        scored.returns.as_ref().map_or(f64::NEG_INFINITY, |returns| match self.assembly.experiment().search.score {
            Score::Return => returns.undiscounted,
            Score::DiscountedReturn => returns.discounted,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Candidates of a search over the design are fractions of its ranges. Without limits they and the centre left [0, 1], where the
    /// design is the same as at the limit and only chance tells candidates apart.
    #[test]
    fn fractions_of_ranges_stay_in_them() {
        for (method, key, far) in [
            ("ars-rl", "ars.noise_std", "2"),
            ("cmaes-rl", "cmaes.sigma", "2"),
            ("bo-rl", "bo.popsize", "2"),
            ("random-rl", "random.popsize", "2"),
        ] {
            let layers = hwasp_testing::layers("mass-spring").with_override("train.env_steps", "1e7");
            let layers = layers.with_override(key, far);
            let assembly = Assembly::new(&hwasp_testing::resolve(layers, Some(method)).unwrap()).unwrap();
            let mut search = SearchSpace::new(&assembly).searcher().unwrap();
            let inside = |point: &[f64]| point.len() == 10 && point.iter().all(|x| (0.0..=1.0).contains(x));
            for generation in 0..20 {
                let candidates = search.ask();
                assert!(candidates.iter().all(|candidate| inside(candidate)), "{method}: {candidates:?}");
                // The higher the better: towards a corner.
                let scores: Vec<f64> = candidates.iter().map(|candidate| candidate.iter().sum()).collect();
                search.tell(&scores).unwrap();
                assert!(inside(&search.center()), "{method}, generation {generation}: {:?}", search.center());
            }
        }
    }
}
