//! A world tried out before anything is trained in it: with random commands and designs.

use std::collections::BTreeMap;
use std::time::Instant;

use hwasp_core::{End, EnvFault, Purpose, check_env, stream};
use hwasp_problem::World;
use rand::RngExt;

/// Episodes that are tried.
const EPISODES: u64 = 8;
/// The most steps of each.
const STEPS: usize = 250;

/// Steps within which an episode is over as it begins.
pub const AT_ONCE: usize = 3;

/// What a world did when it was tried.
#[derive(Clone, Debug)]
pub struct Trial {
    /// Time of an environment step, s of this machine; none where there was no step.
    pub step_s: Option<f64>,
    /// How much longer an episode takes to begin where the design is another one, s; none where no model is made from it.
    pub remake_s: Option<f64>,
    /// Episodes that were begun.
    pub episodes: u64,
    /// Their steps, at most [`Trial::most_steps`] each.
    pub steps: usize,
    /// The most steps that an episode had.
    pub most_steps: usize,
    /// Episodes that ended before that, by themselves.
    pub ended: u64,
    /// Episodes that ended by themselves within [`AT_ONCE`] steps.
    pub at_once: u64,
    /// How many of them by what, where the task has names for it.
    pub ended_by: BTreeMap<String, u64>,
    /// Episodes whose physics failed, and how the first of them did.
    pub failed: (u64, Option<String>),
    /// Whether every episode starts alike.
    pub fixed_start: bool,
    /// The first promise of environments that it broke.
    pub broken: Option<EnvFault>,
}

impl Trial {
    /// Tries a world whose physics are set up.
    pub fn of(world: &World) -> Self {
        let mut env = world.make.make(None);
        let (law, spec) = (&world.law, env.spec().clone());
        let most_steps = STEPS.min(spec.horizon);
        let mut trial = Self {
            step_s: None,
            remake_s: None,
            episodes: EPISODES,
            steps: 0,
            most_steps,
            ended: 0,
            at_once: 0,
            ended_by: BTreeMap::new(),
            failed: (0, None),
            fixed_start: false,
            broken: None,
        };
        let reads = law.reads(&spec.command).unwrap_or_default();
        let (mut state, mut effort) = (vec![0.0; spec.state.len()], vec![0.0; spec.effort.len()]);
        let (mut stepping, mut remaking) = (0.0, 0.0);
        for episode in 0..EPISODES {
            let rng = &mut stream(0, Purpose::Check, 2, episode);
            let mut between = |lo: f64, hi: f64| lo + (hi - lo) * rng.random::<f64>();
            let design: Vec<f64> =
                (0..law.design().len()).map(|i| law.design().bounds(i)).map(|(a, b)| between(a, b)).collect();
            env.set_design(&design);
            let mut begin = || {
                let began = Instant::now();
                env.reset(&mut stream(0, Purpose::Check, 0, episode));
                began.elapsed().as_secs_f64()
            };
            // The second time the model is there.
            remaking += begin() - begin();
            for step in 0..most_steps {
                let command: Vec<f64> = spec.command.iter().map(|port| between(port.lo, port.hi)).collect();
                let read: Vec<f64> = reads.iter().map(|&c| command[c]).collect();
                env.state(&mut state);
                law.effort(&design, &read, &state, &mut effort);
                let began = Instant::now();
                let end = env.step(&effort, &command).end;
                stepping += began.elapsed().as_secs_f64();
                trial.steps += 1;
                match end {
                    None => continue,
                    Some(End::Faulted) => {
                        trial.failed.0 += 1;
                        let why = env.fault().unwrap_or_else(|| "for no reason that it tells".to_owned());
                        trial.failed.1.get_or_insert(format!("step {}: {why}", step + 1));
                    }
                    Some(End::Terminated) => {
                        trial.ended += 1;
                        if step < AT_ONCE {
                            trial.at_once += 1;
                        }
                        if let Some(name) = env.ended_by() {
                            *trial.ended_by.entry((*name).to_owned()).or_default() += 1;
                        }
                    }
                    Some(End::Truncated) => {}
                }
                break;
            }
        }
        trial.step_s = (trial.steps > 0).then(|| stepping / trial.steps as f64);
        trial.remake_s = (!spec.shaped_by.is_empty()).then(|| (remaking / EPISODES as f64).max(0.0));
        trial.broken = check_env(&*world.make, law, false).err();
        if let Some(EnvFault::Starts { distinct: 1, .. }) = trial.broken {
            trial.fixed_start = true;
            trial.broken = check_env(&*world.make, law, true).err();
        }
        trial
    }

    /// Whether most episodes end as they begin, where they could be longer.
    pub fn is_over_at_once(&self) -> bool {
        self.most_steps > AT_ONCE && 2 * self.at_once > self.episodes
    }

    /// Mean steps of an episode.
    pub fn mean_steps(&self) -> f64 {
        self.steps as f64 / self.episodes as f64
    }
}
