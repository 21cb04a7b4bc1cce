//! Rollouts: whole episodes by index, in lock step, over any number of threads with the same bits.

use std::ops::Range;
use std::sync::{Arc, Mutex, MutexGuard};

use thiserror::Error;

use crate::environment::{End, Environment, MakeEnvironment, Outcome};
use crate::executor::Executor;
use crate::placement::Body;
use crate::policy::{Actor, HardwarePolicy, Policy};
use crate::streams::{Purpose, Stream, stream};

/// Episodes that one job steps in lock step, at most.
const LANES: usize = 32;

/// One episode of a [`Batch`].
#[derive(Clone, Debug, PartialEq)]
pub struct Episode {
    /// Its rows in the batch.
    pub rows: Range<usize>,
    /// How it ended.
    pub end: End,
    /// What the controller would have seen next: the state whose value a truncated episode is bootstrapped from.
    pub last_obs: Vec<f32>,
    /// The law's state there, SI.
    pub last_state: Vec<f32>,
    /// What the episode was about and no sensor told, SI.
    pub context: Vec<f32>,
    /// Whether it succeeded, for tasks that know.
    pub outcome: Option<Outcome>,
}

/// Whole episodes, one row per step, an episode's rows one after the other.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Batch {
    /// Controller inputs `[rows × obs_dim]`.
    pub obs: Vec<f32>,
    /// The law's state `[rows × state_dim]`, SI.
    pub state: Vec<f32>,
    /// Actions as sampled, not clipped `[rows × action_dim]`, SI.
    pub action: Vec<f32>,
    /// Their log-probabilities.
    pub log_prob: Vec<f32>,
    /// Rewards.
    pub reward: Vec<f64>,
    /// The episodes, by index, without those whose physics failed.
    pub episodes: Vec<Episode>,
    /// Those whose physics failed; their rows were thrown away.
    pub faults: Vec<RolloutError>,
}

impl Batch {
    /// The number of rows.
    pub fn rows(&self) -> usize {
        self.reward.len()
    }

    /// Real simulator steps taken, those of discarded episodes included.
    pub fn env_steps(&self) -> u64 {
        self.rows() as u64 + self.faults.iter().map(|f| f.step as u64 + 1).sum::<u64>()
    }

    /// The discounted return of each episode, Σ discount^t·reward.
    pub fn returns(&self, discount: f64) -> Vec<f64> {
        self.episodes
            .iter()
            .map(|e| self.reward[e.rows.clone()].iter().rev().fold(0.0, |sum, r| r + discount * sum))
            .collect()
    }

    /// Makes room for so many rows in all, and no more: what grows by doubling takes up to twice as much.
    fn reserve(&mut self, rows: usize, policy: &HardwarePolicy) {
        let more = rows - self.rows();
        self.obs.reserve_exact(more * policy.obs_dim());
        self.state.reserve_exact(more * policy.state_dim());
        self.action.reserve_exact(more * policy.action_dim());
        self.log_prob.reserve_exact(more);
        self.reward.reserve_exact(more);
    }

    fn append(&mut self, other: Self) {
        let at = self.rows();
        self.obs.extend(other.obs);
        self.state.extend(other.state);
        self.action.extend(other.action);
        self.log_prob.extend(other.log_prob);
        self.reward.extend(other.reward);
        self.episodes.extend(other.episodes.into_iter().map(|mut e| {
            e.rows = e.rows.start + at..e.rows.end + at;
            e
        }));
        self.faults.extend(other.faults);
    }
}

/// Why an episode is worth nothing.
#[derive(Clone, Debug, Error, PartialEq)]
#[error("episode {episode} of iteration {iteration} (seed {seed}) failed at step {step}: {what}")]
pub struct RolloutError {
    /// The run's root seed.
    pub seed: u64,
    /// The iteration.
    pub iteration: u64,
    /// The episode's index in it.
    pub episode: u64,
    /// The step.
    pub step: usize,
    /// What went wrong.
    pub what: String,
}

/// Which episodes to run, and how.
#[derive(Clone, Debug)]
pub struct Episodes {
    /// The root seed.
    pub seed: u64,
    /// Part of the streams' names; evaluation uses 0.
    pub iteration: u64,
    /// Indices of the episodes.
    pub indices: Range<u64>,
    /// Fraction of training done, for schedules of noise and task.
    pub progress: f64,
    /// Training episodes explore; evaluation episodes start from held-out seeds.
    pub kind: EpisodeKind,
}

/// What episodes are for: chooses the streams, and whether there is noise.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EpisodeKind {
    /// With action noise.
    Training,
    /// The starts of training, the deterministic policy: for searches, whose noise is in the parameters.
    Deterministic,
    /// Held-out starts, the deterministic policy.
    Evaluation,
    /// Held-out starts, with action noise.
    NoisyEvaluation,
}

/// Runs episodes of one policy in environments of one kind. Environments are made once per thread and reused.
pub struct Sampler {
    policy: Arc<HardwarePolicy>,
    make: Arc<dyn MakeEnvironment>,
    horizon: Option<usize>,
    idle: Mutex<Vec<Box<dyn Environment>>>,
}

impl std::fmt::Debug for Sampler {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Sampler").field("policy", &self.policy).field("horizon", &self.horizon).finish_non_exhaustive()
    }
}

impl Sampler {
    /// `horizon` replaces the task's own episode length.
    pub fn new(policy: Arc<HardwarePolicy>, make: Arc<dyn MakeEnvironment>, horizon: Option<usize>) -> Self {
        Self { policy, make, horizon, idle: Mutex::new(Vec::new()) }
    }

    /// The policy that acts.
    pub fn policy(&self) -> &Arc<HardwarePolicy> {
        &self.policy
    }

    /// Runs the episodes and returns them in the order of their indices.
    ///
    /// # Errors
    /// Where a reward or a log-probability is no number, or where the physics failed in every episode. Told is the one with
    /// the lowest index, whatever the number of workers.
    pub fn collect(&self, executor: &dyn Executor, params: &[f32], episodes: &Episodes) -> Result<Batch, RolloutError> {
        let count = (episodes.indices.end - episodes.indices.start) as usize;
        let lanes = count.div_ceil(executor.workers()).clamp(1, LANES);
        let jobs = count.div_ceil(lanes);
        let parts = executor.map(jobs, |job| {
            let first = episodes.indices.start + (job * lanes) as u64;
            let indices = first..(first + lanes as u64).min(episodes.indices.end);
            self.run(params, &Episodes { indices, ..episodes.clone() })
        });
        let parts = parts.into_iter().collect::<Result<Vec<_>, _>>()?;
        let rows = parts.iter().map(Batch::rows).sum::<usize>();
        let mut parts = parts.into_iter();
        let mut batch = parts.next().unwrap_or_default();
        batch.reserve(rows, &self.policy);
        for part in parts {
            batch.append(part);
        }
        match batch.faults.first() {
            Some(fault) if batch.episodes.is_empty() => Err(fault.clone()),
            _ => Ok(batch),
        }
    }

    fn idle(&self) -> MutexGuard<'_, Vec<Box<dyn Environment>>> {
        self.idle.lock().expect("nothing panics while the list is locked")
    }

    /// Takes an idle environment or makes one.
    fn environment(&self) -> Box<dyn Environment> {
        let idle = self.idle().pop();
        idle.unwrap_or_else(|| self.make.make(self.horizon))
    }

    /// One job: its episodes in lock step.
    fn run(&self, params: &[f32], episodes: &Episodes) -> Result<Batch, RolloutError> {
        let count = (episodes.indices.end - episodes.indices.start) as usize;
        let environments = (0..count).map(|_| self.environment()).collect();
        let mut lanes = Lanes::new(&self.policy, environments, episodes);
        let mut actor = Actor::new(&self.policy, params, episodes.progress, count);
        let result = lanes.run(&mut actor, episodes).map(|()| lanes.finish());
        self.idle().append(&mut lanes.environments);
        result
    }
}

/// Episodes in lock step.
struct Lanes<'p> {
    policy: &'p HardwarePolicy,
    environments: Vec<Box<dyn Environment>>,
    bodies: Vec<Body>,
    noise: Vec<Stream>,
    noisy: bool,
    horizon: usize,
    /// Rows of episode e begin at e·horizon until the end, when gaps are closed.
    batch: Batch,
    ends: Vec<Option<(End, usize)>>,
}

impl<'p> Lanes<'p> {
    fn new(policy: &'p HardwarePolicy, environments: Vec<Box<dyn Environment>>, episodes: &Episodes) -> Self {
        let (reset, noise) = match episodes.kind {
            EpisodeKind::Training | EpisodeKind::Deterministic => (Purpose::TrainingReset, Purpose::TrainingNoise),
            EpisodeKind::Evaluation | EpisodeKind::NoisyEvaluation => {
                (Purpose::EvaluationReset, Purpose::EvaluationNoise)
            }
        };
        let mut environments = environments;
        let named = |purpose, index| stream(episodes.seed, purpose, episodes.iteration, index);
        for (environment, index) in environments.iter_mut().zip(episodes.indices.clone()) {
            environment.set_progress(episodes.progress);
            environment.reset(&mut named(reset, index));
        }
        let count = environments.len();
        let horizon = environments.first().map_or(0, |e| e.spec().horizon);
        let rows = count * horizon;
        let batch = Batch {
            obs: vec![0.0; rows * policy.obs_dim()],
            state: vec![0.0; rows * policy.state_dim()],
            action: vec![0.0; rows * policy.action_dim()],
            log_prob: vec![0.0; rows],
            reward: vec![0.0; rows],
            episodes: Vec::with_capacity(count),
            faults: Vec::new(),
        };
        Self {
            policy,
            bodies: vec![policy.body(); count],
            noise: episodes.indices.clone().map(|index| named(noise, index)).collect(),
            noisy: matches!(episodes.kind, EpisodeKind::Training | EpisodeKind::NoisyEvaluation),
            environments,
            horizon,
            batch,
            ends: vec![None; count],
        }
    }

    fn run(&mut self, actor: &mut Actor<'_>, episodes: &Episodes) -> Result<(), RolloutError> {
        let count = self.environments.len();
        let (obs_dim, state_dim, action_dim) =
            (self.policy.obs_dim(), self.policy.state_dim(), self.policy.action_dim());
        let mut seen = vec![0.0; obs_dim];
        let mut obs = vec![0.0; count * obs_dim];
        // The law reads columns, the plant's law a row.
        let mut columns = vec![0.0; state_dim * count];
        let mut states = vec![0.0; count * state_dim];
        // The failed episode with the lowest index, which is the one that is told whatever other lanes there are: those
        // above it need not go on, those below may still fail.
        let mut failed = None;
        let mut lanes = count;
        for step in 0..self.horizon {
            let mut running = false;
            for e in 0..lanes {
                if self.ends[e].is_some() {
                    continue;
                }
                running = true;
                let environment = &self.environments[e];
                environment.observe(&mut seen);
                self.policy.normalize(&seen, &mut obs[e * obs_dim..][..obs_dim]);
                let state = &mut states[e * state_dim..][..state_dim];
                environment.state(state);
                for (s, &x) in state.iter().enumerate() {
                    columns[s * count + e] = x;
                }
            }
            if !running {
                break;
            }
            actor.act(&obs, &columns, count, self.noisy.then_some(&mut self.noise[..]));
            for e in 0..lanes {
                if self.ends[e].is_some() {
                    continue;
                }
                let state = &states[e * state_dim..][..state_dim];
                let body = &mut self.bodies[e];
                let action = actor.action(e);
                body.apply(action, state);
                let result = self.environments[e].step(&body.effort, &body.command);
                let row = e * self.horizon + step;
                self.batch.obs[row * obs_dim..][..obs_dim].copy_from_slice(&obs[e * obs_dim..][..obs_dim]);
                for (to, &from) in self.batch.state[row * state_dim..].iter_mut().zip(state) {
                    *to = from as f32;
                }
                for (to, &from) in self.batch.action[row * action_dim..].iter_mut().zip(action) {
                    *to = from as f32;
                }
                let log_prob = actor.log_prob(e);
                self.batch.log_prob[row] = log_prob;
                self.batch.reward[row] = result.reward;
                let error = |what| RolloutError {
                    seed: episodes.seed,
                    iteration: episodes.iteration,
                    episode: episodes.indices.start + e as u64,
                    step,
                    what,
                };
                // What is no number in an observation or an action shows here, too.
                let not_finite = if !log_prob.is_finite() {
                    Some(format!("the log-probability of the action is {log_prob}"))
                } else if !result.reward.is_finite() {
                    Some(format!("the reward is {}", result.reward))
                } else {
                    None
                };
                if let Some(what) = not_finite {
                    failed = Some(error(what));
                    lanes = e;
                    break;
                }
                if let Some(end) = result.end {
                    if end == End::Faulted {
                        let what = self.environments[e].fault();
                        self.batch.faults.push(error(what.unwrap_or_else(|| "the physics failed".into())));
                    }
                    self.ends[e] = Some((end, step + 1));
                }
            }
        }
        failed.map_or(Ok(()), Err)
    }

    /// Closes the gaps that early ends and discarded episodes have left.
    fn finish(&mut self) -> Batch {
        let obs_dim = self.policy.obs_dim();
        let widths = [obs_dim, self.policy.state_dim(), self.policy.action_dim(), 1];
        let mut at = 0;
        let (mut seen, mut state) = (vec![0.0; obs_dim], vec![0.0; widths[1]]);
        let mut context = vec![0.0; self.policy.context_dim()];
        for (e, end) in self.ends.iter().enumerate() {
            let (end, len) = end.unwrap_or((End::Truncated, self.horizon));
            if end == End::Faulted {
                continue;
            }
            let from = e * self.horizon;
            let batch = &mut self.batch;
            let columns = [&mut batch.obs, &mut batch.state, &mut batch.action, &mut batch.log_prob];
            if from != at {
                for (column, width) in columns.into_iter().zip(widths) {
                    column.copy_within(from * width..(from + len) * width, at * width);
                }
                batch.reward.copy_within(from..from + len, at);
            }
            let mut last_obs = vec![0.0; obs_dim];
            self.environments[e].observe(&mut seen);
            self.policy.normalize(&seen, &mut last_obs);
            self.environments[e].state(&mut state);
            self.environments[e].context(&mut context);
            let single = |values: &[f64]| values.iter().map(|&x| x as f32).collect();
            let (last_state, context) = (single(&state), single(&context));
            let outcome = self.environments[e].outcome();
            batch.episodes.push(Episode { rows: at..at + len, end, last_obs, last_state, context, outcome });
            at += len;
        }
        let batch = &mut self.batch;
        for (column, width) in
            [&mut batch.obs, &mut batch.state, &mut batch.action, &mut batch.log_prob].into_iter().zip(widths)
        {
            column.truncate(at * width);
        }
        batch.reward.truncate(at);
        batch.faults.sort_by_key(|fault| fault.episode);
        std::mem::take(batch)
    }
}
