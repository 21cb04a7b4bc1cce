//! The policy, its divergence and its surrogate once more, in `f64` and over the whole batch at once.

use hwasp_core::gaussian::LOG_TWO_PI;
use hwasp_core::{Batch, HardwarePolicy, ParamKind, Policy};

pub(super) struct Model<'a> {
    policy: &'a HardwarePolicy,
    batch: &'a Batch,
    obs: Vec<f64>,
    /// Inputs of the law; the first ones, the commands, are the controller's.
    columns: Vec<f64>,
    /// One over the rows of each row's episode.
    share: Vec<f64>,
}

/// Means `[A × N]`.
type Means = Vec<f64>;

impl<'a> Model<'a> {
    pub(super) fn new(policy: &'a HardwarePolicy, batch: &'a Batch) -> Self {
        let n = batch.rows();
        let mut columns = vec![0.0; policy.controller().outputs() * n];
        for s in 0..policy.state_dim() {
            columns.extend(batch.state.iter().skip(s).step_by(policy.state_dim()).map(|&x| f64::from(x)));
        }
        for (j, name) in policy.action_names().iter().enumerate() {
            let Some(i) = policy.space().names().iter().position(|n| n == name) else { continue };
            let (lo, hi) = policy.space().bounds(i);
            let column = batch.action.iter().skip(j).step_by(policy.action_dim());
            columns.extend(column.map(|&x| f64::from(x.clamp(lo as f32, hi as f32))));
        }
        assert_eq!(columns.len(), policy.program().column_names().len() * n);
        let share = batch.episodes.iter().flat_map(|e| vec![1.0 / e.rows.len() as f64; e.rows.len()]).collect();
        Self { policy, batch, obs: batch.obs.iter().map(|&x| f64::from(x)).collect(), columns, share }
    }

    /// Means at `params`, and what the gradient of Σ cotangent·mean is there.
    fn means(&self, params: &[f64], cotangent: impl FnOnce(&Means) -> Vec<f64>) -> (Means, Vec<f64>) {
        let (policy, n) = (self.policy, self.batch.rows());
        let range = |kind| policy.groups().iter().find(|g| g.kind == kind).unwrap().range.clone();
        let (mlp, program) = (policy.controller(), policy.program());
        let (mut network, mut law) = (mlp.tape::<f64>(n), program.tape::<f64>(n));
        mlp.bind(&params[range(ParamKind::Controller)], &mut network);
        program.bind(&params[range(ParamKind::Design)], &mut law);
        mlp.forward(&self.obs, n, &mut network);
        let mut columns = self.columns.clone();
        let (output, width) = network.output();
        let commands = mlp.outputs();
        for j in 0..commands {
            for r in 0..n {
                columns[j * n + r] = output[r * width + j];
            }
        }
        let mut mean = vec![0.0; policy.action_dim() * n];
        program.forward(&columns, n, n, &mut law, &mut mean, n);
        let cotangent = cotangent(&mean);
        let mut moved = columns.clone();
        program.vjp(&columns, n, n, &cotangent, n, &mut law, &mut moved, n);
        let pulled: Vec<f64> = (0..n * commands).map(|k| moved[k % commands * n + k / commands]).collect();
        mlp.vjp(&self.obs, &pulled, &mut network);
        let mut gradient = vec![0.0; params.len()];
        mlp.gradient(&network, &mut gradient[range(ParamKind::Controller)]);
        program.vjp_uniform(&mut law, &mut gradient[range(ParamKind::Design)]);
        (mean, gradient)
    }

    /// How much component `j` counts in row `r`: what is drawn once an episode counts once in all of its rows.
    fn counts(&self, j: usize, r: usize) -> f64 {
        if j < self.policy.drawn_actions() { self.share[r] } else { 1.0 }
    }

    /// Mean KL(old || new) and its gradient with respect to `new`.
    pub(super) fn divergence(&self, old: &[f64], new: &[f64]) -> (f64, Vec<f64>) {
        let (n, actions) = (self.batch.rows(), self.policy.action_dim());
        let was = self.means(old, |m| vec![0.0; m.len()]).0;
        let at = self.policy.log_std_params().unwrap();
        let (old_std, new_std) = (&old[at.clone()], &new[at.clone()]);
        let weight = |j: usize, r: usize| self.counts(j, r) * (-2.0 * new_std[j]).exp() / n as f64;
        let pull = |is: &Means| (0..actions * n).map(|k| (is[k] - was[k]) * weight(k / n, k % n)).collect();
        let (is, mut gradient) = self.means(new, pull);
        let mut kl = 0.0;
        for j in 0..actions {
            let square = |r: usize| weight(j, r) * (is[j * n + r] - was[j * n + r]).powi(2);
            let (squares, count) =
                (0..n).map(|r| (square(r), self.counts(j, r))).fold((0.0, 0.0), |a, b| (a.0 + b.0, a.1 + b.1));
            let ratio = (2.0 * (old_std[j] - new_std[j])).exp();
            let count = count / n as f64;
            kl += count * (new_std[j] - old_std[j] + 0.5 * (ratio - 1.0)) + 0.5 * squares;
            gradient[at.start + j] = count * (1.0 - ratio) - squares;
        }
        (kl, gradient)
    }

    /// Mean of ρ·A, and of each draw's once an episode; `worth` has its value in each row.
    pub(super) fn surrogate(&self, params: &[f64], advantage: &[f32], worth: &[f32]) -> f64 {
        let (n, actions, drawn) = (self.batch.rows(), self.policy.action_dim(), self.policy.drawn_actions());
        let mean = self.means(params, |m| vec![0.0; m.len()]).0;
        let log_std = &params[self.policy.log_std_params().unwrap()];
        let log_prob = |r: usize, components: std::ops::Range<usize>| -> f64 {
            let term = |j: usize| {
                let z = (f64::from(self.batch.action[r * actions + j]) - mean[j * n + r]) * (-log_std[j]).exp();
                -0.5 * (z * z + LOG_TWO_PI) - log_std[j]
            };
            components.map(term).sum()
        };
        let steps = (0..n)
            .map(|r| (log_prob(r, drawn..actions) - f64::from(self.batch.log_prob[r])).exp() * f64::from(advantage[r]));
        // Of the first row of each episode.
        let draws =
            self.batch.episodes.iter().filter(|_| drawn > 0).map(|e| {
                (log_prob(e.rows.start, 0..drawn) - f64::from(e.log_prob)).exp() * f64::from(worth[e.rows.start])
            });
        (steps.sum::<f64>() + draws.sum::<f64>()) / n as f64
    }
}
