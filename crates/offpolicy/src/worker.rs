//! The passes of one gradient step over a part of its rows.

use std::ops::Range;

use hwasp_algos::BLOCK;
use hwasp_core::Policy;
use hwasp_diff::MlpTape;

use crate::critic::Critics;
use crate::sample::{Sample, View};
use crate::scaling::Scaling;

/// What all parts of a gradient step read.
pub(crate) struct Step<'a, P: Policy> {
    pub(crate) policy: &'a P,
    /// The policy's parameters, and those of its target.
    pub(crate) params: &'a [f32],
    pub(crate) target: &'a [f32],
    pub(crate) critics: &'a Critics,
    pub(crate) sample: &'a Sample,
    pub(crate) scaling: &'a Scaling,
    pub(crate) view: View,
    /// Limits of each component of the action.
    pub(crate) limits: &'a [Option<(f32, f32)>],
    /// Rows of the whole step.
    pub(crate) rows: usize,
    /// Spread and largest size of the noise of target actions, per component.
    pub(crate) smoothing: &'a [(f32, f32)],
}

/// Working memory of one part.
pub(crate) struct Worker<P: Policy> {
    /// Its rows of the step.
    rows: Range<usize>,
    /// Of the target policy, and of the policy.
    target: P::Tape,
    live: P::Tape,
    target_critics: [MlpTape<f32>; 2],
    pub(crate) critics: [MlpTape<f32>; 2],
    /// What critics see of a block, row by row.
    inputs: Vec<f32>,
    /// Actions of a block and their cotangents, column by column.
    actions: Vec<f32>,
    cotangents: Vec<f32>,
    /// What the values of a block should be.
    wanted: Vec<f32>,
    /// Cotangents of the values of a block.
    value_cotangent: Vec<f32>,
    /// Σ squared error of the first critic.
    pub(crate) squares: f64,
    /// Σ value of the policy's actions.
    pub(crate) values: f64,
}

impl<P: Policy> Worker<P> {
    /// For these rows.
    pub(crate) fn new(rows: Range<usize>, policy: &P, critics: &Critics, view: View) -> Self {
        let network = &critics.network;
        let actions = vec![0.0; policy.action_dim() * BLOCK];
        Self {
            rows,
            target: policy.tape(BLOCK),
            live: policy.tape(BLOCK),
            target_critics: [network.tape(BLOCK), network.tape(BLOCK)],
            critics: [network.tape_with_inputs(BLOCK), network.tape(BLOCK)],
            inputs: vec![0.0; view.width() * BLOCK],
            cotangents: actions.clone(),
            actions,
            wanted: vec![0.0; BLOCK],
            value_cotangent: vec![0.0; BLOCK],
            squares: 0.0,
            values: 0.0,
        }
    }

    /// The gradient of both critics' mean squared errors, left on their tapes:
    /// y = r + γ·min over critics of Q'(s', π'(s') + clipped noise) (Fujimoto et al. 2018, eqs. 10 and 14).
    pub(crate) fn judge(&mut self, step: &Step<'_, P>) {
        let network = &step.critics.network;
        step.policy.bind(step.target, &mut self.target);
        for (i, critic) in step.critics.each.iter().enumerate() {
            network.bind(&critic.target, &mut self.target_critics[i]);
            network.bind(&critic.params, &mut self.critics[i]);
        }
        self.squares = 0.0;
        for block in Sample::blocks(self.rows.clone()) {
            let rows = block.len();
            self.want(step, &block);
            let inputs = &mut self.inputs[..rows * step.view.width()];
            step.view.fill(step.sample, &step.sample.now, &block, step.scaling, inputs);
            step.view.fill_actions(rows, step.sample.actions(&block), step.scaling, inputs);
            for (i, tape) in self.critics.iter_mut().enumerate() {
                network.forward(inputs, rows, tape);
                let (values, stride) = tape.output();
                for (r, c) in self.value_cotangent[..rows].iter_mut().enumerate() {
                    let error = values[r * stride] - self.wanted[r];
                    *c = error * (2.0 / step.rows as f32);
                    if i == 0 {
                        self.squares += f64::from(error) * f64::from(error);
                    }
                }
                network.vjp(inputs, &self.value_cotangent[..rows], tape);
            }
        }
    }

    /// What the values of a block should be.
    fn want(&mut self, step: &Step<'_, P>, block: &Range<usize>) {
        let (rows, sample) = (block.len(), step.sample);
        let mean = step.policy.forward(&sample.rows(&sample.next, block), &mut self.target);
        for (a, &(spread, most)) in step.smoothing.iter().enumerate() {
            let noise = &sample.noise[a * step.rows + block.start..][..rows];
            let actions = self.actions[a * BLOCK..][..rows].iter_mut().zip(&mean[a * BLOCK..]);
            for ((action, &mean), &z) in actions.zip(noise) {
                let noisy = mean + (spread * z).clamp(-most, most);
                *action = step.limits[a].map_or(noisy, |(lo, hi)| noisy.clamp(lo, hi));
            }
        }
        let inputs = &mut self.inputs[..rows * step.view.width()];
        step.view.fill(sample, &sample.next, block, step.scaling, inputs);
        step.view.fill_actions(rows, (&self.actions, BLOCK), step.scaling, inputs);
        for (i, tape) in self.target_critics.iter_mut().enumerate() {
            step.critics.network.forward(inputs, rows, tape);
            let (values, stride) = tape.output();
            for (r, wanted) in self.wanted[..rows].iter_mut().enumerate() {
                let value = values[r * stride];
                *wanted = if i == 0 { value } else { wanted.min(value) };
            }
        }
        let outcomes = sample.reward[block.clone()].iter().zip(&sample.discount[block.clone()]);
        for (wanted, (reward, discount)) in self.wanted.iter_mut().zip(outcomes) {
            *wanted = reward + discount * *wanted;
        }
    }

    /// The gradient of -mean Q(s, π(s)) by the policy's parameters, left on its tape: through the first critic, the law and the
    /// controller (deterministic policy gradient; Silver et al. 2014, eq. 9).
    pub(crate) fn improve(&mut self, step: &Step<'_, P>) {
        let (network, sample) = (&step.critics.network, step.sample);
        step.policy.bind(step.params, &mut self.live);
        network.bind(&step.critics.each[0].params, &mut self.critics[0]);
        self.values = 0.0;
        let (at, width) = (step.view.action_at(), step.view.width());
        for block in Sample::blocks(self.rows.clone()) {
            let rows = block.len();
            let moments = sample.rows(&sample.now, &block);
            let mean = step.policy.forward(&moments, &mut self.live);
            for (a, limits) in step.limits.iter().enumerate() {
                for (action, &mean) in self.actions[a * BLOCK..][..rows].iter_mut().zip(&mean[a * BLOCK..]) {
                    *action = limits.map_or(mean, |(lo, hi)| mean.clamp(lo, hi));
                }
            }
            let inputs = &mut self.inputs[..rows * width];
            step.view.fill(sample, &sample.now, &block, step.scaling, inputs);
            step.view.fill_actions(rows, (&self.actions, BLOCK), step.scaling, inputs);
            let tape = &mut self.critics[0];
            network.forward(inputs, rows, tape);
            let (values, stride) = tape.output();
            self.values += values.iter().step_by(stride).map(|&value| f64::from(value)).sum::<f64>();
            self.value_cotangent[..rows].fill(-1.0 / step.rows as f32);
            network.vjp_inputs(inputs, &self.value_cotangent[..rows], tape);
            let (pulled, stride) = tape.input_cotangent();
            for (a, affine) in step.scaling.action.iter().enumerate() {
                for (r, c) in self.cotangents[a * BLOCK..][..rows].iter_mut().enumerate() {
                    let pulled = pulled[r * stride + at + a] / affine.scale;
                    // Beyond a limit nothing changes on the way out; the way back is open.
                    let mean = mean[a * BLOCK + r];
                    let stuck = step.limits[a]
                        .is_some_and(|(lo, hi)| (mean > hi && pulled < 0.0) || (mean < lo && pulled > 0.0));
                    *c = if stuck { 0.0 } else { pulled };
                }
            }
            step.policy.vjp(&moments, &self.cotangents, &mut self.live);
        }
    }

    /// Adds what another part has left on its tapes.
    pub(crate) fn add_policy(&mut self, policy: &P, other: &Self) {
        policy.add_cotangents(&mut self.live, &other.live);
    }

    /// The policy's gradient over all that was added.
    pub(crate) fn policy_gradient(&mut self, policy: &P, gradient: &mut [f32]) {
        policy.gradient(&mut self.live, gradient);
    }
}

#[cfg(test)]
mod tests;
