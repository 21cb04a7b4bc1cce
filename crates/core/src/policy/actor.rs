//! Acting: several episodes in lock step, in the simulator's numbers.

use hwasp_diff::{MlpTape, ProgramTape};
use rand_distr::{Distribution, StandardNormal};

use super::{HardwarePolicy, ParamKind, Policy, spread};
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
    /// Commands that are not in the action, row by row.
    unsampled: Vec<f64>,
    log_prob: Vec<f32>,
    std: Vec<f64>,
    /// How many components of the action noise is added to: all, or all but the commands where they are drawn before the law.
    noisy: usize,
    /// Σ log σ + A/2·log 2π of what noise is added to at every step, the constant part of the log-probability.
    log_norm: f64,
    /// The same of what is drawn once an episode.
    draw_norm: f64,
    design_mean: Vec<f64>,
    /// What was drawn for each episode, not clipped, row by row.
    drawn: Vec<f64>,
    draw_log_prob: Vec<f32>,
    /// The whole design: of the episode that was begun last where it is drawn, else as the parameters say.
    design: Vec<f64>,
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
        let layout = &policy.composition.layout;
        let design_mean: Vec<f64> = layout.sampled.iter().map(|&i| design[i]).collect();
        let draw_norm = gaussian::log_norm(&log_std[..layout.drawn]);
        let noisy = if policy.spec().state_dependent_std { actions - layout.commands.len() } else { actions };
        Self {
            policy,
            controller,
            law,
            columns: vec![0.0; program.column_names().len() * max],
            mean: vec![0.0; actions * max],
            action: vec![0.0; actions * max],
            unsampled: vec![0.0; layout.unsampled.len() * max],
            log_prob: vec![0.0; max],
            std: log_std.iter().map(|&s| f64::from(s).exp()).collect(),
            noisy,
            log_norm: gaussian::log_norm(&log_std[layout.drawn..noisy]),
            draw_norm,
            drawn: design_mean[..layout.drawn].repeat(max),
            draw_log_prob: vec![(0.0 - draw_norm) as f32; max],
            design_mean,
            design,
            max,
        }
    }

    /// Begins an episode in row `r`: draws what is drawn once an episode, without `noise` its mean. Returns the whole design of
    /// the episode, SI: what was drawn, within its limits, and of other parameters what the policy has. Rows that were never
    /// begun have the mean.
    pub fn begin(&mut self, r: usize, mut noise: Option<&mut Stream>) -> &[f64] {
        let layout = &self.policy.composition.layout;
        let mut log_prob = (0.0 - self.draw_norm) as f32;
        for (j, &i) in layout.sampled[..layout.drawn].iter().enumerate() {
            let z: f64 = noise.as_deref_mut().map_or(0.0, |stream| StandardNormal.sample(stream));
            let value = self.design_mean[j] + self.std[j] * z;
            self.drawn[r * layout.drawn + j] = value;
            log_prob -= (0.5 * z * z) as f32;
            let (lo, hi) = self.policy.space().bounds(i);
            self.design[i] = value.clamp(lo, hi);
        }
        self.draw_log_prob[r] = log_prob;
        &self.design
    }

    /// Acts in `rows` episodes at once. `obs` `[rows × obs_dim]` are controller inputs; `state` is
    /// `[state_dim × max]`, column by column. Without `noise` the action is the mean.
    pub fn act(&mut self, obs: &[f32], state: &[f64], rows: usize, noise: Option<&mut [Stream]>) {
        let layout = &self.policy.composition.layout;
        let (commands, states, max) = (self.policy.commands.len(), self.policy.state_dim(), self.max);
        self.policy.controller.forward(obs, rows, &mut self.controller);
        self.log_prob[..rows].fill(-self.log_norm as f32);
        let mut noise = noise;
        let (output, width) = self.controller.output();
        for (r, row) in output.chunks_exact(width).enumerate() {
            for j in 0..commands {
                self.columns[j * max + r] = if self.policy.spec().state_dependent_std {
                    let z = draw(noise.as_deref_mut(), r) as f32;
                    let squash = self.policy.spec().squash;
                    let (command, _, log_prob) = spread::draw(row[j], row[commands + j], z, squash);
                    self.log_prob[r] += log_prob;
                    f64::from(command)
                } else {
                    f64::from(row[j])
                };
            }
        }
        let unsampled = layout.unsampled.len();
        for (k, &c) in layout.unsampled.iter().enumerate() {
            let port = &self.policy.commands[c];
            for r in 0..rows {
                let out = self.columns[c * max + r];
                self.unsampled[r * unsampled + k] = out * (0.5 * (port.hi - port.lo)) + 0.5 * (port.hi + port.lo);
            }
        }
        self.columns[commands * max..][..states * max].copy_from_slice(state);
        let actions = layout.len();
        // Design parameters in the action come first: the law sees the sample.
        let (sampled, drawn) = (layout.sampled.len(), layout.drawn);
        for r in 0..rows {
            for j in 0..sampled {
                let value = if j < drawn {
                    self.drawn[r * drawn + j]
                } else {
                    let z = draw(noise.as_deref_mut(), r);
                    self.log_prob[r] -= (0.5 * z * z) as f32;
                    self.design_mean[j] + self.std[j] * z
                };
                self.action[r * actions + j] = value;
                let (lo, hi) = self.policy.space().bounds(layout.sampled[j]);
                self.columns[(commands + states + j) * max + r] = value.clamp(lo, hi);
            }
        }
        self.policy.composition.program.forward(&self.columns, max, rows, &mut self.law, &mut self.mean, max);
        for r in 0..rows {
            for j in sampled..self.noisy {
                let z = draw(noise.as_deref_mut(), r);
                self.action[r * actions + j] = self.mean[j * max + r] + self.std[j] * z;
                self.log_prob[r] -= (0.5 * z * z) as f32;
            }
            for j in self.noisy..actions {
                self.action[r * actions + j] = self.mean[j * max + r];
            }
        }
    }

    /// The action of episode `r` in the last call of [`act`](Self::act).
    pub fn action(&self, r: usize) -> &[f64] {
        let actions = self.std.len();
        &self.action[r * actions..][..actions]
    }

    /// The commands of episode `r` that are not in the action, as only the law reads them: not limited, in the order of the
    /// environment's.
    pub fn unsampled(&self, r: usize) -> &[f64] {
        let count = self.policy.composition.layout.unsampled.len();
        &self.unsampled[r * count..][..count]
    }

    /// The log-probability of that action; of the unclipped sample, and without what is drawn once an episode.
    pub fn log_prob(&self, r: usize) -> f32 {
        self.log_prob[r]
    }

    /// The log-probability of what was drawn for episode `r`, unclipped; 0 where nothing is.
    pub fn draw_log_prob(&self, r: usize) -> f32 {
        self.draw_log_prob[r]
    }
}

/// One standard normal number for episode `r`, zero without noise.
#[inline]
fn draw(noise: Option<&mut [Stream]>, r: usize) -> f64 {
    noise.map_or(0.0, |streams| StandardNormal.sample(&mut streams[r]))
}
