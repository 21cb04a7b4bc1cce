//! Episodes of one job, in lock step.

use super::{Batch, Episode, EpisodeKind, EpisodeResult, Episodes, LaneSteps, RolloutError, discounted};
use crate::environment::{End, Environment};
use crate::moments::Moments;
use crate::placement::ActionDecoder;
use crate::policy::{Actor, HardwarePolicy, Normalizer, Policy};
use crate::streams::{Purpose, Stream, stream};

/// What is written down of each step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Keep {
    /// Everything that a learner needs: of one episode in each lane, or of as many as fill its share of these steps.
    Rows(Option<LaneSteps>),
    /// The reward alone, of one episode in each lane.
    Rewards,
}

/// Episodes in lock step.
pub(super) struct Lanes<'p> {
    policy: &'p HardwarePolicy,
    normalizer: Normalizer,
    pub(super) environments: Vec<Box<dyn Environment>>,
    decoders: Vec<ActionDecoder>,
    noise: Vec<Stream>,
    noisy: bool,
    keep: Keep,
    /// Rows of lane e begin at e·stride until the end, when gaps are closed.
    stride: usize,
    /// Nothing but rewards where no more is kept.
    batch: Batch,
    stands: Vec<Lane>,
    /// The log-probability of what was drawn for the episode at hand of each lane.
    drawn: Vec<f32>,
    /// The episodes that are over, with their rows before gaps are closed, in the order in which they ended.
    over: Vec<Over>,
    /// Working memory: an observation and a state, SI.
    seen: Vec<f64>,
    state: Vec<f64>,
}

/// Where a lane stands.
struct Lane {
    /// Steps that it takes, at most.
    share: usize,
    /// Its step with which the episode at hand began.
    began: usize,
    /// Episodes before that one.
    before: u64,
    /// How its last episode ended, and after how many steps; none while it goes on.
    end: Option<(End, usize)>,
    /// Of what was observed in the episode at hand, where the statistics are asked for.
    observed: Option<Moments>,
}

/// A sound episode.
struct Over {
    episode: Episode,
    observed: Option<Moments>,
}

impl<'p> Lanes<'p> {
    /// One episode in each of the environments.
    pub(super) fn new(
        policy: &'p HardwarePolicy,
        params: &[f32],
        environments: Vec<Box<dyn Environment>>,
        episodes: &Episodes,
        keep: Keep,
    ) -> Self {
        let count = environments.len();
        let horizon = environments.first().map_or(0, |e| e.spec().horizon);
        let steps = if let Keep::Rows(steps) = keep { steps } else { None };
        let observes = keep != Keep::Rewards && episodes.kind == EpisodeKind::Training;
        let observes = observes && policy.spec().normalize.is_some();
        let lane = |index| {
            let share = steps.map_or(horizon, |steps| steps.share(index));
            let end = (share == 0).then_some((End::Truncated, 0));
            let observed = observes.then(|| Moments::new(policy.observations()));
            Lane { share, began: 0, before: 0, end, observed }
        };
        let stands: Vec<Lane> = episodes.indices.clone().map(lane).collect();
        let stride = stands.iter().map(|lane| lane.share).max().unwrap_or(0);
        let rows = if keep == Keep::Rewards { 0 } else { count * stride };
        let batch = Batch {
            obs: vec![0.0; rows * policy.obs_dim()],
            state: vec![0.0; rows * policy.state_dim()],
            action: vec![0.0; rows * policy.action_dim()],
            log_prob: vec![0.0; rows],
            reward: vec![0.0; count * stride],
            ..Batch::default()
        };
        Self {
            policy,
            normalizer: policy.normalizer(params),
            decoders: vec![policy.action_decoder(); count],
            // Each is begun anew with its episodes.
            noise: vec![stream(episodes.seed, Purpose::TrainingNoise, 0, 0); count],
            noisy: matches!(episodes.kind, EpisodeKind::Training | EpisodeKind::NoisyEvaluation),
            environments,
            keep,
            stride,
            batch,
            stands,
            drawn: vec![0.0; count],
            over: Vec::new(),
            seen: vec![0.0; policy.observations()],
            state: vec![0.0; policy.state_dim()],
        }
    }

    /// Starts the episode of this index in a lane. What is drawn once for it is drawn, and its world is told the design before it
    /// is put into its start. `sees` is what the controller sees of the design.
    fn start(&mut self, e: usize, index: u64, actor: &mut Actor<'_>, episodes: &Episodes, sees: &mut [f32]) {
        let (reset, noise) = match episodes.kind {
            EpisodeKind::Training | EpisodeKind::Deterministic => (Purpose::TrainingReset, Purpose::TrainingNoise),
            EpisodeKind::Evaluation | EpisodeKind::NoisyEvaluation => {
                (Purpose::EvaluationReset, Purpose::EvaluationNoise)
            }
        };
        let named = |purpose| stream(episodes.seed, purpose, episodes.iteration, index);
        self.noise[e] = named(noise);
        let design = actor.begin(e, self.noisy.then_some(&mut self.noise[e]));
        self.policy.see_design(design, sees);
        let environment = &mut self.environments[e];
        environment.set_progress(episodes.progress);
        environment.set_design(design);
        environment.reset(&mut named(reset));
        self.drawn[e] = actor.draw_log_prob(e);
    }

    /// The index of the episode at hand in a lane.
    fn index(&self, e: usize, episodes: &Episodes) -> u64 {
        let lane = episodes.indices.start + e as u64;
        match self.keep {
            Keep::Rows(Some(steps)) => steps.episode(lane, self.stands[e].before),
            Keep::Rows(None) | Keep::Rewards => lane,
        }
    }

    /// Starts the first episode of every lane and steps all lanes to their ends.
    ///
    /// # Errors
    /// The one with the lowest index that gave a number that is none.
    pub(super) fn run(&mut self, actor: &mut Actor<'_>, episodes: &Episodes) -> Result<(), RolloutError> {
        let count = self.environments.len();
        let (obs_dim, state_dim, action_dim) =
            (self.policy.obs_dim(), self.policy.state_dim(), self.policy.action_dim());
        let observations = self.seen.len();
        let mut obs = vec![0.0; count * obs_dim];
        for (e, index) in episodes.indices.clone().enumerate() {
            self.start(e, index, actor, episodes, &mut obs[e * obs_dim..][observations..obs_dim]);
        }
        // The law reads columns, the plant's law a row.
        let mut columns = vec![0.0; state_dim * count];
        let mut states = vec![0.0; count * state_dim];
        // The failed episode with the lowest index, which is the one that is told whatever other lanes there are: those
        // above it need not go on, those below may still fail.
        let mut failed = None;
        let mut lanes = count;
        for step in 0..self.stride {
            let mut running = false;
            for e in 0..lanes {
                let lane = &mut self.stands[e];
                if lane.end.is_some() {
                    continue;
                }
                running = true;
                let environment = &self.environments[e];
                environment.observe(&mut self.seen);
                self.normalizer.apply(&self.seen, &mut obs[e * obs_dim..][..observations]);
                if let Some(observed) = &mut lane.observed {
                    observed.push(&self.seen);
                }
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
                if self.stands[e].end.is_none() {
                    let (decoder, state) = (&mut self.decoders[e], &states[e * state_dim..][..state_dim]);
                    decoder.decode(actor.action(e), actor.unsampled(e), state);
                    self.environments[e].announce(&decoder.effort, &decoder.command);
                }
            }
            for e in 0..lanes {
                if self.stands[e].end.is_some() {
                    continue;
                }
                let state = &states[e * state_dim..][..state_dim];
                let (decoder, action) = (&self.decoders[e], actor.action(e));
                let result = self.environments[e].step(&decoder.effort, &decoder.command);
                let row = e * self.stride + step;
                let log_prob = actor.log_prob(e);
                self.batch.reward[row] = result.reward;
                if self.keep != Keep::Rewards {
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
                    failed = Some(self.error(e, step, what, episodes));
                    lanes = e;
                    break;
                }
                if let Some(end) = result.end {
                    let sees = &mut obs[e * obs_dim..][observations..obs_dim];
                    self.end((e, step), end, actor, episodes, sees);
                } else if step + 1 == self.stands[e].share {
                    self.close(e, step, End::Truncated, true);
                }
            }
        }
        failed.map_or(Ok(()), Err)
    }

    fn error(&self, e: usize, step: usize, what: String, episodes: &Episodes) -> RolloutError {
        let (seed, iteration, step) = (episodes.seed, episodes.iteration, step - self.stands[e].began);
        RolloutError { seed, iteration, episode: self.index(e, episodes), step, what }
    }

    /// The episode of a lane has ended with this step of the lane; where steps of its share are left, the next one begins.
    fn end(
        &mut self,
        (e, step): (usize, usize),
        end: End,
        actor: &mut Actor<'_>,
        episodes: &Episodes,
        sees: &mut [f32],
    ) {
        if end == End::Faulted {
            let what = self.environments[e].fault().unwrap_or_else(|| "the physics failed".into());
            let fault = self.error(e, step, what, episodes);
            self.batch.faults.push(fault);
        }
        self.close(e, step, end, false);
        if matches!(self.keep, Keep::Rows(Some(_))) && step + 1 < self.stands[e].share {
            let lane = &mut self.stands[e];
            (lane.began, lane.before, lane.end) = (step + 1, lane.before + 1, None);
            self.start(e, self.index(e, episodes), actor, episodes, sees);
        }
    }

    /// Writes down an episode that is over, unless its physics failed.
    fn close(&mut self, e: usize, step: usize, end: End, spent: bool) {
        let (lane, environment) = (&mut self.stands[e], &self.environments[e]);
        lane.end = Some((end, step + 1 - lane.began));
        let fresh = lane.observed.as_ref().map(|_| Moments::new(self.seen.len()));
        let observed = std::mem::replace(&mut lane.observed, fresh);
        if self.keep == Keep::Rewards || end == End::Faulted {
            return;
        }
        let (obs_dim, observations, row) = (self.policy.obs_dim(), self.seen.len(), e * self.stride + step);
        // What it sees of the design it sees in every row.
        let mut last_obs = self.batch.obs[row * obs_dim..][..obs_dim].to_vec();
        environment.observe(&mut self.seen);
        self.normalizer.apply(&self.seen, &mut last_obs[..observations]);
        environment.state(&mut self.state);
        let mut context = vec![0.0; self.policy.context_dim()];
        environment.context(&mut context);
        let single = |values: &[f64]| values.iter().map(|&x| x as f32).collect();
        let episode = Episode {
            rows: e * self.stride + lane.began..row + 1,
            end,
            cut: spent && self.keep != Keep::Rows(None),
            last_obs,
            last_state: single(&self.state),
            context: single(&context),
            log_prob: self.drawn[e],
            outcome: environment.outcome(),
            terms: environment.terms().to_vec(),
        };
        self.over.push(Over { episode, observed });
    }

    /// What each episode came to, in order.
    pub(super) fn results(&mut self, episodes: &Episodes, discount: f64) -> Vec<Result<EpisodeResult, RolloutError>> {
        let mut faults = std::mem::take(&mut self.batch.faults);
        let result = |(e, environment): (usize, &dyn Environment)| {
            let index = episodes.indices.start + e as u64;
            if let Some(at) = faults.iter().position(|fault| fault.episode == index) {
                return Err(faults.swap_remove(at));
            }
            let (end, steps) = self.stands[e].end.unwrap_or((End::Truncated, self.stride));
            let rewards = &self.batch.reward[e * self.stride..][..steps];
            Ok(EpisodeResult {
                discounted_return: discounted(rewards, discount),
                undiscounted_return: discounted(rewards, 1.0),
                steps,
                end,
                ended_by: if end == End::Terminated { environment.ended_by() } else { None },
                outcome: environment.outcome(),
                terms: environment.terms().to_vec(),
            })
        };
        self.environments.iter().map(AsRef::as_ref).enumerate().map(result).collect()
    }

    /// All rows: closes the gaps that early ends and discarded episodes have left.
    pub(super) fn batch(&mut self) -> Batch {
        let widths = [self.policy.obs_dim(), self.policy.state_dim(), self.policy.action_dim(), 1];
        let mut at = 0;
        let batch = &mut self.batch;
        self.over.sort_by_key(|over| over.episode.rows.start);
        batch.episodes.reserve_exact(self.over.len());
        for Over { mut episode, observed } in self.over.drain(..) {
            let (from, len) = (episode.rows.start, episode.rows.len());
            if from != at {
                let columns = [&mut batch.obs, &mut batch.state, &mut batch.action, &mut batch.log_prob];
                for (column, width) in columns.into_iter().zip(widths) {
                    column.copy_within(from * width..(from + len) * width, at * width);
                }
                batch.reward.copy_within(from..from + len, at);
            }
            episode.rows = at..at + len;
            batch.episodes.push(episode);
            batch.observed.extend(observed);
            at += len;
        }
        for (column, width) in
            [&mut batch.obs, &mut batch.state, &mut batch.action, &mut batch.log_prob].into_iter().zip(widths)
        {
            column.truncate(at * width);
        }
        batch.reward.truncate(at);
        let lanes = if let Keep::Rows(Some(steps)) = self.keep { steps.lanes } else { u64::MAX };
        batch.faults.sort_by_key(|fault| (fault.episode % lanes, fault.episode));
        std::mem::take(batch)
    }
}
