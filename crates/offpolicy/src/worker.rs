//! The passes of one gradient step over a part of its rows.

use std::ops::Range;

use hwasp_algos::BLOCK;
use hwasp_core::Policy;
use hwasp_diff::MlpTape;

use crate::critic::Critics;
use crate::rule::Rule;
use crate::sample::{Sample, View};
use crate::scaling::Scaling;

/// What all parts of a gradient step read.
pub(crate) struct Step<'a, P: Policy, R: Rule<P>> {
    pub(crate) rule: &'a R,
    pub(crate) policy: &'a P,
    /// The policy's parameters, and those of its slow copy.
    pub(crate) params: &'a [f32],
    pub(crate) slow: &'a [f32],
    pub(crate) critics: &'a Critics,
    /// How often the critics' parameters have changed.
    pub(crate) version: u64,
    pub(crate) sample: &'a Sample,
    pub(crate) scaling: &'a Scaling,
    pub(crate) view: View,
    /// Limits of each component of the action.
    pub(crate) limits: &'a [Option<(f32, f32)>],
    /// Rows of the whole step.
    pub(crate) rows: usize,
    /// Spread and largest size of what is added to the next actions, per component, where something is.
    pub(crate) smoothing: &'a [(f32, f32)],
}

impl<P: Policy, R: Rule<P>> Step<'_, P, R> {
    /// What was drawn for the episodes of a block takes its place among the actions again.
    fn hold(&self, actions: &mut [f32], block: &Range<usize>) {
        let (held, stride) = self.sample.actions(block);
        for a in 0..self.policy.drawn_actions() {
            actions[a * BLOCK..][..block.len()].copy_from_slice(&held[a * stride..][..block.len()]);
        }
    }

    /// Brings actions within their limits, as the world does.
    fn limit(&self, actions: &mut [f32], rows: usize) {
        for (column, limits) in actions.chunks_exact_mut(BLOCK).zip(self.limits) {
            if let Some((lo, hi)) = *limits {
                for action in &mut column[..rows] {
                    *action = action.clamp(lo, hi);
                }
            }
        }
    }
}

/// Takes over what critic `i` says where it says less than those before it.
fn take_least(i: usize, tape: &MlpTape<f32>, least: &mut [f32], judge: &mut [usize]) {
    let (values, stride) = tape.output();
    for (r, (least, judge)) in least.iter_mut().zip(judge).enumerate() {
        let value = values[r * stride];
        if i == 0 || value < *least {
            (*least, *judge) = (value, i);
        }
    }
}

/// Working memory of one part.
pub(crate) struct Worker<P: Policy> {
    /// Its rows of the step.
    rows: Range<usize>,
    /// Of the policy, and of its slow copy where there is one.
    live: P::Tape,
    slow: Option<P::Tape>,
    target_critics: [MlpTape<f32>; 2],
    pub(crate) critics: [MlpTape<f32>; 2],
    /// The version of the parameters that each is bound to.
    bound: [Option<u64>; 2],
    /// What critics see of a block, row by row.
    inputs: Vec<f32>,
    /// Actions of a block as the policy wants them, within their limits, and their cotangents, column by column.
    wanted: Vec<f32>,
    actions: Vec<f32>,
    cotangents: Vec<f32>,
    /// The least of the critics' values of a block, and what they should be.
    least: Vec<f32>,
    /// Which critic says the least.
    judge: Vec<usize>,
    /// Cotangents of the values of a block.
    value_cotangent: Vec<f32>,
    /// Σ squared error of the first critic.
    pub(crate) squares: f64,
    /// Σ value of the policy's actions.
    pub(crate) values: f64,
    /// Σ of their log-probabilities.
    pub(crate) log_probs: f64,
}

impl<P: Policy> Worker<P> {
    /// For these rows.
    pub(crate) fn new<R: Rule<P>>(rows: Range<usize>, policy: &P, critics: &Critics, view: View) -> Self {
        let network = &critics.network;
        let actions = vec![0.0; policy.action_dim() * BLOCK];
        Self {
            rows,
            live: policy.tape(BLOCK),
            slow: R::SLOW_POLICY.then(|| policy.tape(BLOCK)),
            target_critics: [0, 1].map(|_| network.tape_forward(BLOCK)),
            critics: [0, 1].map(|i| if i < R::JUDGES { network.tape_with_inputs(BLOCK) } else { network.tape(BLOCK) }),
            bound: [None; 2],
            inputs: vec![0.0; view.width() * BLOCK],
            wanted: actions.clone(),
            cotangents: actions.clone(),
            actions,
            least: vec![0.0; BLOCK],
            judge: vec![0; BLOCK],
            value_cotangent: vec![0.0; BLOCK],
            squares: 0.0,
            values: 0.0,
            log_probs: 0.0,
        }
    }

    /// The gradient of both critics' mean squared errors, left on their tapes:
    /// y = r + γ·(min over critics of Q'(s', a') - α·log π(a'|s')), where a' is the policy's (Fujimoto et al. 2018, eqs. 10 and 14;
    /// Haarnoja et al. 2018, eqs. 5 and 6).
    pub(crate) fn judge<R: Rule<P>>(&mut self, step: &Step<'_, P, R>) {
        let network = &step.critics.network;
        match &mut self.slow {
            Some(slow) => step.policy.bind(step.slow, slow),
            None => step.policy.bind(step.params, &mut self.live),
        }
        for (i, critic) in step.critics.each.iter().enumerate() {
            network.bind(&critic.target, &mut self.target_critics[i]);
            self.bind_critic(step, i);
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
                    let error = values[r * stride] - self.least[r];
                    *c = error * (2.0 / step.rows as f32);
                    if i == 0 {
                        self.squares += f64::from(error) * f64::from(error);
                    }
                }
                network.vjp(inputs, &self.value_cotangent[..rows], tape);
            }
        }
    }

    /// The critics at hand are others now, whatever their version.
    pub(crate) fn forget(&mut self) {
        self.bound = [None; 2];
    }

    /// Takes over a critic's parameters, unless they are those that it has, and clears its sums.
    fn bind_critic<R: Rule<P>>(&mut self, step: &Step<'_, P, R>, i: usize) {
        let (network, tape) = (&step.critics.network, &mut self.critics[i]);
        if self.bound[i].replace(step.version) == Some(step.version) {
            network.clear(tape);
        } else {
            network.bind(&step.critics.each[i].params, tape);
        }
    }

    /// What the values of a block should be, left in `least`.
    fn want<R: Rule<P>>(&mut self, step: &Step<'_, P, R>, block: &Range<usize>) {
        let (rows, sample) = (block.len(), step.sample);
        let tape = self.slow.as_mut().unwrap_or(&mut self.live);
        let noise = sample.next_noise.get(block.start..).unwrap_or(&[]);
        let (actions, log_prob) = R::act(step.policy, &sample.rows(&sample.next, block), noise, tape);
        self.actions.copy_from_slice(actions);
        let added = noise.get(R::drawn(step.policy) * step.rows..).unwrap_or(&[]);
        for (a, &(spread, most)) in step.smoothing.iter().enumerate() {
            for (action, &z) in self.actions[a * BLOCK..][..rows].iter_mut().zip(&added[a * step.rows..]) {
                *action += (spread * z).clamp(-most, most);
            }
        }
        step.limit(&mut self.actions, rows);
        step.hold(&mut self.actions, block);
        let inputs = &mut self.inputs[..rows * step.view.width()];
        step.view.fill(sample, &sample.next, block, step.scaling, inputs);
        step.view.fill_actions(rows, (&self.actions, BLOCK), step.scaling, inputs);
        for (i, tape) in self.target_critics.iter_mut().enumerate() {
            step.critics.network.forward(inputs, rows, tape);
            take_least(i, tape, &mut self.least[..rows], &mut self.judge);
        }
        if let Some(log_prob) = log_prob {
            let temperature = step.rule.temperature();
            for (least, log_prob) in self.least[..rows].iter_mut().zip(log_prob) {
                *least -= temperature * log_prob;
            }
        }
        let outcomes = sample.reward[block.clone()].iter().zip(&sample.discount[block.clone()]);
        for (wanted, (reward, discount)) in self.least.iter_mut().zip(outcomes) {
            *wanted = reward + discount * *wanted;
        }
    }

    /// What the critics say of the policy's actions at the moments of all its rows, with the design of now in each.
    pub(crate) fn value<R: Rule<P>>(&mut self, step: &Step<'_, P, R>) {
        step.policy.bind(step.params, &mut self.live);
        for i in 0..R::JUDGES {
            self.bind_critic(step, i);
        }
        (self.values, self.log_probs) = (0.0, 0.0);
        for block in Sample::blocks(self.rows.clone()) {
            self.appraise(step, &block, false);
        }
    }

    /// The same for one block, whose drawn design may be held: what the policy would do is left in `wanted`, what of it reaches the
    /// world in the critics' inputs.
    fn appraise<R: Rule<P>>(&mut self, step: &Step<'_, P, R>, block: &Range<usize>, hold: bool) {
        let (rows, sample) = (block.len(), step.sample);
        let noise = sample.now_noise.get(block.start..).unwrap_or(&[]);
        let (actions, log_prob) = R::act(step.policy, &sample.rows(&sample.now, block), noise, &mut self.live);
        self.wanted.copy_from_slice(actions);
        self.actions.copy_from_slice(actions);
        self.log_probs += log_prob.unwrap_or(&[]).iter().take(rows).map(|&p| f64::from(p)).sum::<f64>();
        step.limit(&mut self.actions, rows);
        if hold {
            step.hold(&mut self.actions, block);
        }
        let inputs = &mut self.inputs[..rows * step.view.width()];
        step.view.fill(sample, &sample.now, block, step.scaling, inputs);
        step.view.fill_actions(rows, (&self.actions, BLOCK), step.scaling, inputs);
        for (i, tape) in self.critics.iter_mut().take(R::JUDGES).enumerate() {
            step.critics.network.forward(inputs, rows, tape);
            take_least(i, tape, &mut self.least[..rows], &mut self.judge);
        }
        self.values += self.least[..rows].iter().map(|&value| f64::from(value)).sum::<f64>();
    }

    /// The gradient of the mean of α·log π(a|s) - min over judges of Q(s, a) by the policy's parameters, where a is the policy's,
    /// left on its tape: through critics, law and controller (Silver et al. 2014, eq. 9; Haarnoja et al. 2018, eq. 9).
    ///
    /// What was drawn for an episode is its mean and what was added to it, and the slope there is the mean's. So the controller
    /// learns to drive every body that it was given, and critics are asked for no body in the posture of another one.
    pub(crate) fn improve<R: Rule<P>>(&mut self, step: &Step<'_, P, R>) {
        let (network, sample) = (&step.critics.network, step.sample);
        // Without a slow copy it was bound for the critics' step, and parameters are as they were.
        if self.slow.is_some() {
            step.policy.bind(step.params, &mut self.live);
        }
        for i in 0..R::JUDGES {
            self.bind_critic(step, i);
        }
        (self.values, self.log_probs) = (0.0, 0.0);
        let (at, width) = (step.view.action_at(), step.view.width());
        let share = 1.0 / step.rows as f32;
        for block in Sample::blocks(self.rows.clone()) {
            let rows = block.len();
            self.appraise(step, &block, true);
            let inputs = &self.inputs[..rows * width];
            self.cotangents.fill(0.0);
            for (i, tape) in self.critics.iter_mut().take(R::JUDGES).enumerate() {
                for (c, &judge) in self.value_cotangent[..rows].iter_mut().zip(&self.judge) {
                    *c = if judge == i { -share } else { 0.0 };
                }
                network.vjp_inputs(inputs, &self.value_cotangent[..rows], tape);
                let (pulled, stride) = tape.input_cotangent();
                for (a, affine) in step.scaling.action.iter().enumerate() {
                    for (r, c) in self.cotangents[a * BLOCK..][..rows].iter_mut().enumerate() {
                        *c += pulled[r * stride + at + a] / affine.scale;
                    }
                }
            }
            // Beyond a limit nothing changes on the way out; the way back is open.
            let moments = sample.rows(&sample.now, &block);
            for (a, limits) in step.limits.iter().enumerate() {
                let Some((lo, hi)) = *limits else { continue };
                for (c, &action) in self.cotangents[a * BLOCK..][..rows].iter_mut().zip(&self.wanted[a * BLOCK..]) {
                    if (action > hi && *c < 0.0) || (action < lo && *c > 0.0) {
                        *c = 0.0;
                    }
                }
            }
            R::pull(step.policy, &moments, &self.cotangents, share * step.rule.temperature(), &mut self.live);
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
