//! Runs held-out episodes as the evaluation does, and keeps what is to be seen of them.

use std::collections::BTreeSet;
use std::sync::{Arc, Mutex, MutexGuard};

use hwasp_core::{End, Environment, EpisodeResult, MakeEnvironment, Serial, Sight, Step, Stream, Watch, Watched};
use hwasp_training::{Assembly, EvaluateError, World, held_out, sampler};

/// The most moments that are kept of an episode.
const MOST_MOMENTS: usize = 200;
/// Time between moments where they are not too many, s.
const PACE: f64 = 0.05;
/// Episodes that are looked through for those that are shown.
pub const LOOKED_THROUGH: u64 = 16;
/// What tasks call the kind of their episodes where there is but one.
const ONE_KIND: &str = "all";
/// The most kinds of episodes that are shown.
const MOST_KINDS: usize = 6;

/// A moment of an episode.
#[derive(Clone, Debug)]
pub struct Moment {
    /// Steps before it.
    pub step: usize,
    /// The return so far, undiscounted.
    pub worth: f64,
    /// How it looked.
    pub sight: Sight,
}

/// An episode on film.
#[derive(Clone, Debug)]
pub struct Take {
    /// Its index among the held-out episodes.
    pub index: u64,
    /// Why it is shown: `best`, `worst`, a kind of episode; may be empty.
    pub name: String,
    /// Moments, the first and the last of the episode among them.
    pub moments: Vec<Moment>,
    /// What it came to.
    pub result: EpisodeResult,
    /// What a step lasts, s.
    pub time_step: f64,
}

impl Take {
    /// What kind of episode it is, where its task has several.
    pub fn kind(&self) -> Option<&str> {
        self.result.outcome.as_ref().map(|outcome| &*outcome.kind).filter(|kind| *kind != ONE_KIND)
    }

    /// Whether it succeeded, where its task knows.
    pub fn success(&self) -> Option<bool> {
        self.result.outcome.as_ref().map(|outcome| outcome.success)
    }
}

/// A world whose episodes can be filmed, with the controller that acts in them.
pub struct Studio<'a> {
    assembly: &'a Assembly,
    world: &'a World,
    design: &'a [f64],
    params: &'a [f32],
    /// The root seed of the starts.
    seed: u64,
}

impl<'a> Studio<'a> {
    /// A controller (`params` of the assembly's policy) in a world on a design, SI; `seed` is the root seed of the starts.
    pub fn new(
        (assembly, params): (&'a Assembly, &'a [f32]),
        (world, design): (&'a World, &'a [f64]),
        seed: u64,
    ) -> Self {
        Self { assembly, world, design, params, seed }
    }

    /// Which episodes to show, each with why: the first of each kind, where there are several; else the best and the worst.
    pub fn choice(&self) -> Result<Vec<(u64, String)>, EvaluateError> {
        let sampler = sampler(self.assembly, self.world, self.design)?;
        let controller = self.assembly.policy.controller_params(self.params);
        let results = sampler.outcomes(&Serial, controller, &held_out(self.seed, 0..LOOKED_THROUGH), 1.0)?;
        let sound = || (0..).zip(&results).filter_map(|(i, result)| Some((i, result.as_ref().ok()?)));
        let kind = |result: &EpisodeResult| result.outcome.as_ref().map(|outcome| Arc::clone(&outcome.kind));
        let kinds: BTreeSet<Arc<str>> = sound().filter_map(|(_, result)| kind(result)).collect();
        if kinds.len() > 1 {
            let first = |of: &Arc<str>| sound().find(|(_, result)| kind(result).as_ref() == Some(of));
            let mut chosen: Vec<(u64, String)> =
                kinds.iter().filter_map(|of| Some((first(of)?.0, of.to_string()))).collect();
            chosen.sort_unstable();
            chosen.truncate(MOST_KINDS);
            return Ok(chosen);
        }
        let worth = |result: &EpisodeResult| result.undiscounted_return;
        let by_worth = |a: &(u64, &EpisodeResult), b: &(u64, &EpisodeResult)| worth(a.1).total_cmp(&worth(b.1));
        let (best, worst) = (sound().max_by(by_worth), sound().min_by(by_worth));
        Ok(match best.zip(worst) {
            Some(((best, _), (worst, _))) if best != worst => {
                vec![(best, "best".to_owned()), (worst, "worst".to_owned())]
            }
            Some(((only, _), _)) => vec![(only, String::new())],
            None => Vec::new(),
        })
    }

    /// Films an episode; none where nothing is to be seen of this world.
    pub fn take(&self, index: u64, name: String) -> Result<Option<Take>, EvaluateError> {
        let kept = Arc::new(Mutex::new(Kept::default()));
        let filmed = Filmed { make: Arc::clone(&self.world.make), kept: Arc::clone(&kept) };
        let world = World::described(self.world.law.clone(), self.world.env.clone(), Arc::new(filmed));
        let sampler = sampler(self.assembly, &world, self.design)?;
        let controller = self.assembly.policy.controller_params(self.params);
        let discount = self.assembly.experiment().discount();
        let results = sampler.outcomes(&Serial, controller, &held_out(self.seed, index..index + 1), discount)?;
        let moments = std::mem::take(&mut lock(&kept).moments);
        let result = results.into_iter().next().and_then(Result::ok);
        Ok(result.filter(|_| !moments.is_empty()).map(|result| Take {
            index,
            name,
            moments,
            result,
            time_step: self.world.env.time_step,
        }))
    }
}

/// What is kept of the episode at hand.
#[derive(Debug, Default)]
struct Kept {
    moments: Vec<Moment>,
    stride: usize,
    taken: usize,
    worth: f64,
}

impl Kept {
    fn keep(&mut self, sight: Option<Sight>) {
        let Some(sight) = sight else { return };
        // Every other one makes room, however long the episode becomes.
        if self.moments.len() == MOST_MOMENTS {
            self.stride *= 2;
            let stride = self.stride;
            self.moments.retain(|moment| moment.step % stride == 0);
        }
        self.moments.push(Moment { step: self.taken, worth: self.worth, sight });
    }
}

fn lock(kept: &Mutex<Kept>) -> MutexGuard<'_, Kept> {
    kept.lock().expect("nothing panics while a film is locked")
}

/// Makes environments that are filmed. They share one film: to be run one episode at a time.
struct Filmed {
    make: Arc<dyn MakeEnvironment>,
    kept: Arc<Mutex<Kept>>,
}

impl MakeEnvironment for Filmed {
    fn make(&self, horizon: Option<usize>) -> Box<dyn Environment> {
        Box::new(Watched::new(self.make.make(horizon), Camera { kept: Arc::clone(&self.kept) }))
    }
}

/// Somebody who looks at an environment.
struct Camera {
    kept: Arc<Mutex<Kept>>,
}

impl Watch for Camera {
    fn reset(&mut self, inner: &mut dyn Environment, rng: &mut Stream) {
        inner.reset(rng);
        let stride = (PACE / inner.spec().time_step).floor().max(1.0) as usize;
        let mut kept = lock(&self.kept);
        *kept = Kept { stride, ..Kept::default() };
        kept.keep(inner.look());
    }

    fn step(&mut self, inner: &mut dyn Environment, effort: &[f64], command: &[f64]) -> Step {
        let step = inner.step(effort, command);
        let mut kept = lock(&self.kept);
        kept.taken += 1;
        kept.worth += step.reward;
        // Where the physics failed there is nothing to see.
        let due = step.end.is_some() || kept.taken.is_multiple_of(kept.stride);
        if due && step.end != Some(End::Faulted) {
            kept.keep(inner.look());
        }
        step
    }
}
