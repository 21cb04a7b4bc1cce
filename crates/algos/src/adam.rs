//! Adam (Kingma and Ba 2015, algorithm 1).

use hwasp_core::{ParamGroup, ParamKind};
use hwasp_diff::fast::vectorised;
use serde::{Deserialize, Serialize};

use crate::archive::{Exchange, Persist, StateError};

/// Settings of [`Adam`].
///
/// | name | default | purpose |
/// |---|---|---|
/// | `beta_1` | 0.9 | decay of the gradient's mean |
/// | `beta_2` | 0.999 | decay of its second moment |
/// | `epsilon` | 1e-8 | keeps the step finite |
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct AdamConfig {
    /// Decay of the running mean of the gradient.
    pub beta_1: f64,
    /// Decay of the running mean of its square.
    pub beta_2: f64,
    /// Added to the root of the second moment.
    pub epsilon: f64,
}

impl Default for AdamConfig {
    fn default() -> Self {
        Self { beta_1: 0.9, beta_2: 0.999, epsilon: 1e-8 }
    }
}

/// The optimiser's state.
#[derive(Clone, Debug, PartialEq)]
pub struct Adam {
    config: AdamConfig,
    first: Vec<f32>,
    second: Vec<f32>,
    steps: u64,
}

impl Adam {
    /// For `count` parameters.
    pub fn new(config: AdamConfig, count: usize) -> Self {
        Self { config, first: vec![0.0; count], second: vec![0.0; count], steps: 0 }
    }

    /// One descent step; `learning_rate` is per parameter.
    pub fn step(&mut self, params: &mut [f32], gradient: &[f32], learning_rate: &[f32]) {
        self.steps += 1;
        let t = i32::try_from(self.steps).unwrap_or(i32::MAX);
        let (b1, b2) = (self.config.beta_1, self.config.beta_2);
        let correct_1 = (1.0 / (1.0 - b1.powi(t))) as f32;
        let correct_2 = (1.0 / (1.0 - b2.powi(t))) as f32;
        let (b1, b2, epsilon) = (b1 as f32, b2 as f32, self.config.epsilon as f32);
        let (first, second) = (&mut self.first[..params.len()], &mut self.second[..params.len()]);
        let (gradient, learning_rate) = (&gradient[..params.len()], &learning_rate[..params.len()]);
        vectorised(
            #[inline(always)]
            || {
                for i in 0..params.len() {
                    let g = gradient[i];
                    first[i] = b1 * first[i] + (1.0 - b1) * g;
                    second[i] = b2 * second[i] + (1.0 - b2) * g * g;
                    let step = first[i] * correct_1 / ((second[i] * correct_2).sqrt() + epsilon);
                    params[i] -= learning_rate[i] * step;
                }
            },
        );
    }
}

impl Persist for Adam {
    fn exchange(&mut self, with: &mut Exchange<'_>) -> Result<(), StateError> {
        with.vector("first", &mut self.first)?;
        with.vector("second", &mut self.second)?;
        with.number("steps", &mut self.steps)
    }
}

/// Learning rates of `count` parameters: `rate`, times `design_scale` where they are the design's and times `log_std_scale` where
/// they are log standard deviations; nothing where no gradient may move them.
pub fn group_rates(groups: &[ParamGroup], count: usize, rate: f64, design_scale: f64, log_std_scale: f64) -> Vec<f32> {
    let mut rates = vec![rate as f32; count];
    for group in groups {
        let scale = match group.kind {
            ParamKind::Controller => 1.0,
            ParamKind::Normalizer => 0.0,
            ParamKind::Design => design_scale,
            ParamKind::LogStd => log_std_scale,
        };
        rates[group.range.clone()].fill((rate * scale) as f32);
    }
    rates
}

/// Scales `gradient` down to `max_norm` if it is longer; returns its norm before.
pub(crate) fn clip_norm(gradient: &mut [f32], max_norm: Option<f64>) -> f64 {
    let norm = vectorised(
        #[inline(always)]
        || {
            // Sixteen sums at once: one alone would wait for every addition.
            let mut squares = [0.0; 16];
            let chunks = gradient.chunks_exact(16);
            for (sum, &g) in squares.iter_mut().zip(chunks.remainder()) {
                *sum += f64::from(g) * f64::from(g);
            }
            for chunk in chunks {
                for l in 0..16 {
                    squares[l] += f64::from(chunk[l]) * f64::from(chunk[l]);
                }
            }
            squares.iter().sum::<f64>().sqrt()
        },
    );
    if let Some(limit) = max_norm
        && norm > limit
    {
        let scale = (limit / norm) as f32;
        for g in gradient {
            *g *= scale;
        }
    }
    norm
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_steps_by_hand() {
        let mut adam = Adam::new(AdamConfig { beta_1: 0.5, beta_2: 0.75, epsilon: 0.0 }, 1);
        let mut p = [1.0];
        // m = 0.5·2 = 1, v = 0.25·4 = 1; corrected m = 2, v = 4: a step of 0.1·2/2.
        adam.step(&mut p, &[2.0], &[0.1]);
        assert!((p[0] - 0.9).abs() < 1e-6);
        // m = 0.5 + 0.5·4 = 2.5, v = 0.75 + 0.25·16 = 4.75; corrected m = 2.5/0.75, v = 4.75/0.4375.
        adam.step(&mut p, &[4.0], &[0.1]);
        let step = 0.1 * (2.5 / 0.75) / (4.75_f32 / 0.4375).sqrt();
        assert!((p[0] - (0.9 - step)).abs() < 1e-6);
    }

    #[test]
    fn clipping_keeps_the_direction() {
        let mut g = [3.0, 4.0];
        assert_eq!(clip_norm(&mut g, Some(1.0)), 5.0);
        assert!((g[0] - 0.6).abs() < 1e-6 && (g[1] - 0.8).abs() < 1e-6);
        clip_norm(&mut g, Some(0.5));
        assert!((g[0] - 0.3).abs() < 1e-6 && (g[1] - 0.4).abs() < 1e-6);
        assert_eq!(clip_norm(&mut [3.0, 4.0], None), 5.0);
    }
}
