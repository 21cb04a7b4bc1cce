//! The linear feature baseline (Duan et al. 2016, section 4), as the paper's toolkit has it.

use hwasp_core::Batch;
use nalgebra::{DMatrix, DVector};

/// Ridge regression of the discounted return on [o, o², a, a², a³, 1], with o the controller's input clipped to ±10 and
/// a = t/100 the time in the episode.
#[derive(Clone, Debug, PartialEq)]
pub struct LinearBaseline {
    coefficients: Vec<f64>,
    obs_dim: usize,
    ridge: f64,
}

impl LinearBaseline {
    /// Zero everywhere until the first fit.
    pub fn new(obs_dim: usize, ridge: f64) -> Self {
        Self { coefficients: vec![0.0; 2 * obs_dim + 4], obs_dim, ridge }
    }

    fn features(&self, obs: &[f32], time: usize, out: &mut [f64]) {
        let n = self.obs_dim;
        for (i, &o) in obs.iter().enumerate() {
            let o = f64::from(o).clamp(-10.0, 10.0);
            out[i] = o;
            out[n + i] = o * o;
        }
        let a = time as f64 / 100.0;
        out[2 * n..].copy_from_slice(&[a, a * a, a * a * a, 1.0]);
    }

    fn value(&self, obs: &[f32], time: usize, features: &mut [f64]) -> f32 {
        self.features(obs, time, features);
        features.iter().zip(&self.coefficients).map(|(f, c)| f * c).sum::<f64>() as f32
    }

    /// V of every row, and of the state after each episode.
    pub fn predict(&self, batch: &Batch) -> (Vec<f32>, Vec<f32>) {
        let mut features = vec![0.0; self.coefficients.len()];
        let mut values = Vec::with_capacity(batch.rows());
        let mut last = Vec::with_capacity(batch.episodes.len());
        for episode in &batch.episodes {
            for (time, row) in episode.rows.clone().enumerate() {
                let obs = &batch.obs[row * self.obs_dim..][..self.obs_dim];
                values.push(self.value(obs, time, &mut features));
            }
            last.push(self.value(&episode.last_obs, episode.rows.len(), &mut features));
        }
        (values, last)
    }

    /// Refits to the batch alone. Where the normal equations cannot be solved the ridge is raised tenfold, up to five
    /// times; failing that, the fit stays as it was.
    pub fn fit(&mut self, batch: &Batch, targets: &[f32]) {
        let n = self.coefficients.len();
        let mut features = vec![0.0; n];
        let mut normal = vec![0.0; n * n];
        let mut right = vec![0.0; n];
        for episode in &batch.episodes {
            for (time, row) in episode.rows.clone().enumerate() {
                self.features(&batch.obs[row * self.obs_dim..][..self.obs_dim], time, &mut features);
                let target = f64::from(targets[row]);
                for i in 0..n {
                    for j in 0..=i {
                        normal[i * n + j] += features[i] * features[j];
                    }
                    right[i] += features[i] * target;
                }
            }
        }
        let right = DVector::from_vec(right);
        let mut ridge = self.ridge;
        for _ in 0..=5 {
            let matrix =
                DMatrix::from_fn(n, n, |i, j| normal[i.max(j) * n + i.min(j)] + if i == j { ridge } else { 0.0 });
            if let Some(factor) = matrix.cholesky() {
                let solution = factor.solve(&right);
                if solution.iter().all(|c| c.is_finite()) {
                    self.coefficients = solution.as_slice().to_vec();
                    return;
                }
            }
            ridge *= 10.0;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use hwasp_core::{End, Episode};

    #[test]
    fn recovers_a_function_of_its_features() {
        let rows = 200;
        let obs: Vec<f32> = (0..rows).map(|i| ((i * 37 % 101) as f32) / 50.0 - 1.0).collect();
        let truth = |o: f32, t: usize| 3.0 * o - 2.0 * o * o + 0.5 * (t as f32 / 100.0) - 7.0;
        let targets: Vec<f32> = (0..rows).map(|t| truth(obs[t], t)).collect();
        let batch = Batch {
            obs,
            reward: vec![0.0; rows],
            episodes: vec![Episode { rows: 0..rows, end: End::Truncated, last_obs: vec![0.25], last_state: vec![] }],
            ..Batch::default()
        };
        let mut baseline = LinearBaseline::new(1, 1e-5);
        assert_eq!(baseline.predict(&batch).0, vec![0.0; rows]);
        baseline.fit(&batch, &targets);
        let (values, last) = baseline.predict(&batch);
        for (value, target) in values.iter().zip(&targets) {
            assert!((value - target).abs() < 1e-3, "{value} against {target}");
        }
        assert!((last[0] - truth(0.25, rows)).abs() < 1e-3);
    }
}
