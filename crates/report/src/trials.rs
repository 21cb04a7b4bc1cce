//! Held-out episodes that are run once more for a report: those that fail are shown, and the same starts are tried in the world that is
//! nearest to the built robot.

use std::collections::BTreeSet;
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::available_parallelism;

use hwasp_core::{
    Environment, EpisodeResult, Executor, MakeEnvironment, RolloutError, Serial, Sight, Step, Stream, Threads, Watch,
    Watched,
};
use hwasp_runs::{RunError, SavedRun};
use hwasp_training::stats::{Interval, wilson};
use hwasp_training::{Assembly, EvaluateError, StandInKind, World, held_out, sampler};

use crate::run::Run;

/// A run whose episodes can be run.
pub(super) struct Played {
    pub(super) saved: SavedRun,
    /// The policy's parameters.
    pub(super) params: Vec<f32>,
    pub(super) trials: Trials,
}

impl Played {
    /// Opens a run and runs its trials; in words why not, where no episode can be run: for want of an engine, for one.
    ///
    /// # Errors
    /// Of a policy that is missing or damaged.
    pub(super) fn new(run: &Run) -> Result<Result<Self, String>, RunError> {
        let saved = match SavedRun::open(&run.path, run.spec.catalogue()) {
            Ok(saved) => saved,
            Err(RunError::Assemble(error)) => return Ok(Err(error.to_string())),
            Err(error) => return Err(error),
        };
        let params = saved.params()?;
        let trials = Trials::run(saved.assembly(), &params, run.summary.evaluation.seed);
        Ok(trials.map(|trials| Self { saved, params, trials }).map_err(|error| error.to_string()))
    }
}

/// Simulator steps in each world, at most, as long as the episodes are not fewer than the least.
const MOST_STEPS: u64 = 40_000;
const EPISODES: (u64, u64) = (20, 100);
/// Episodes that a film shows: the first successes, each of another kind, and the first failures.
const SHOWN: (usize, usize) = (3, 2);

/// What an episode came to, or how its physics failed.
type EpisodeAnswer = Result<EpisodeResult, RolloutError>;

/// What was tried.
pub(super) struct Trials {
    /// The first held-out episodes, on the hardware as built.
    pub(super) results: Vec<EpisodeAnswer>,
    /// The same in the world that stands in for the built robot, where there is one; or why not.
    pub(super) nearer: Option<(StandInKind, Result<Tally, String>)>,
    /// How an episode looks at its start, where it shows itself.
    pub(super) start: Option<Sight>,
}

/// What episodes came to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Tally {
    /// Those whose physics held.
    pub(super) episodes: u64,
    /// Those that succeeded, for tasks that know success.
    pub(super) successes: Option<u64>,
    /// The mean return.
    pub(super) mean_return: f64,
}

impl Tally {
    fn of(results: &[EpisodeAnswer]) -> Self {
        let sound = || results.iter().flatten();
        let outcomes = || sound().filter_map(|result| result.outcome.as_ref());
        let episodes = sound().count() as u64;
        let successes = outcomes().filter(|outcome| outcome.success).count() as u64;
        Self {
            episodes,
            successes: outcomes().next().map(|_| successes),
            mean_return: sound().map(|result| result.undiscounted_return).sum::<f64>() / episodes as f64,
        }
    }

    /// The share of successes, and Wilson's 95 % interval of it.
    pub(super) fn rate(&self) -> Option<(f64, Interval)> {
        self.successes.map(|count| (count as f64 / self.episodes as f64, wilson(count, self.episodes)))
    }
}

impl Trials {
    /// Runs them.
    ///
    /// # Errors
    /// Where no episode can be run on the hardware as built. Where none can in the nearer world, the trials say so.
    pub(super) fn run(assembly: &Assembly, params: &[f32], seed: u64) -> Result<Self, EvaluateError> {
        let threads = available_parallelism().map_or(1, usize::from);
        let threads: Box<dyn Executor> =
            Threads::new(threads).map_or_else(|_| Box::new(Serial) as Box<dyn Executor>, |threads| Box::new(threads));
        let world = &assembly.worlds.deployment;
        let count = (MOST_STEPS / world.env.horizon.max(1) as u64).clamp(EPISODES.0, EPISODES.1);
        let results = outcomes(assembly, params, (world, &assembly.built(params)), (seed, count), &*threads)?;
        let stand_in = assembly.experiment().task.built().stand_in.as_ref().map(|stand_in| stand_in.kind);
        let nearer = stand_in.map(|kind| {
            let design = assembly.policy.design(params);
            let tried = assembly
                .native(&design)
                .map_err(EvaluateError::from)
                .and_then(|world| outcomes(assembly, params, (&world, &design), (seed, count), &*threads));
            (kind, tried.map(|results| Tally::of(&results)).map_err(|error| error.to_string()))
        });
        Ok(Self { results, nearer, start: start(assembly, params, seed)? })
    }

    /// On the hardware as built.
    pub(super) fn tally(&self) -> Tally {
        Tally::of(&self.results)
    }

    /// The sound episodes with their indices.
    fn sound(&self) -> impl Iterator<Item = (u64, &EpisodeResult)> {
        (0..).zip(&self.results).filter_map(|(index, result)| Some((index, result.as_ref().ok()?)))
    }

    /// Those that failed, with their indices.
    pub(super) fn failures(&self) -> impl Iterator<Item = (u64, &EpisodeResult)> {
        self.sound().filter(|(_, result)| result.outcome.as_ref().is_some_and(|outcome| !outcome.success))
    }

    /// The episodes to be shown, where some failed: successes of several kinds, and failures. Nothing where none did.
    pub(super) fn shown(&self) -> Vec<u64> {
        let failed: Vec<u64> = self.failures().map(|(index, _)| index).take(SHOWN.1).collect();
        if failed.is_empty() {
            return failed;
        }
        let mut kinds = BTreeSet::new();
        let another = |(index, result): (u64, &EpisodeResult)| {
            let outcome = result.outcome.as_ref().filter(|outcome| outcome.success)?;
            kinds.insert(Arc::clone(&outcome.kind)).then_some(index)
        };
        let mut shown: Vec<u64> = self.sound().filter_map(another).take(SHOWN.0).collect();
        shown.extend(failed);
        shown
    }
}

fn outcomes(
    assembly: &Assembly,
    params: &[f32],
    (world, design): (&World, &[f64]),
    (seed, count): (u64, u64),
    executor: &dyn Executor,
) -> Result<Vec<EpisodeAnswer>, EvaluateError> {
    let controller = assembly.policy.controller_params(params);
    let discount = assembly.experiment().discount();
    Ok(sampler(assembly, world, design)?.outcomes(executor, controller, &held_out(seed, 0..count), discount)?)
}

/// How the first episode looks at its start.
fn start(assembly: &Assembly, params: &[f32], seed: u64) -> Result<Option<Sight>, EvaluateError> {
    let seen = Arc::new(Mutex::new(None));
    let world = &assembly.worlds.deployment;
    let make = Arc::new(Seen { make: Arc::clone(&world.make), seen: Arc::clone(&seen) });
    let watched = World::described(world.law.clone(), world.env.clone(), make);
    outcomes(assembly, params, (&watched, &assembly.built(params)), (seed, 1), &Serial)?;
    let seen = seen.lock().unwrap_or_else(PoisonError::into_inner).take();
    Ok(seen)
}

/// Makes environments that are looked at where they begin.
struct Seen {
    make: Arc<dyn MakeEnvironment>,
    seen: Arc<Mutex<Option<Sight>>>,
}

impl MakeEnvironment for Seen {
    fn make(&self, horizon: Option<usize>) -> Box<dyn Environment> {
        Box::new(Watched::new(self.make.make(horizon), Look(Arc::clone(&self.seen))))
    }
}

struct Look(Arc<Mutex<Option<Sight>>>);

impl Watch for Look {
    fn reset(&mut self, inner: &mut dyn Environment, rng: &mut Stream) {
        inner.reset(rng);
        *self.0.lock().unwrap_or_else(PoisonError::into_inner) = inner.look();
    }

    fn step(&mut self, inner: &mut dyn Environment, effort: &[f64], command: &[f64]) -> Step {
        inner.step(effort, command)
    }
}

#[cfg(test)]
mod tests {
    use hwasp_core::{End, Outcome};

    use super::*;

    fn trials(of: &[(&str, bool)]) -> Trials {
        let result = |&(kind, success): &(&str, bool)| {
            Ok(EpisodeResult {
                discounted_return: 0.0,
                undiscounted_return: f64::from(u8::from(success)),
                steps: 10,
                end: End::Truncated,
                ended_by: None,
                outcome: Some(Outcome { kind: kind.into(), success }),
                terms: vec![],
            })
        };
        Trials { results: of.iter().map(result).collect(), nearer: None, start: None }
    }

    #[test]
    fn successes_of_several_kinds_are_shown_and_failures_with_them() {
        let some = trials(&[
            ("box", true),
            ("box", false),
            ("box", true),
            ("sphere", true),
            ("sphere", false),
            ("box", false),
            ("cone", true),
        ]);
        assert_eq!(some.shown(), [0, 3, 6, 1, 4]);
        assert_eq!(some.failures().map(|(index, _)| index).collect::<Vec<_>>(), [1, 4, 5]);
        let tally = some.tally();
        assert_eq!((tally.episodes, tally.successes), (7, Some(4)));
        assert!((tally.mean_return - 4.0 / 7.0).abs() < 1e-12);
        assert_eq!(trials(&[("box", true)]).shown(), [0_u64; 0]);
        assert_eq!(trials(&[("box", false)]).shown(), [0]);
    }
}
