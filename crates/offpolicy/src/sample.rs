//! Rows drawn from the replay for one gradient step, and what critics see of them.

use std::ops::Range;

use hwasp_algos::BLOCK;
use hwasp_core::{Policy, Rows, Stream};
use rand::RngExt;
use rand_distr::{Distribution, StandardNormal};

use crate::replay::{Dims, Replay};
use crate::scaling::Scaling;

/// The moments of one side of the steps: where they began, or where they led to.
#[derive(Clone, Debug, Default)]
pub(crate) struct Moments {
    /// Controller inputs `[B × obs]`, row by row.
    obs: Vec<f32>,
    /// The law's state `[state × B]`, column by column.
    state: Vec<f32>,
    /// What the episodes are about `[B × context]`, row by row.
    context: Vec<f32>,
    /// The actions of the steps `[action × B]`, column by column: on both sides, since what was drawn for an episode is held.
    action: Vec<f32>,
}

/// So many steps out of a replay.
#[derive(Clone, Debug)]
pub(crate) struct Sample {
    dims: Dims,
    count: usize,
    pub(crate) now: Moments,
    pub(crate) next: Moments,
    /// Rewards up to the next moment, as critics measure them.
    pub(crate) reward: Vec<f32>,
    /// What the value of the next moment is worth.
    pub(crate) discount: Vec<f32>,
    /// Standard normal numbers `[· × B]`, column by column, for the policy's actions at the moments.
    pub(crate) now_noise: Vec<f32>,
    /// The same for the actions at the next moments, and behind them those that are added to them.
    pub(crate) next_noise: Vec<f32>,
}

impl Moments {
    fn new(dims: Dims, count: usize) -> Self {
        Self {
            obs: vec![0.0; count * dims.obs],
            state: vec![0.0; count * dims.state],
            context: vec![0.0; count * dims.context],
            action: vec![0.0; count * dims.action],
        }
    }

    /// Writes a design, of which the controller sees so much, into its inputs, but for those that are held.
    fn show_design(&mut self, dims: Dims, seen: &[f32], held: &[usize]) {
        if dims.design == 0 {
            return;
        }
        for inputs in self.obs.chunks_exact_mut(dims.obs) {
            for (i, (input, &now)) in inputs[dims.obs - dims.design..].iter_mut().zip(seen).enumerate() {
                if !held.contains(&i) {
                    *input = now;
                }
            }
        }
    }

    /// Writes row `r` of `count`: the moment of a frame, and the action of another one.
    fn take(&mut self, (r, count): (usize, usize), replay: &Replay, frame: usize, action: &[f32]) {
        let put_row = |to: &mut [f32], from: &[f32]| to[r * from.len()..][..from.len()].copy_from_slice(from);
        put_row(&mut self.obs, replay.obs(frame));
        put_row(&mut self.context, replay.context(frame));
        for (column, &x) in replay.state(frame).iter().enumerate() {
            self.state[column * count + r] = x;
        }
        for (column, &x) in action.iter().enumerate() {
            self.action[column * count + r] = x;
        }
    }
}

impl Sample {
    /// Room for so many rows, whose actions take `drawn` numbers; `added` more are added to the next ones.
    pub(crate) fn new(dims: Dims, count: usize, drawn: usize, added: usize) -> Self {
        Self {
            dims,
            count,
            now: Moments::new(dims, count),
            next: Moments::new(dims, count),
            reward: vec![0.0; count],
            discount: vec![0.0; count],
            now_noise: vec![0.0; count * drawn],
            next_noise: vec![0.0; count * (drawn + added)],
        }
    }

    /// Draws the rows, and the noise of the actions.
    pub(crate) fn draw(&mut self, replay: &Replay, ahead: (usize, f64), values: (f64, f64), chance: &mut Stream) {
        for r in 0..self.count {
            self.take(r, replay, replay.draw(chance), ahead, values);
        }
        self.next_noise.fill_with(|| StandardNormal.sample(chance));
        self.now_noise.fill_with(|| StandardNormal.sample(chance));
    }

    /// Draws moments at which episodes began, for the mean of the policy's actions there; whether there are such.
    pub(crate) fn draw_starts(&mut self, replay: &Replay, chance: &mut Stream) -> bool {
        let starts = replay.starts();
        if starts.is_empty() {
            return false;
        }
        for r in 0..self.count {
            let at = starts[chance.random_range(0..starts.len())];
            self.now.take((r, self.count), replay, at, replay.action(at));
        }
        self.now_noise.fill(0.0);
        true
    }

    /// Shows the controller the design of now, whatever it was when a step was taken: with these parameters at the moments, and
    /// with those of the policy that acts next at the next ones. What was drawn for an episode is held.
    pub(crate) fn show_design<P: Policy>(&mut self, policy: &P, params: &[f32], next_params: &[f32]) {
        for (moments, params) in [(&mut self.now, params), (&mut self.next, next_params)] {
            moments.show_design(self.dims, &policy.seen_design(params), policy.seen_draws());
        }
    }

    /// Shows it this design at the moments, in the place of what was drawn, too.
    pub(crate) fn show_candidate<P: Policy>(&mut self, policy: &P, params: &[f32]) {
        self.now.show_design(self.dims, &policy.seen_design(params), &[]);
    }

    /// Row `r` is this step: it counts `n_step` rewards, and values are measured by their centre and scale.
    pub(crate) fn take(
        &mut self,
        r: usize,
        replay: &Replay,
        at: usize,
        (n_step, discount): (usize, f64),
        (center, scale): (f64, f64),
    ) {
        let ahead = replay.ahead(at, n_step, discount);
        let action = replay.action(at);
        self.now.take((r, self.count), replay, at, action);
        self.next.take((r, self.count), replay, ahead.frame, action);
        // y = reward + discount·(center + scale·q'), and critics say (y - center)/scale.
        self.reward[r] = ((ahead.reward - (1.0 - ahead.discount) * center) / scale) as f32;
        self.discount[r] = ahead.discount as f32;
    }

    /// Blocks of a part of the rows, in order.
    pub(crate) fn blocks(rows: Range<usize>) -> impl Iterator<Item = Range<usize>> {
        let end = rows.end;
        rows.step_by(BLOCK).map(move |at| at..(at + BLOCK).min(end))
    }

    /// A block of moments as a policy takes it.
    pub(crate) fn rows<'a>(&self, moments: &'a Moments, block: &Range<usize>) -> Rows<'a> {
        let width = self.dims.obs;
        Rows {
            count: block.len(),
            obs: &moments.obs[block.start * width..block.end * width],
            state: moments.state.get(block.start..).unwrap_or(&[]),
            action: moments.action.get(block.start..).unwrap_or(&[]),
            stride: self.count,
        }
    }

    /// The actions that were taken in a block, and the distance between their columns.
    pub(crate) fn actions(&self, block: &Range<usize>) -> (&[f32], usize) {
        (&self.now.action[block.start..], self.count)
    }
}

/// What a critic sees, in this order: the observation as the controller sees it, the law's state and the episode's context where it is shown them,
/// the action. Of the design it sees what is in the action, and nothing twice: its slope by the design has to be all that the design
/// is worth.
#[derive(Clone, Copy, Debug)]
pub(crate) struct View {
    dims: Dims,
    state: bool,
    context: bool,
}

impl View {
    pub(crate) fn new(dims: Dims, state: bool, context: bool) -> Self {
        Self { dims, state: state && dims.state > 0, context: context && dims.context > 0 }
    }

    /// The controller's inputs but for the design.
    fn observed(&self) -> usize {
        self.dims.obs - self.dims.design
    }

    /// Where the action begins.
    pub(crate) fn action_at(&self) -> usize {
        let more = |shown: bool, count: usize| if shown { count } else { 0 };
        self.observed() + more(self.state, self.dims.state) + more(self.context, self.dims.context)
    }

    pub(crate) fn width(&self) -> usize {
        self.action_at() + self.dims.action
    }

    /// Writes the inputs of a block `[rows × width]` but for the actions.
    pub(crate) fn fill(
        &self,
        sample: &Sample,
        moments: &Moments,
        block: &Range<usize>,
        scaling: &Scaling,
        to: &mut [f32],
    ) {
        let Dims { obs, context, .. } = self.dims;
        for (r, to) in block.clone().zip(to.chunks_exact_mut(self.width())) {
            let mut at = self.observed();
            to[..at].copy_from_slice(&moments.obs[r * obs..][..at]);
            if self.state {
                for (s, affine) in scaling.state.iter().enumerate() {
                    to[at + s] = affine.apply(moments.state[s * sample.count + r]);
                }
                at += self.dims.state;
            }
            if self.context {
                for (c, affine) in scaling.context.iter().enumerate() {
                    to[at + c] = affine.apply(moments.context[r * context + c]);
                }
            }
        }
    }

    /// Writes the actions of so many rows, which lie column by column, into the inputs.
    pub(crate) fn fill_actions(
        &self,
        rows: usize,
        (actions, stride): (&[f32], usize),
        scaling: &Scaling,
        to: &mut [f32],
    ) {
        let (at, width) = (self.action_at(), self.width());
        for (a, affine) in scaling.action.iter().enumerate() {
            for (r, &x) in actions[a * stride..][..rows].iter().enumerate() {
                to[r * width + at + a] = affine.apply(x);
            }
        }
    }
}
