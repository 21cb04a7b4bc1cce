//! Commands that are drawn with a spread that the controller tells, before the law sees them.

use hwasp_diff::Float;

use super::{Policy, Rows};
use crate::gaussian::LOG_TWO_PI;

/// Limits of the log standard deviations that a controller tells (Haarnoja et al. 2018). Beyond them nothing learns.
const LOG_STD_LIMITS: (f32, f32) = (-20.0, 2.0);

/// A policy whose commands are a differentiable function of its parameters and of numbers that are drawn apart from it: the
/// reparameterisation of soft actor-critic (Haarnoja et al. 2018, second version, eq. 8).
pub trait Reparameterised: Policy {
    /// Commands that are drawn: the standard normal numbers of a row.
    fn drawn_commands(&self) -> usize;

    /// Draws the actions of a block, `[A × tape rows]` column by column, and says the log-probabilities of their commands, one a
    /// row, as densities over [-1, 1] of each motor's range. `noise` are standard normal numbers `[commands × stride]`, column by
    /// column, with the stride of `rows`.
    ///
    /// Efforts are what the law makes of the commands that were drawn; design parameters in the action have their means.
    fn sample<'t>(&self, rows: &Rows<'_>, noise: &[f32], tape: &'t mut Self::Tape) -> (&'t [f32], &'t [f32]);

    /// Adds the gradient of Σ cotangent·action + `of_log_prob`·Σ log-probability over the block of the last [`sample`](Self::sample).
    fn vjp_sample(&self, rows: &Rows<'_>, cotangent: &[f32], of_log_prob: f32, tape: &mut Self::Tape);
}

/// What the controller's outputs came to in the last block: `[· × max_rows]`, column by column.
#[derive(Debug)]
pub(super) struct CommandTape {
    /// Standard deviations, and the numbers that were drawn.
    std: Vec<f32>,
    noise: Vec<f32>,
    /// 1 where the log standard deviation is within its limits, else 0.
    free: Vec<f32>,
    /// Of each row.
    pub(super) log_prob: Vec<f32>,
    squash: bool,
    max_rows: usize,
}

/// A command from its mean and log standard deviation, as the controller tells them, and a standard normal number: the command, its
/// standard deviation before the squash, and its log-probability.
#[inline]
pub(super) fn draw(mean: f32, log_std: f32, noise: f32, squash: bool) -> (f32, f32, f32) {
    let (lo, hi) = LOG_STD_LIMITS;
    let log_std = log_std.clamp(lo, hi);
    let std = log_std.exp();
    let sum = mean + std * noise;
    let log_prob = -0.5 * noise * noise - log_std - 0.5 * LOG_TWO_PI as f32;
    if !squash {
        return (sum, std, log_prob);
    }
    // log(1 - tanh²x) = 2·(log 2 - |x| - log(1 + e^(-2|x|))), which keeps its digits where tanh is 1.
    let size = sum.abs();
    let stretch = 2.0 * (std::f32::consts::LN_2 - size - (-2.0 * size).exp().ln_1p());
    (Float::tanh(sum), std, log_prob - stretch)
}

impl CommandTape {
    /// For blocks of up to so many rows.
    pub(super) fn new(commands: usize, squash: bool, max_rows: usize) -> Self {
        let column = vec![0.0; commands * max_rows];
        Self {
            std: column.clone(),
            noise: column.clone(),
            free: column,
            log_prob: vec![0.0; max_rows],
            squash,
            max_rows,
        }
    }

    /// Draws the commands of `count` rows into `columns`, from the controller's outputs, whose rows are `width` apart. Without
    /// `noise` (numbers and the distance between their columns) they are the means.
    pub(super) fn draw(
        &mut self,
        (output, width): (&[f32], usize),
        count: usize,
        noise: Option<(&[f32], usize)>,
        columns: &mut [f32],
    ) {
        let (stride, commands) = (self.max_rows, self.std.len() / self.max_rows);
        self.log_prob[..count].fill(0.0);
        for j in 0..commands {
            for (r, row) in output.chunks_exact(width).take(count).enumerate() {
                let at = j * stride + r;
                let (mean, log_std) = (row[j], row[commands + j]);
                let noise = noise.map_or(0.0, |(noise, stride)| noise[j * stride + r]);
                let (command, std, log_prob) = draw(mean, log_std, noise, self.squash);
                (columns[at], self.std[at], self.noise[at]) = (command, std, noise);
                self.free[at] = f32::from((LOG_STD_LIMITS.0..=LOG_STD_LIMITS.1).contains(&log_std));
                self.log_prob[r] += log_prob;
            }
        }
    }

    /// How much a command changes with what goes into the squash.
    #[inline]
    pub(super) fn slope(&self, command: f32) -> f32 {
        if self.squash { 1.0 - command * command } else { 1.0 }
    }

    /// Turns cotangents of the commands of `count` rows, and of their log-probabilities, into those of the controller's outputs, row by
    /// row.
    pub(super) fn pull(
        &self,
        (commands, cotangents): (&[f32], &[f32]),
        of_log_prob: f32,
        count: usize,
        outputs: &mut [f32],
    ) {
        let width = 2 * self.std.len() / self.max_rows;
        for (r, row) in outputs.chunks_exact_mut(width).take(count).enumerate() {
            let (means, log_stds) = row.split_at_mut(width / 2);
            for (j, (mean, log_std)) in means.iter_mut().zip(log_stds).enumerate() {
                let at = j * self.max_rows + r;
                let command = commands[at];
                // d log-probability / d sum = 2·tanh(sum), from the squash alone.
                let through = if self.squash { 2.0 * command * of_log_prob } else { 0.0 };
                let sum = cotangents[at] * self.slope(command) + through;
                *mean = sum;
                *log_std = self.free[at] * (sum * self.std[at] * self.noise[at] - of_log_prob);
            }
        }
    }
}
