//! The linear feature baseline (Duan et al. 2016, section 4), as the paper's toolkit has it.

use hwasp_core::{Batch, Episode};
use nalgebra::{DMatrix, DVector};

use super::InputDims;
use crate::archive::{Exchange, Persist, StateError};

/// Ridge regression of the discounted return on [o, o², a, a², a³, 1], with o what it sees, clipped to ±10, and a = t/100
/// the time in the episode. It sees the controller's input, and where it is told to the law's state and the episode's context.
#[derive(Clone, Debug, PartialEq)]
pub struct LinearBaseline {
    coefficients: Vec<f64>,
    /// Of what it sees of a batch: of the state and of the context all or nothing.
    visible: InputDims,
    ridge: f64,
}

impl LinearBaseline {
    /// Zero everywhere until the first fit.
    pub fn new(visible: InputDims, ridge: f64) -> Self {
        Self { coefficients: vec![0.0; 2 * (visible.obs + visible.state + visible.context) + 4], visible, ridge }
    }

    /// Calls `each` with row and features of every step of the episode, and with those of the state after it.
    fn visit(
        &self,
        batch: &Batch,
        episode: &Episode,
        features: &mut [f64],
        mut each: impl FnMut(Option<usize>, &[f64]),
    ) {
        let InputDims { obs: obs_dim, state: state_dim, context } = self.visible;
        let steps = episode.rows.clone().map(Some).chain([None]);
        for (time, row) in steps.enumerate() {
            let (obs, state) = match row {
                Some(row) => (&batch.obs[row * obs_dim..], batch.state.get(row * state_dim..).unwrap_or(&[])),
                None => (&episode.last_obs[..], &episode.last_state[..]),
            };
            let seen = obs[..obs_dim].iter().chain(&state[..state_dim]).chain(&episode.context[..context]);
            let (first, rest) = features.split_at_mut(obs_dim + state_dim + context);
            for ((&o, first), second) in seen.zip(first).zip(&mut *rest) {
                let o = f64::from(o).clamp(-10.0, 10.0);
                (*first, *second) = (o, o * o);
            }
            let a = time as f64 / 100.0;
            rest[obs_dim + state_dim + context..].copy_from_slice(&[a, a * a, a * a * a, 1.0]);
            each(row, features);
        }
    }

    /// V of every row, and of the state after each episode.
    pub fn predict(&self, batch: &Batch) -> (Vec<f32>, Vec<f32>) {
        let mut features = vec![0.0; self.coefficients.len()];
        let mut values = Vec::with_capacity(batch.rows());
        let mut last = Vec::with_capacity(batch.episodes.len());
        for episode in &batch.episodes {
            self.visit(batch, episode, &mut features, |row, features| {
                let value = features.iter().zip(&self.coefficients).map(|(f, c)| f * c).sum::<f64>() as f32;
                if row.is_some() { values.push(value) } else { last.push(value) }
            });
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
            self.visit(batch, episode, &mut features, |row, features| {
                let Some(target) = row.map(|row| f64::from(targets[row])) else { return };
                for i in 0..n {
                    for j in 0..=i {
                        normal[i * n + j] += features[i] * features[j];
                    }
                    right[i] += features[i] * target;
                }
            });
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

impl Persist for LinearBaseline {
    fn exchange(&mut self, with: &mut Exchange<'_>) -> Result<(), StateError> {
        with.vector("coefficients", &mut self.coefficients)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use hwasp_core::End;

    fn dims(state: usize) -> InputDims {
        InputDims { obs: 1, state, context: 0 }
    }

    #[test]
    fn recovers_a_function_of_its_features() {
        let rows = 200;
        let obs: Vec<f32> = (0..rows).map(|i| ((i * 37 % 101) as f32) / 50.0 - 1.0).collect();
        let truth = |o: f32, t: usize| 3.0 * o - 2.0 * o * o + 0.5 * (t as f32 / 100.0) - 7.0;
        let targets: Vec<f32> = (0..rows).map(|t| truth(obs[t], t)).collect();
        let batch = Batch {
            obs,
            reward: vec![0.0; rows],
            episodes: vec![Episode {
                rows: 0..rows,
                end: End::Truncated,
                cut: false,
                last_obs: vec![0.25],
                last_state: vec![],
                context: vec![],
                log_prob: 0.0,
                outcome: None,
                terms: vec![],
            }],
            ..Batch::default()
        };
        let mut baseline = LinearBaseline::new(dims(0), 1e-5);
        assert_eq!(baseline.predict(&batch).0, vec![0.0; rows]);
        baseline.fit(&batch, &targets);
        let (values, last) = baseline.predict(&batch);
        for (value, target) in values.iter().zip(&targets) {
            assert!((value - target).abs() < 1e-3, "{value} against {target}");
        }
        assert!((last[0] - truth(0.25, rows)).abs() < 1e-3);
    }

    /// Under a ridge λ that dwarfs all features x, the coefficients are Σ target·x/λ: features can be told from predictions.
    /// Here λ is the target, so that they are Σ x. Rows at times 0 and 1 see 20, clipped to 10, and -1; the state after
    /// them 0.5, at time 2.
    #[test]
    fn features_by_hand() {
        let batch = Batch {
            obs: vec![20.0, -1.0],
            reward: vec![0.0; 2],
            episodes: vec![Episode {
                rows: 0..2,
                end: End::Truncated,
                cut: false,
                last_obs: vec![0.5],
                last_state: vec![],
                context: vec![],
                log_prob: 0.0,
                outcome: None,
                terms: vec![],
            }],
            ..Batch::default()
        };
        let features = |o: f64, a: f64| [o, o * o, a, a * a, a * a * a, 1.0];
        let (first, second, last) = (features(10.0, 0.0), features(-1.0, 0.01), features(0.5, 0.02));
        let wanted: f64 = (0..6).map(|i| (first[i] + second[i]) * last[i]).sum();
        let mut baseline = LinearBaseline::new(dims(0), 1e12);
        baseline.fit(&batch, &[1e12, 1e12]);
        assert!((f64::from(baseline.predict(&batch).1[0]) - wanted).abs() < 1e-5 * wanted);
        // The share of the time: 0.01·0.02, far below the rest.
        let mut early = baseline.clone();
        early.coefficients[..2].fill(0.0);
        early.coefficients[5] = 0.0;
        assert!((f64::from(early.predict(&batch).1[0]) - 2e-4).abs() < 1e-6);
    }

    /// Two episodes that look the same and end differently.
    #[test]
    fn sees_the_context_where_it_is_told_to() {
        let (batch, targets) = super::super::tests::two_that_look_alike();
        let worst = |context| {
            let mut baseline = LinearBaseline::new(InputDims { context, ..dims(0) }, 1e-5);
            baseline.fit(&batch, &targets);
            let (values, last) = baseline.predict(&batch);
            let off = values.iter().zip(&targets).chain(last.iter().zip(&[10.0, -10.0])).map(|(v, t)| (v - t).abs());
            off.fold(0.0, f32::max)
        };
        assert!(worst(1) < 1e-3 && worst(0) > 5.0, "{} and {}", worst(1), worst(0));
    }

    #[test]
    fn sees_the_state_where_it_is_privileged() {
        let rows = 100;
        let state: Vec<f32> = (0..rows).map(|i| (i * 29 % 83) as f32 / 41.0).collect();
        let targets: Vec<f32> = state.iter().map(|s| 2.0 - 3.0 * s * s).collect();
        let batch = Batch {
            obs: vec![0.5; rows],
            state,
            reward: vec![0.0; rows],
            episodes: vec![Episode {
                rows: 0..rows,
                end: End::Truncated,
                cut: false,
                last_obs: vec![0.5],
                last_state: vec![1.0],
                context: vec![],
                log_prob: 0.0,
                outcome: None,
                terms: vec![],
            }],
            ..Batch::default()
        };
        let error = |state_dim| {
            let mut baseline = LinearBaseline::new(dims(state_dim), 1e-5);
            baseline.fit(&batch, &targets);
            let (values, last) = baseline.predict(&batch);
            let errors = values.iter().zip(&targets).map(|(v, t)| (v - t).abs());
            errors.fold((last[0] + 1.0).abs(), f32::max)
        };
        assert!(error(1) < 1e-3, "{}", error(1));
        assert!(error(0) > 1.0, "what it does not see it cannot tell: {}", error(0));
    }
}
