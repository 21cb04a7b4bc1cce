//! The replay: what the world answered, kept whatever policy and design asked.

use hwasp_algos::{Exchange, Persist, StateError};
use hwasp_core::{Batch, End, Policy, Stream};
use rand::RngExt;

/// How many numbers each moment has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Dims {
    /// Of the controller's input.
    pub(crate) obs: usize,
    /// How many of them, the last, show it the design.
    pub(crate) design: usize,
    /// Of the law's state.
    pub(crate) state: usize,
    /// Of what an episode is about.
    pub(crate) context: usize,
    /// Of the action.
    pub(crate) action: usize,
}

impl Dims {
    /// What the batches of a policy have.
    pub(crate) fn of(policy: &impl Policy) -> Self {
        Self {
            obs: policy.obs_dim(),
            design: policy.seen_design(&vec![0.0; policy.param_count()]).len(),
            state: policy.state_dim(),
            context: policy.context_dim(),
            action: policy.action_dim(),
        }
    }
}

/// What a frame is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Mark {
    /// A step: what follows it is the next frame.
    Step,
    /// The moment after a last step: the episode was cut, and would have gone on.
    Cut,
    /// The same of an episode that is over for good.
    Over,
    /// The same of an episode that the batch had no more room for.
    Left,
}

/// Steps of whole episodes in a ring of frames. A frame is a moment: what was seen, done and earned. What follows a step is the
/// next frame, so that each moment is kept once; an episode ends with a frame for the moment after its last step.
///
/// It always ends with such a frame. The oldest frames give way, one by one, once `capacity` of them are held.
#[derive(Clone, Debug)]
pub(crate) struct Replay {
    dims: Dims,
    capacity: usize,
    /// Where the next frame goes.
    head: usize,
    /// Steps among the frames.
    steps: usize,
    obs: Vec<f32>,
    state: Vec<f32>,
    context: Vec<f32>,
    action: Vec<f32>,
    reward: Vec<f32>,
    mark: Vec<Mark>,
}

/// What a [push](Replay::push) has overwritten, to take it back.
pub(crate) struct Overwritten {
    head: usize,
    /// Frames that were held before.
    held: usize,
    /// Those that were written over, which followed each other from this place on.
    first: usize,
    frames: Replay,
}

/// Where n steps from a moment on lead to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Ahead {
    /// The frame there.
    pub(crate) frame: usize,
    /// Σ γ^k·reward on the way.
    pub(crate) reward: f64,
    /// What its value is worth now: γ^steps, and 0 where the episode is over.
    pub(crate) discount: f64,
}

/// One frame, in the order of the arrays.
#[derive(Clone, Copy)]
struct Frame<'a> {
    obs: &'a [f32],
    state: &'a [f32],
    context: &'a [f32],
    action: &'a [f32],
    reward: f32,
    mark: Mark,
}

impl Replay {
    /// An empty one for so many frames.
    pub(crate) fn new(dims: Dims, capacity: usize) -> Self {
        Self {
            dims,
            capacity,
            head: 0,
            steps: 0,
            obs: Vec::new(),
            state: Vec::new(),
            context: Vec::new(),
            action: Vec::new(),
            reward: Vec::new(),
            mark: Vec::new(),
        }
    }

    /// Steps that can be learned from.
    pub(crate) fn steps(&self) -> usize {
        self.steps
    }

    fn frames(&self) -> usize {
        self.mark.len()
    }

    fn frame(&self, i: usize) -> Frame<'_> {
        Frame {
            obs: self.obs(i),
            state: self.state(i),
            context: self.context(i),
            action: self.action(i),
            reward: self.reward[i],
            mark: self.mark[i],
        }
    }

    pub(crate) fn obs(&self, i: usize) -> &[f32] {
        &self.obs[i * self.dims.obs..][..self.dims.obs]
    }

    pub(crate) fn state(&self, i: usize) -> &[f32] {
        &self.state[i * self.dims.state..][..self.dims.state]
    }

    pub(crate) fn context(&self, i: usize) -> &[f32] {
        &self.context[i * self.dims.context..][..self.dims.context]
    }

    pub(crate) fn action(&self, i: usize) -> &[f32] {
        &self.action[i * self.dims.action..][..self.dims.action]
    }

    /// Writes a frame over the oldest one, or behind the last while there is room.
    fn write(&mut self, frame: &Frame<'_>) {
        let at = self.head;
        if at == self.frames() {
            self.obs.extend_from_slice(frame.obs);
            self.state.extend_from_slice(frame.state);
            self.context.extend_from_slice(frame.context);
            self.action.extend_from_slice(frame.action);
            self.reward.push(frame.reward);
            self.mark.push(frame.mark);
        } else {
            self.steps -= usize::from(self.mark[at] == Mark::Step);
            self.obs[at * self.dims.obs..][..self.dims.obs].copy_from_slice(frame.obs);
            self.state[at * self.dims.state..][..self.dims.state].copy_from_slice(frame.state);
            self.context[at * self.dims.context..][..self.dims.context].copy_from_slice(frame.context);
            self.action[at * self.dims.action..][..self.dims.action].copy_from_slice(frame.action);
            self.reward[at] = frame.reward;
            self.mark[at] = frame.mark;
        }
        self.steps += usize::from(frame.mark == Mark::Step);
        self.head = (at + 1) % self.capacity;
    }

    /// Takes in the episodes of a batch, with actions within `limits`: what lies beyond them the world never saw.
    pub(crate) fn push(&mut self, batch: &Batch, limits: &[Option<(f32, f32)>]) -> Overwritten {
        let undo = self.remember(batch.rows() + batch.episodes.len());
        let Dims { obs, state, action, .. } = self.dims;
        let (mut done, nothing) = (vec![0.0; action], vec![0.0; action]);
        for episode in &batch.episodes {
            let context = &episode.context[..];
            for row in episode.rows.clone() {
                done.copy_from_slice(&batch.action[row * action..][..action]);
                for (done, limits) in done.iter_mut().zip(limits) {
                    if let Some((lo, hi)) = *limits {
                        *done = done.clamp(lo, hi);
                    }
                }
                self.write(&Frame {
                    obs: &batch.obs[row * obs..][..obs],
                    state: &batch.state[row * state..][..state],
                    context,
                    action: &done,
                    reward: batch.reward[row] as f32,
                    mark: Mark::Step,
                });
            }
            self.write(&Frame {
                obs: &episode.last_obs,
                state: &episode.last_state,
                context,
                action: &nothing,
                reward: 0.0,
                mark: match episode.end {
                    End::Terminated => Mark::Over,
                    _ if episode.cut => Mark::Left,
                    _ => Mark::Cut,
                },
            });
        }
        undo
    }

    /// What so many frames more will write over.
    fn remember(&self, count: usize) -> Overwritten {
        let held = self.frames();
        let (room, head) = (self.capacity - held, self.head);
        let first = if room == 0 { head } else { 0 };
        let mut frames = Self::new(self.dims, self.capacity);
        for k in 0..count.saturating_sub(room).min(held) {
            frames.write(&self.frame((first + k) % self.capacity));
        }
        Overwritten { head, held, first, frames }
    }

    /// As it was before that push.
    pub(crate) fn take_back(&mut self, undo: &Overwritten) {
        self.head = undo.first;
        for k in 0..undo.frames.frames() {
            self.write(&undo.frames.frame(k));
        }
        let frames = undo.held;
        self.steps -= self.mark[frames..].iter().filter(|&&mark| mark == Mark::Step).count();
        let Dims { obs, state, context, action, .. } = self.dims;
        self.obs.truncate(frames * obs);
        self.state.truncate(frames * state);
        self.context.truncate(frames * context);
        self.action.truncate(frames * action);
        self.reward.truncate(frames);
        self.mark.truncate(frames);
        self.head = undo.head;
    }

    /// All is forgotten.
    pub(crate) fn empty(&mut self) {
        *self = Self::new(self.dims, self.capacity);
    }

    /// A step, each as likely as any other.
    ///
    /// # Panics
    /// If there is none.
    pub(crate) fn draw(&self, chance: &mut Stream) -> usize {
        assert!(self.steps > 0, "nothing to draw from");
        loop {
            let i = chance.random_range(0..self.frames());
            if self.mark[i] == Mark::Step {
                return i;
            }
        }
    }

    /// The frames that episodes began with.
    pub(crate) fn starts(&self) -> Vec<usize> {
        let count = self.frames();
        let begins = |&i: &usize| {
            let before = (i + count - 1) % count;
            // Behind the newest frame comes the oldest, which may be in the midst of its episode.
            self.mark[before] != Mark::Step && (i != self.head % count || count < self.capacity)
        };
        self.step_frames().filter(begins).collect()
    }

    /// All frames, the newest first.
    fn newest_first(&self) -> impl Iterator<Item = usize> + '_ {
        let count = self.frames();
        (0..count).map(move |k| (self.head + 2 * count - 1 - k) % count)
    }

    /// The latest episodes that were not left halfway, the newest first, and at most so many: the frames that they began with, and
    /// what they earned in all.
    pub(crate) fn latest(&self, most: usize) -> Vec<(usize, f64)> {
        let mut episodes = Vec::new();
        let (mut whole, mut first, mut earned) = (false, 0, 0.0);
        for at in self.newest_first() {
            if self.mark[at] == Mark::Step {
                (first, earned) = (at, earned + f64::from(self.reward[at]));
                continue;
            }
            if whole {
                episodes.push((first, earned));
            }
            if episodes.len() == most {
                return episodes;
            }
            (whole, earned) = (self.mark[at] != Mark::Left, 0.0);
        }
        // The oldest of a full ring may have lost its beginning.
        if whole && self.frames() < self.capacity {
            episodes.push((first, earned));
        }
        episodes
    }

    /// Where `n` steps from step `i` on lead to, or as many as its episode has left.
    pub(crate) fn ahead(&self, i: usize, n: usize, discount: f64) -> Ahead {
        let (mut at, mut reward, mut factor) = (i, 0.0, 1.0);
        for _ in 0..n {
            reward += factor * f64::from(self.reward[at]);
            factor *= discount;
            at = (at + 1) % self.capacity;
            if self.mark[at] != Mark::Step {
                break;
            }
        }
        Ahead { frame: at, reward, discount: if self.mark[at] == Mark::Over { 0.0 } else { factor } }
    }

    /// Of each step held, from the newest on: what its episode still earned in the replay, discounted, and what the value of the
    /// moment after it is worth, 0 where it was over for good.
    pub(crate) fn returns(&self, discount: f64) -> Vec<(f64, f64)> {
        let (mut earned, mut rest) = (0.0, 0.0);
        let back = self.newest_first().filter_map(|at| {
            match self.mark[at] {
                Mark::Step => {
                    earned = f64::from(self.reward[at]) + discount * earned;
                    rest *= discount;
                    return Some((earned, rest));
                }
                Mark::Cut | Mark::Left => rest = 1.0,
                Mark::Over => rest = 0.0,
            }
            earned = 0.0;
            None
        });
        back.collect()
    }

    /// The frames that are steps.
    pub(crate) fn step_frames(&self) -> impl Iterator<Item = usize> + Clone + '_ {
        (0..self.frames()).filter(|&i| self.mark[i] == Mark::Step)
    }
}

impl Persist for Replay {
    fn exchange(&mut self, with: &mut Exchange<'_>) -> Result<(), StateError> {
        let Dims { obs, state, context, action, .. } = self.dims;
        with.series("reward", &mut self.reward)?;
        let frames = self.reward.len();
        if frames > self.capacity {
            return Err(with.refuse("reward", frames as f64, "at most what the replay holds"));
        }
        for (name, width, values) in [
            ("obs", obs, &mut self.obs),
            ("state", state, &mut self.state),
            ("context", context, &mut self.context),
            ("action", action, &mut self.action),
        ] {
            values.resize(frames * width, 0.0);
            with.vector(name, values)?;
        }
        let mut marks: Vec<u64> = self.mark.iter().map(|&mark| mark as u64).collect();
        marks.resize(frames, 0);
        with.vector("mark", &mut marks)?;
        self.mark.clear();
        for mark in marks {
            self.mark.push(match mark {
                0 => Mark::Step,
                1 => Mark::Cut,
                2 => Mark::Over,
                3 => Mark::Left,
                other => return Err(with.refuse("mark", other as f64, "0 to 3")),
            });
        }
        self.steps = self.mark.iter().filter(|&&mark| mark == Mark::Step).count();
        let mut head = self.head as u64;
        with.number("head", &mut head)?;
        self.head = head as usize;
        let room = if frames < self.capacity { self.head == frames } else { self.head < self.capacity };
        let ends = frames == 0 || self.mark[(self.head + frames - 1) % frames] != Mark::Step;
        if room && ends { Ok(()) } else { Err(with.refuse("head", head as f64, "behind the end of an episode")) }
    }
}

#[cfg(test)]
mod tests;
