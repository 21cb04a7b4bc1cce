//! A perceptron as value function.

use hwasp_core::{Batch, Purpose, Stream, share_left, stream};
use hwasp_diff::{Activation, Mlp, MlpTape};
use rand::RngExt;
use rand::seq::SliceRandom;
use serde::{Deserialize, Serialize};

use super::InputDims;
use crate::adam::{Adam, AdamConfig, clip_norm};
use crate::archive::{Exchange, Persist, StateError};
use crate::minibatch::{BLOCK, minibatches};

/// Settings of an [`MlpBaseline`].
///
/// | name | default | purpose |
/// |---|---|---|
/// | `hidden` | `[32, 32]` | widths of the hidden tanh layers |
/// | `learning_rate` | 1e-3 | of Adam |
/// | `learning_rate_final` | 1 | fraction of it left at the end of a linear decay |
/// | `epochs` | 4 | passes over a batch |
/// | `minibatch_rows` | 1000 | rows of a gradient step at most, the same for all steps but for one row; 0 for the whole batch |
/// | `max_grad_norm` | 0.5 | longest gradient |
/// | `privileged` | false | also sees the law's state, which the controller does not |
/// | `context` | false | also sees what the episode is about and no sensor tells |
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct MlpBaselineConfig {
    /// Widths of the hidden layers.
    pub hidden: Vec<usize>,
    /// Step size of Adam at the start.
    pub learning_rate: f64,
    /// What fraction of it is left at the end.
    pub learning_rate_final: f64,
    /// Passes over a batch.
    pub epochs: usize,
    /// Rows of a gradient step at most: a batch is divided evenly. 0 for the whole batch.
    pub minibatch_rows: usize,
    /// Longest gradient.
    pub max_grad_norm: Option<f64>,
    /// Whether it also sees the law's state. Only the controller has to do without it, and only after training
    /// (asymmetric actor-critic: Pinto et al. 2018).
    pub privileged: bool,
    /// Whether it also sees the episode's context: what of the return no action decides is then no noise to the advantages.
    pub context: bool,
}

impl Default for MlpBaselineConfig {
    fn default() -> Self {
        Self {
            hidden: vec![32, 32],
            learning_rate: 1e-3,
            learning_rate_final: 1.0,
            epochs: 4,
            minibatch_rows: 1000,
            max_grad_norm: Some(0.5),
            privileged: false,
            context: false,
        }
    }
}

/// V(s) = mean + std·network(s), where mean and std follow the targets and the last layer is corrected whenever they
/// move, so that V does not jump (PopArt: van Hasselt et al. 2016, eqs. 9 and 10).
#[derive(Debug)]
pub struct MlpBaseline {
    config: MlpBaselineConfig,
    network: Mlp,
    params: Vec<f32>,
    adam: Adam,
    /// Running mean and second moment of the targets; none before the first fit.
    moments: Option<(f64, f64)>,
    /// Centre and scale of each component that it sees of state and context, from the first batch.
    scaling: Vec<(f32, f32)>,
    /// Of a batch.
    dims: InputDims,
    /// Of what it sees of a batch.
    visible: InputDims,
    seed: u64,
    tape: MlpTape<f32>,
}

/// A fit on its way, from epoch to epoch.
pub(crate) struct Fit {
    /// Learning rates of all parameters.
    rate: Vec<f32>,
    order: Vec<u32>,
    shuffle: Stream,
    gradient: Vec<f32>,
    /// Inputs and cotangents of a block.
    seen: Vec<f32>,
    cotangent: Vec<f32>,
}

/// Mean and standard deviation, the latter 1 where nothing varies.
fn centre_and_scale<'a>(values: impl Iterator<Item = &'a f32> + Clone) -> (f32, f32) {
    let n = values.clone().count().max(1) as f64;
    let values = values.map(|&x| f64::from(x));
    let mean = values.clone().sum::<f64>() / n;
    let std = (values.map(|x| (x - mean).powi(2)).sum::<f64>() / n).sqrt();
    (mean as f32, if std > 0.0 { std as f32 } else { 1.0 })
}

/// How far the running moments move towards each batch.
const MOMENT_RATE: f64 = 0.1;

impl MlpBaseline {
    /// Zero or near zero everywhere until the first fit.
    pub fn new(config: MlpBaselineConfig, dims: InputDims, seed: u64) -> Self {
        let visible = dims.visible(config.privileged, config.context);
        let beside = visible.state + visible.context;
        let mut sizes = vec![visible.obs + beside];
        sizes.extend(&config.hidden);
        sizes.push(1);
        let network = Mlp::new(&sizes, Activation::Tanh, Activation::Identity);
        let mut weights = stream(seed, Purpose::Baseline, 0, 0);
        let params = network.init(0.1, || weights.random::<f64>());
        let adam = Adam::new(AdamConfig::default(), params.len());
        let tape = network.tape(BLOCK);
        let scaling = vec![(0.0, 1.0); beside];
        Self { config, network, params, adam, moments: None, scaling, dims, visible, seed, tape }
    }

    /// Takes centre and scale of state and context from a batch.
    fn take_scaling(&mut self, batch: &Batch) {
        let (states, contexts) = self.scaling.split_at_mut(self.visible.state);
        for (s, scaling) in states.iter_mut().enumerate() {
            *scaling = centre_and_scale(batch.state.iter().skip(s).step_by(self.dims.state));
        }
        for (c, scaling) in contexts.iter_mut().enumerate() {
            *scaling = centre_and_scale(batch.episodes.iter().map(|episode| &episode.context[c]));
        }
    }

    /// Writes what the network sees at one moment.
    #[inline]
    fn fill(&self, obs: &[f32], state: &[f32], context: &[f32], to: &mut [f32]) {
        let (first, beside) = to.split_at_mut(self.visible.obs);
        first.copy_from_slice(obs);
        let seen = state[..self.visible.state].iter().chain(&context[..self.visible.context]);
        for ((to, x), (centre, scale)) in beside.iter_mut().zip(seen).zip(&self.scaling) {
            *to = (x - centre) / scale;
        }
    }

    fn fill_row(&self, batch: &Batch, row: usize, to: &mut [f32]) {
        let InputDims { obs, state, .. } = self.dims;
        let episode = || batch.episodes.partition_point(|episode| episode.rows.end <= row);
        // Looked for only where it is seen: there are many rows.
        let context = if self.visible.context > 0 { &batch.episodes[episode()].context[..] } else { &[] };
        self.fill(&batch.obs[row * obs..][..obs], &batch.state[row * state..][..state], context, to);
    }

    fn scale(&self) -> (f64, f64) {
        self.moments.map_or((0.0, 1.0), |(mean, square)| (mean, (square - mean * mean).max(1e-8).sqrt()))
    }

    /// V of every row, and of the state after each episode.
    pub fn predict(&mut self, batch: &Batch) -> (Vec<f32>, Vec<f32>) {
        let (mean, std) = self.scale();
        self.network.bind(&self.params, &mut self.tape);
        let width = self.network.inputs();
        let mut seen = vec![0.0; batch.rows() * width];
        for (row, to) in seen.chunks_exact_mut(width).enumerate() {
            self.fill_row(batch, row, to);
        }
        let mut last = vec![0.0; batch.episodes.len() * width];
        for (episode, to) in batch.episodes.iter().zip(last.chunks_exact_mut(width)) {
            self.fill(&episode.last_obs, &episode.last_state, &episode.context, to);
        }
        let mut run = |seen: &[f32]| {
            let mut values = Vec::with_capacity(seen.len() / width);
            for block in seen.chunks(BLOCK * width) {
                self.network.forward(block, block.len() / width, &mut self.tape);
                let (output, stride) = self.tape.output();
                values.extend(output.iter().step_by(stride).map(|&v| (mean + std * f64::from(v)) as f32));
            }
            values
        };
        (run(&seen), run(&last))
    }

    /// Moves the running moments towards those of `targets` and keeps V as it is.
    fn follow(&mut self, targets: &[f32]) {
        let n = targets.len().max(1) as f64;
        let mean = targets.iter().map(|&t| f64::from(t)).sum::<f64>() / n;
        let square = targets.iter().map(|&t| f64::from(t) * f64::from(t)).sum::<f64>() / n;
        let (old_mean, old_std) = self.scale();
        self.moments = Some(
            self.moments
                .map_or((mean, square), |(m, s)| (m + MOMENT_RATE * (mean - m), s + MOMENT_RATE * (square - s))),
        );
        let (mean, std) = self.scale();
        let (weights, bias) = self.network.last_layer();
        for w in &mut self.params[weights] {
            *w = (f64::from(*w) * old_std / std) as f32;
        }
        for b in &mut self.params[bias] {
            *b = ((old_std * f64::from(*b) + old_mean - mean) / std) as f32;
        }
    }

    /// Several epochs of Adam on the squared error. The order of rows comes from the stream of this iteration.
    pub fn fit(&mut self, batch: &Batch, targets: &[f32], progress: f64, iteration: u64) {
        let mut fit = self.begin(batch, targets, progress, iteration);
        self.fit_epochs(&mut fit, batch, targets, self.config.epochs);
    }

    pub(super) fn epochs(&self) -> usize {
        self.config.epochs
    }

    /// A fit before its first epoch. From here on V is measured by the moments of these targets.
    pub(super) fn begin(&mut self, batch: &Batch, targets: &[f32], progress: f64, iteration: u64) -> Fit {
        if self.moments.is_none() {
            self.take_scaling(batch);
        }
        self.follow(targets);
        let decay = share_left(self.config.learning_rate_final, progress);
        Fit {
            rate: vec![(self.config.learning_rate * decay) as f32; self.params.len()],
            order: (0..batch.rows() as u32).collect(),
            shuffle: stream(self.seed, Purpose::Baseline, 1, iteration),
            gradient: vec![0.0; self.params.len()],
            seen: vec![0.0; BLOCK * self.network.inputs()],
            cotangent: vec![0.0; BLOCK],
        }
    }

    /// So many epochs of a fit.
    pub(super) fn fit_epochs(&mut self, fit: &mut Fit, batch: &Batch, targets: &[f32], count: usize) {
        let (mean, std) = self.scale();
        let width = self.network.inputs();
        let Fit { rate, order, shuffle, gradient, seen, cotangent } = fit;
        for _ in 0..count {
            order.shuffle(shuffle);
            for indices in minibatches(order, self.config.minibatch_rows) {
                self.network.bind(&self.params, &mut self.tape);
                let weight = 1.0 / indices.len() as f32;
                for block in indices.chunks(BLOCK) {
                    let rows = block.len();
                    for (to, &i) in seen.chunks_exact_mut(width).zip(block) {
                        self.fill_row(batch, i as usize, to);
                    }
                    let seen = &seen[..rows * width];
                    self.network.forward(seen, rows, &mut self.tape);
                    let (output, stride) = self.tape.output();
                    for ((c, &v), &i) in cotangent.iter_mut().zip(output.iter().step_by(stride)).zip(block) {
                        let target = (f64::from(targets[i as usize]) - mean) / std;
                        *c = (v - target as f32) * weight;
                    }
                    self.network.vjp(seen, &cotangent[..rows], &mut self.tape);
                }
                gradient.fill(0.0);
                self.network.gradient(&self.tape, gradient);
                clip_norm(gradient, self.config.max_grad_norm);
                self.adam.step(&mut self.params, gradient, rate);
            }
        }
    }
}

impl Persist for MlpBaseline {
    fn exchange(&mut self, with: &mut Exchange<'_>) -> Result<(), StateError> {
        with.vector("params", &mut self.params)?;
        with.part("adam", &mut self.adam)?;
        let mut moments: Vec<f64> = self.moments.map_or_else(Vec::new, |(mean, square)| vec![mean, square]);
        with.series("moments", &mut moments)?;
        self.moments = match moments[..] {
            [] => None,
            [mean, square] => Some((mean, square)),
            _ => return Err(with.refuse("moments", moments.len() as f64, "a list of 0 or 2 numbers")),
        };
        let mut scaling: Vec<f32> = self.scaling.iter().flat_map(|&(centre, scale)| [centre, scale]).collect();
        with.vector("scaling", &mut scaling)?;
        self.scaling = scaling.chunks_exact(2).map(|pair| (pair[0], pair[1])).collect();
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::archive::Array;
    use hwasp_core::{End, Episode};

    const DIMS: InputDims = InputDims { obs: 1, state: 0, context: 0 };

    fn batch(rows: usize) -> (Batch, Vec<f32>) {
        let obs: Vec<f32> = (0..rows).map(|i| ((i * 37 % 101) as f32) / 50.0 - 1.0).collect();
        let targets = obs.iter().map(|o| -300.0 + 80.0 * o * o).collect();
        let episodes = vec![Episode {
            rows: 0..rows,
            end: End::Truncated,
            cut: false,
            last_obs: vec![0.5],
            last_state: vec![],
            context: vec![],
            log_prob: 0.0,
            outcome: None,
            terms: vec![],
        }];
        (Batch { obs, reward: vec![0.0; rows], episodes, ..Batch::default() }, targets)
    }

    #[test]
    fn learns_a_parabola_far_from_zero() {
        let (batch, targets) = batch(400);
        let config = MlpBaselineConfig { minibatch_rows: 100, epochs: 600, ..MlpBaselineConfig::default() };
        let mut baseline = MlpBaseline::new(config, DIMS, 5);
        baseline.fit(&batch, &targets, 0.0, 0);
        let (values, last) = baseline.predict(&batch);
        let worst = values.iter().zip(&targets).map(|(v, t)| (v - t).abs()).fold(0.0, f32::max);
        assert!(worst < 4.0, "{worst} off a range of 80");
        assert!((last[0] + 280.0).abs() < 4.0, "{}", last[0]);
    }

    /// Two episodes that look the same and end differently.
    #[test]
    fn sees_the_context_where_it_is_told_to() {
        let (batch, targets) = super::super::tests::two_that_look_alike();
        let worst = |context| {
            let config = MlpBaselineConfig { context, minibatch_rows: 10, epochs: 600, ..MlpBaselineConfig::default() };
            let mut baseline = MlpBaseline::new(config, InputDims { context: 1, ..DIMS }, 5);
            baseline.fit(&batch, &targets, 0.0, 0);
            let (values, last) = baseline.predict(&batch);
            let off = values.iter().zip(&targets).chain(last.iter().zip(&[10.0, -10.0])).map(|(v, t)| (v - t).abs());
            off.fold(0.0, f32::max)
        };
        assert!(worst(true) < 1.0 && worst(false) > 5.0, "{} and {}", worst(true), worst(false));
    }

    /// The message named the third moment of a state that has one or three.
    #[test]
    fn moments_that_are_no_pair_are_refused() {
        let mut baseline = MlpBaseline::new(MlpBaselineConfig::default(), DIMS, 5);
        let mut archive = baseline.save().unwrap();
        for count in [1, 3] {
            archive.insert("moments".into(), Array::F64(vec![0.5; count]));
            let told = baseline.load(&archive).unwrap_err().to_string();
            assert_eq!(told, format!("`moments` of the saved state is {count}, which is not a list of 0 or 2 numbers"));
        }
    }

    #[test]
    fn moving_the_moments_does_not_move_the_values() {
        let (batch, targets) = batch(100);
        let mut baseline = MlpBaseline::new(MlpBaselineConfig::default(), DIMS, 5);
        baseline.fit(&batch, &targets, 0.0, 0);
        let before = baseline.predict(&batch).0;
        baseline.follow(&vec![1000.0; 100]);
        for (a, b) in before.iter().zip(baseline.predict(&batch).0) {
            assert!((a - b).abs() < 1e-2, "{a} became {b}");
        }
    }
}
