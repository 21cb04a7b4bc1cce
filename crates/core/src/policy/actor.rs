//! Acting: several episodes in lock step, in the simulator's numbers.

use hwasp_diff::{MlpTape, ProgramTape};
use rand_distr::{Distribution, StandardNormal};

use super::{HardwarePolicy, ParamKind, Policy};
use crate::gaussian;
use crate::streams::Stream;

/// A policy with its parameters bound, ready to act in up to a fixed number of episodes at once.
///
/// The controller runs in `f32`, the law in `f64`. Every episode's numbers depend on its own row and its own stream alone.
#[derive(Debug)]
pub struct Actor<'p> {
    policy: &'p HardwarePolicy,
    controller: MlpTape<f32>,
    law: ProgramTape<f64>,
    /// Controller outputs, state, sampled design `[· × max]`.
    columns: Vec<f64>,
    mean: Vec<f64>,
    /// Actions, row by row.
    action: Vec<f64>,
    log_prob: Vec<f32>,
    std: Vec<f64>,
    /// Σ log σ + A/2·log 2π, the constant part of the log-probability.
    log_norm: f64,
    design_mean: Vec<f64>,
    max: usize,
}

impl<'p> Actor<'p> {
    /// Binds `params` as they are at `progress` in [0, 1] of training, for up to `max` episodes at once.
    pub fn new(policy: &'p HardwarePolicy, params: &[f32], progress: f64, max: usize) -> Self {
        let mut controller = policy.controller.tape(max);
        policy.controller.bind(&params[policy.range(ParamKind::Controller)], &mut controller);
        let program = &policy.composition.program;
        let u: Vec<f64> = params[policy.range(ParamKind::Design)].iter().map(|&u| f64::from(u)).collect();
        let mut law = program.tape(max);
        program.bind(&u, &mut law);
        let actions = policy.action_dim();
        let mut log_std = vec![0.0; actions];
        policy.log_std(params, progress, &mut log_std);
        let design = policy.design(params);
        Self {
            policy,
            controller,
            law,
            columns: vec![0.0; program.column_names().len() * max],
            mean: vec![0.0; actions * max],
            action: vec![0.0; actions * max],
            log_prob: vec![0.0; max],
            std: log_std.iter().map(|&s| f64::from(s).exp()).collect(),
            log_norm: gaussian::log_norm(&log_std),
            design_mean: policy.composition.layout.sampled.iter().map(|&i| design[i]).collect(),
            max,
        }
    }

    /// Acts in `rows` episodes at once. `obs` `[rows × obs_dim]` are controller inputs; `state` is
    /// `[state_dim × max]`, column by column. Without `noise` the action is the mean.
    pub fn act(&mut self, obs: &[f32], state: &[f64], rows: usize, noise: Option<&mut [Stream]>) {
        let layout = &self.policy.composition.layout;
        let (commands, states, max) = (self.policy.commands.len(), self.policy.state_dim(), self.max);
        self.policy.controller.forward(obs, rows, &mut self.controller);
        let (output, width) = self.controller.output();
        for (r, row) in output.chunks_exact(width).enumerate() {
            for j in 0..commands {
                self.columns[j * max + r] = f64::from(row[j]);
            }
        }
        self.columns[commands * max..][..states * max].copy_from_slice(state);
        let actions = layout.len();
        self.log_prob[..rows].fill(-self.log_norm as f32);
        // Design parameters in the action are drawn first: the law sees the sample.
        let sampled = layout.sampled.len();
        let mut noise = noise;
        for r in 0..rows {
            for j in 0..sampled {
                let z = draw(noise.as_deref_mut(), r);
                let value = self.design_mean[j] + self.std[j] * z;
                self.action[r * actions + j] = value;
                self.log_prob[r] -= (0.5 * z * z) as f32;
                let (lo, hi) = self.policy.space().bounds(layout.sampled[j]);
                self.columns[(commands + states + j) * max + r] = value.clamp(lo, hi);
            }
        }
        self.policy.composition.program.forward(&self.columns, max, rows, &mut self.law, &mut self.mean, max);
        for r in 0..rows {
            for j in sampled..actions {
                let z = draw(noise.as_deref_mut(), r);
                self.action[r * actions + j] = self.mean[j * max + r] + self.std[j] * z;
                self.log_prob[r] -= (0.5 * z * z) as f32;
            }
        }
    }

    /// The action of episode `r` in the last call of [`act`](Self::act).
    pub fn action(&self, r: usize) -> &[f64] {
        let actions = self.std.len();
        &self.action[r * actions..][..actions]
    }

    /// The log-probability of that action; of the unclipped sample.
    pub fn log_prob(&self, r: usize) -> f32 {
        self.log_prob[r]
    }
}

/// One standard normal number for episode `r`, zero without noise.
#[inline]
fn draw(noise: Option<&mut [Stream]>, r: usize) -> f64 {
    noise.map_or(0.0, |streams| StandardNormal.sample(&mut streams[r]))
}
