//! Methods that search: over controller and design at once, or over the design with a training inside.

mod state;

use std::ops::Range;

use hwasp_algos::{Archive, Ars, ArsConfig, Cmaes, CmaesConfig, Search, SearchError, StateFilter};
use hwasp_core::{EpisodeKind, Episodes, Policy, Purpose, Sampler, Serial, stream};
use hwasp_experiment::{Method, Score};
use rand::RngExt;

use self::state::{Generation, Scored, State};
use crate::assemble::{Assembly, FINAL_EPISODES};
use crate::error::TrainError;
use crate::gradient::{gradient, mean_returns};
use crate::learned::{Clock, Learned, Loop};
use crate::observer::Event;

/// What is searched and how a candidate is scored.
struct Candidates<'a> {
    assembly: &'a Assembly,
    sampler: Sampler,
    /// The policy's parameters at the start.
    start: Vec<f32>,
}

/// Searches until the budget does not hold another generation, from the beginning or from where a search was interrupted.
pub(crate) fn search(assembly: &Assembly, run: &mut Loop<'_>, from: Option<&Archive>) -> Result<Learned, TrainError> {
    let spec = assembly.experiment();
    let problem = Candidates::new(assembly);
    let mut state = problem.state(from)?;
    run.clock = Clock::start(state.learned.wall_s);
    while state.search.stopped().is_none() {
        let candidates = state.search.ask();
        let cost = candidates.len() as u64 * assembly.candidate_steps() + assembly.final_steps();
        if state.learned.env_steps + cost > spec.train.env_steps {
            break;
        }
        let scored = Generation { problem: &problem, candidates: &candidates }.score(&mut state, run)?;
        problem.tell(&mut state, scored, run)?;
        if run.observer.due() {
            run.observer.on(Event::Checkpoint(&state.checkpoint(run.clock)?))?;
        }
    }
    // What is left to do, an evaluation, may be long.
    run.observer.on(Event::Checkpoint(&state.checkpoint(run.clock)?))?;
    Ok(problem.outcome(state))
}

/// The parameters of the best candidate that an interrupted search had found; those of the start where none was scored.
pub(crate) fn best_so_far(assembly: &Assembly, from: &Archive) -> Result<Vec<f32>, TrainError> {
    let problem = Candidates::new(assembly);
    let best = problem.state(Some(from))?.best;
    Ok(best.map_or(problem.start, |(_, params)| params))
}

impl<'a> Candidates<'a> {
    fn new(assembly: &'a Assembly) -> Self {
        let steps = assembly.experiment().train.episode_steps;
        let sampler = Sampler::new(assembly.policy.clone(), assembly.worlds.training.make.clone(), Some(steps));
        Self { assembly, sampler, start: assembly.init() }
    }

    /// A search at its beginning, or where it was interrupted.
    fn state(&self, from: Option<&Archive>) -> Result<State, TrainError> {
        let spec = self.assembly.experiment();
        let filters = spec.method == Method::Ars && spec.ars.variant.filters();
        let filter = filters.then(|| StateFilter::new(self.assembly.policy.obs_dim()));
        Ok(State::new(self.searcher()?, filter, self.start.len(), from)?)
    }

    fn searcher(&self) -> Result<Box<dyn Search>, SearchError> {
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
            _ => {
                let config = CmaesConfig { lower: limits(0.0), upper: limits(1.0), ..cmaes.clone() };
                Ok(Box::new(Cmaes::new(config, &start, spec.seed)?))
            }
        }
    }

    /// The start as the search sees it: all parameters, or the design as fractions of its ranges.
    fn coordinates(&self) -> Vec<f64> {
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
    fn params(&self, candidate: &[f64]) -> Vec<f32> {
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
    fn acting(&self, candidate: &[f64], filter: Option<&StateFilter>) -> Vec<f32> {
        let mut params = self.params(candidate);
        if let Some(filter) = filter {
            filter.fold(&mut params, self.assembly.policy.controller().sizes()[1]);
        }
        params
    }

    fn pick(&self, (discounted, undiscounted): (f64, f64)) -> f64 {
        match self.assembly.experiment().search.score {
            Score::Return => undiscounted,
            Score::DiscountedReturn => discounted,
        }
    }

    /// Runs episodes. One that fails fails its candidate, which is charged all of its steps.
    fn run(&self, params: Vec<f32>, iteration: u64, indices: Range<u64>, filters: bool) -> Scored {
        let spec = self.assembly.experiment();
        let kind = if spec.search.noise { EpisodeKind::Training } else { EpisodeKind::Deterministic };
        let count = indices.end - indices.start;
        let asked = Episodes { seed: spec.seed, iteration, indices, progress: 0.0, kind };
        let Ok(batch) = self.sampler.collect(&Serial, &params, &asked) else {
            let env_steps = count * spec.train.episode_steps as u64;
            return Scored { params, env_steps, ..Scored::default() };
        };
        let sound = batch.faults.is_empty();
        Scored {
            params,
            returns: sound.then(|| mean_returns(&batch, spec.discount())),
            env_steps: batch.env_steps(),
            discarded_episodes: batch.faults.len() as u64,
            seen: if sound && filters { batch.obs } else { Vec::new() },
        }
    }

    /// Trains a controller of its own for a candidate's design. All candidates of a generation begin with the same weights
    /// and see the same random numbers.
    fn train_inside(
        &self,
        mut params: Vec<f32>,
        generation: u64,
        run: &mut Loop<'_>,
        from: Option<&Archive>,
    ) -> Result<Scored, TrainError> {
        let policy = &self.assembly.policy;
        // TOML holds no seed beyond 2^63.
        let seed = stream(self.assembly.experiment().seed, Purpose::InnerSeed, generation, 0).random::<u64>() >> 1;
        let env_steps = self.assembly.experiment().search.inner_env_steps;
        let inner = self.assembly.frozen(&policy.design(&params), seed, env_steps)?;
        match gradient(&inner, run, from) {
            Ok(learned) => {
                let controller = inner.policy.controller_params(&learned.params);
                params[..controller.len()].copy_from_slice(controller);
                let returns = learned.trailing();
                let Learned { env_steps, discarded_episodes, .. } = learned;
                Ok(Scored { params, returns: Some(returns), env_steps, discarded_episodes, seen: Vec::new() })
            }
            Err(TrainError::Rollout(_) | TrainError::Learn(_) | TrainError::Physics { .. }) => {
                Ok(Scored { params, env_steps, ..Scored::default() })
            }
            Err(other) => Err(other),
        }
    }

    /// Goes on to the next generation.
    fn tell(&self, state: &mut State, scored: Vec<Scored>, run: &mut Loop<'_>) -> Result<(), TrainError> {
        let learned = &mut state.learned;
        learned.env_steps += scored.iter().map(|s| s.env_steps).sum::<u64>();
        learned.discarded_episodes += scored.iter().map(|s| s.discarded_episodes).sum::<u64>();
        if let Some(filter) = &mut state.filter {
            for candidate in &scored {
                filter.update(&candidate.seen);
            }
        }
        let scores: Vec<f64> = scored.iter().map(|s| s.returns.map_or(f64::NEG_INFINITY, |r| self.pick(r))).collect();
        state.search.tell(&scores)?;
        let sound: Vec<(f64, f64)> = scored.iter().filter_map(|s| s.returns).collect();
        learned.failed_candidates += (scored.len() - sound.len()) as u64;
        for (candidate, score) in scored.into_iter().zip(scores) {
            if state.best.as_ref().is_none_or(|(most, _)| score > *most) {
                state.best = Some((score, candidate.params));
            }
        }
        let mean = |pick: fn(&(f64, f64)) -> f64| sound.iter().map(pick).sum::<f64>() / sound.len() as f64;
        let policy = &self.assembly.policy;
        let totals = policy.space().totals(&policy.design(&self.params(&state.search.center())));
        // There is no policy whose change or spread could be told.
        Ok(learned.tell((mean(|r| r.0), mean(|r| r.1)), None, totals, run)?)
    }

    /// What a search came to: the best candidate, whose controller was trained for it; or the better of that and the last
    /// centre, on the same fresh episodes.
    fn outcome(self, state: State) -> Learned {
        let State { search, filter, best, mut learned, .. } = state;
        learned.params = match best {
            None => self.start,
            Some((_, best)) if self.assembly.experiment().method.trains_inside() => best,
            Some((_, best)) => {
                let both = [self.acting(&search.center(), filter.as_ref()), best];
                let scored = both.map(|params| self.run(params, search.generation(), 0..FINAL_EPISODES as u64, false));
                learned.env_steps += scored.iter().map(|s| s.env_steps).sum::<u64>();
                learned.discarded_episodes += scored.iter().map(|s| s.discarded_episodes).sum::<u64>();
                let [center, best] = scored;
                let score = |s: &Scored| s.returns.map_or(f64::NEG_INFINITY, |r| self.pick(r));
                if score(&best) > score(&center) { best.params } else { center.params }
            }
        };
        learned
    }
}
