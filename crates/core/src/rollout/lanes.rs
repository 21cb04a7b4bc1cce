//! Episodes of one job, in lock step.

use super::{Batch, Episode, EpisodeKind, EpisodeResult, Episodes, RolloutError, discounted};
use crate::environment::{End, Environment};
use crate::placement::ActionDecoder;
use crate::policy::{Actor, HardwarePolicy, Policy};
use crate::streams::{Purpose, Stream, stream};

/// What is written down of each step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Keep {
    /// Everything that a learner needs.
    Rows,
    /// The reward alone.
    Rewards,
}

/// Episodes in lock step.
pub(super) struct Lanes<'p> {
    policy: &'p HardwarePolicy,
    pub(super) environments: Vec<Box<dyn Environment>>,
    decoders: Vec<ActionDecoder>,
    noise: Vec<Stream>,
    noisy: bool,
    horizon: usize,
    keep: Keep,
    /// Rows of episode e begin at e·horizon until the end, when gaps are closed. Nothing but rewards where no more is kept.
    batch: Batch,
    ends: Vec<Option<(End, usize)>>,
    reset: Purpose,
    /// The log-probability of what was drawn for each episode.
    drawn: Vec<f32>,
}

impl<'p> Lanes<'p> {
    /// One episode in each of the environments.
    pub(super) fn new(
        policy: &'p HardwarePolicy,
        environments: Vec<Box<dyn Environment>>,
        episodes: &Episodes,
        keep: Keep,
    ) -> Self {
        let (reset, noise) = match episodes.kind {
            EpisodeKind::Training | EpisodeKind::Deterministic => (Purpose::TrainingReset, Purpose::TrainingNoise),
            EpisodeKind::Evaluation | EpisodeKind::NoisyEvaluation => {
                (Purpose::EvaluationReset, Purpose::EvaluationNoise)
            }
        };
        let named = |purpose, index| stream(episodes.seed, purpose, episodes.iteration, index);
        let count = environments.len();
        let horizon = environments.first().map_or(0, |e| e.spec().horizon);
        let rows = match keep {
            Keep::Rows => count * horizon,
            Keep::Rewards => 0,
        };
        let batch = Batch {
            obs: vec![0.0; rows * policy.obs_dim()],
            state: vec![0.0; rows * policy.state_dim()],
            action: vec![0.0; rows * policy.action_dim()],
            log_prob: vec![0.0; rows],
            reward: vec![0.0; count * horizon],
            episodes: Vec::new(),
            faults: Vec::new(),
        };
        Self {
            policy,
            decoders: vec![policy.action_decoder(); count],
            noise: episodes.indices.clone().map(|index| named(noise, index)).collect(),
            noisy: matches!(episodes.kind, EpisodeKind::Training | EpisodeKind::NoisyEvaluation),
            environments,
            horizon,
            keep,
            batch,
            ends: vec![None; count],
            reset,
            drawn: vec![0.0; count],
        }
    }

    /// Starts an episode. What is drawn once for it is drawn, and its world is told the design before it is put into its start.
    /// `sees` is what the controller sees of the design.
    fn start(&mut self, e: usize, actor: &mut Actor<'_>, episodes: &Episodes, sees: &mut [f32]) {
        let design = actor.begin(e, self.noisy.then_some(&mut self.noise[e]));
        self.policy.see_design(design, sees);
        let environment = &mut self.environments[e];
        environment.set_progress(episodes.progress);
        environment.set_design(design);
        let index = episodes.indices.start + e as u64;
        environment.reset(&mut stream(episodes.seed, self.reset, episodes.iteration, index));
        self.drawn[e] = actor.draw_log_prob(e);
    }

    /// Starts all episodes and steps them to their ends.
    ///
    /// # Errors
    /// The one with the lowest index that gave a number that is none.
    pub(super) fn run(&mut self, actor: &mut Actor<'_>, episodes: &Episodes) -> Result<(), RolloutError> {
        let count = self.environments.len();
        let (obs_dim, state_dim, action_dim) =
            (self.policy.obs_dim(), self.policy.state_dim(), self.policy.action_dim());
        let mut seen = vec![0.0; self.policy.observations()];
        let mut obs = vec![0.0; count * obs_dim];
        for e in 0..count {
            self.start(e, actor, episodes, &mut obs[e * obs_dim..(e + 1) * obs_dim][seen.len()..]);
        }
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
                let decoder = &mut self.decoders[e];
                let action = actor.action(e);
                decoder.decode(action, actor.unsampled(e), state);
                let result = self.environments[e].step(&decoder.effort, &decoder.command);
                let row = e * self.horizon + step;
                let log_prob = actor.log_prob(e);
                self.batch.reward[row] = result.reward;
                if self.keep == Keep::Rows {
                    let seen = &obs[e * obs_dim..][..obs_dim];
                    self.batch.obs[row * obs_dim..][..obs_dim].copy_from_slice(seen);
                    for (to, &from) in self.batch.state[row * state_dim..].iter_mut().zip(state) {
                        *to = from as f32;
                    }
                    for (to, &from) in self.batch.action[row * action_dim..].iter_mut().zip(action) {
                        *to = from as f32;
                    }
                    self.batch.log_prob[row] = log_prob;
                }
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
                } else if !self.drawn[e].is_finite() {
                    Some(format!("the log-probability of the design is {}", self.drawn[e]))
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

    /// What each episode came to, in order.
    pub(super) fn results(&mut self, episodes: &Episodes, discount: f64) -> Vec<Result<EpisodeResult, RolloutError>> {
        let mut faults = std::mem::take(&mut self.batch.faults);
        let result = |(e, environment): (usize, &dyn Environment)| {
            let index = episodes.indices.start + e as u64;
            if let Some(at) = faults.iter().position(|fault| fault.episode == index) {
                return Err(faults.swap_remove(at));
            }
            let (end, steps) = self.ends[e].unwrap_or((End::Truncated, self.horizon));
            let rewards = &self.batch.reward[e * self.horizon..][..steps];
            Ok(EpisodeResult {
                discounted_return: discounted(rewards, discount),
                undiscounted_return: discounted(rewards, 1.0),
                steps,
                end,
                outcome: environment.outcome(),
            })
        };
        self.environments.iter().map(AsRef::as_ref).enumerate().map(result).collect()
    }

    /// All rows: closes the gaps that early ends and discarded episodes have left.
    pub(super) fn batch(&mut self) -> Batch {
        let obs_dim = self.policy.obs_dim();
        let widths = [obs_dim, self.policy.state_dim(), self.policy.action_dim(), 1];
        let mut at = 0;
        let (mut seen, mut state) = (vec![0.0; self.policy.observations()], vec![0.0; widths[1]]);
        let mut context = vec![0.0; self.policy.context_dim()];
        self.batch.episodes.reserve_exact(self.ends.len());
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
            // What it sees of the design it sees in every row.
            let design = (at + len - 1) * obs_dim + seen.len()..(at + len) * obs_dim;
            last_obs[seen.len()..].copy_from_slice(&batch.obs[design]);
            self.environments[e].state(&mut state);
            self.environments[e].context(&mut context);
            let single = |values: &[f64]| values.iter().map(|&x| x as f32).collect();
            let (last_state, context) = (single(&state), single(&context));
            let outcome = self.environments[e].outcome();
            let (rows, log_prob) = (at..at + len, self.drawn[e]);
            batch.episodes.push(Episode { rows, end, last_obs, last_state, context, log_prob, outcome });
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
