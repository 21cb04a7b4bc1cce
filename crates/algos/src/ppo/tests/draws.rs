//! The loss of a policy that draws once an episode, against arithmetic by hand, and its gradient against that of the return.

use std::ops::Range;

use hwasp_core::{End, Episode, EpisodeKind, Episodes, ParamGroup, ParamKind, Rows, Serial, gaussian};

use super::super::optimiser::RowSums;
use super::super::*;
use crate::tests::knob::{BEST, LIMITS, knob};

/// A draw with the mean m, and a command whose mean is w·o; the parameters are m, w and both log σ.
struct Pair([ParamGroup; 2]);

impl Pair {
    fn new() -> Arc<Self> {
        Arc::new(Self([
            ParamGroup { kind: ParamKind::Design, range: 0..2 },
            ParamGroup { kind: ParamKind::LogStd, range: 2..4 },
        ]))
    }
}

struct PairTape {
    params: [f32; 2],
    mean: Vec<f32>,
    gradient: [f32; 2],
}

impl Policy for Pair {
    type Tape = PairTape;

    fn param_count(&self) -> usize {
        4
    }
    fn groups(&self) -> &[ParamGroup] {
        &self.0
    }
    fn action_limits(&self) -> Vec<Option<(f32, f32)>> {
        vec![None; self.action_dim()]
    }

    fn action_dim(&self) -> usize {
        2
    }
    fn obs_dim(&self) -> usize {
        1
    }
    fn state_dim(&self) -> usize {
        0
    }
    fn context_dim(&self) -> usize {
        0
    }
    fn drawn_actions(&self) -> usize {
        1
    }
    fn log_std_params(&self) -> Option<Range<usize>> {
        Some(2..4)
    }
    fn log_std(&self, params: &[f32], _progress: f64, out: &mut [f32]) {
        out.copy_from_slice(&params[2..]);
    }
    fn tape(&self, max_rows: usize) -> PairTape {
        PairTape { params: [0.0; 2], mean: vec![0.0; 2 * max_rows], gradient: [0.0; 2] }
    }
    fn bind(&self, params: &[f32], tape: &mut PairTape) {
        (tape.params, tape.gradient) = ([params[0], params[1]], [0.0; 2]);
    }
    fn clear(&self, tape: &mut PairTape) {
        tape.gradient = [0.0; 2];
    }
    fn forward<'t>(&self, rows: &Rows<'_>, tape: &'t mut PairTape) -> &'t [f32] {
        let (draw, command) = tape.mean.split_at_mut(rows.stride.max(crate::minibatch::BLOCK));
        draw.fill(tape.params[0]);
        for (mean, o) in command.iter_mut().zip(rows.obs) {
            *mean = tape.params[1] * o;
        }
        &tape.mean
    }
    fn vjp(&self, rows: &Rows<'_>, cotangent: &[f32], tape: &mut PairTape) {
        let (draw, command) = cotangent.split_at(crate::minibatch::BLOCK);
        tape.gradient[0] += draw[..rows.count].iter().sum::<f32>();
        tape.gradient[1] += rows.obs.iter().zip(command).map(|(o, c)| o * c).sum::<f32>();
    }
    fn gradient(&self, tape: &mut PairTape, gradient: &mut [f32]) {
        gradient.copy_from_slice(&[tape.gradient[0], tape.gradient[1], 0.0, 0.0]);
    }
    fn add_cotangents(&self, tape: &mut PairTape, other: &PairTape) {
        for (to, from) in tape.gradient.iter_mut().zip(other.gradient) {
            *to += from;
        }
    }
    fn bind_tangent(&self, _tangent: &[f32], _tape: &mut PairTape) {}
    fn jvp<'t>(&self, _rows: &Rows<'_>, tape: &'t mut PairTape) -> &'t [f32] {
        &tape.mean
    }
}

/// m = 0.5, w = 1, σ = 1 of the draw and 2 of the command.
const PARAMS: [f64; 4] = [0.5, 1.0, 0.0, std::f64::consts::LN_2];
/// Rows of the three episodes.
const ROWS: [Range<usize>; 3] = [0..1, 1..3, 3..6];
const DRAW: [f64; 3] = [1.0, -0.5, 0.25];
const OBS: [f64; 6] = [1.0, 2.0, 3.0, -1.0, -2.0, 0.5];
const COMMAND: [f64; 6] = [3.0, -2.0, 4.0, 0.5, -1.0, 1.5];
/// Ratios of draws and of steps; some are beyond the clip of 0.2 on the side where it acts.
const RATIO: ([f64; 3], [f64; 6]) = ([1.5, 0.9, 0.7], [1.1, 0.5, 1.25, 0.95, 1.5, 1.0]);
const WORTH: ([f64; 3], [f64; 6]) = ([2.0, -1.0, 0.5], [1.0, -2.0, 0.5, 0.3, 3.0, -1.0]);

fn log_density(x: f64, mean: f64, log_std: f64) -> f64 {
    let z = (x - mean) * (-log_std).exp();
    -0.5 * z * z - log_std - 0.5 * gaussian::LOG_TWO_PI
}

fn episode_of(row: usize) -> usize {
    ROWS.iter().position(|rows| rows.contains(&row)).unwrap()
}

/// Log-probabilities of draws and of steps.
fn log_probs(params: [f64; 4]) -> ([f64; 3], [f64; 6]) {
    let command = |row: usize| log_density(COMMAND[row], params[1] * OBS[row], params[3]);
    (DRAW.map(|d| log_density(d, params[0], params[2])), std::array::from_fn(command))
}

/// What a learner gathers from such a batch: old log-probabilities are such that the ratios are those above.
fn gathered() -> (Batch, Vec<f32>, Draws) {
    let (draws, steps) = log_probs(PARAMS);
    let episode = |e: usize| Episode {
        rows: ROWS[e].clone(),
        end: End::Terminated,
        cut: false,
        last_obs: vec![0.0],
        last_state: vec![],
        context: vec![],
        log_prob: (draws[e] - RATIO.0[e].ln()) as f32,
        outcome: None,
        terms: vec![],
    };
    let batch = Batch {
        obs: OBS.map(|x| x as f32).to_vec(),
        action: (0..6).flat_map(|row| [DRAW[episode_of(row)] as f32, COMMAND[row] as f32]).collect(),
        log_prob: (0..6).map(|row| (steps[row] - RATIO.1[row].ln()) as f32).collect(),
        reward: vec![0.0; 6],
        episodes: (0..3).map(episode).collect(),
        ..Batch::default()
    };
    let of_rows = |value: fn(usize) -> f64, batch: &Batch| {
        let each = batch.episodes.iter().enumerate();
        each.flat_map(|(e, episode)| episode.rows.clone().map(move |_| value(e) as f32)).collect::<Vec<_>>()
    };
    let draws = Draws {
        share: of_rows(|e| 1.0 / ROWS[e].len() as f64, &batch),
        log_prob: batch.episodes.iter().flat_map(|e| vec![e.log_prob; e.rows.len()]).collect(),
        advantage: of_rows(|e| WORTH.0[e], &batch),
    };
    (batch, WORTH.1.map(|a| a as f32).to_vec(), draws)
}

/// The loss over the whole batch, each draw once: -(Σ steps + Σ draws)/6 with clipped terms, less 0.1 of the entropies, that of
/// the draw half an entropy a row as there are three draws in six rows.
fn loss(params: [f64; 4]) -> f64 {
    let (old_draws, old_steps) = log_probs(PARAMS);
    let (draws, steps) = log_probs(params);
    let term = |new: f64, old: f64, ratio: f64, worth: f64| {
        let ratio = ratio * (new - old).exp();
        (ratio * worth).min(ratio.clamp(0.8, 1.2) * worth)
    };
    let draws: f64 = (0..3).map(|e| term(draws[e], old_draws[e], RATIO.0[e], WORTH.0[e])).sum();
    let steps: f64 = (0..6).map(|row| term(steps[row], old_steps[row], RATIO.1[row], WORTH.1[row])).sum();
    -(steps + draws) / 6.0 - 0.1 * (params[3] + 0.5 * params[2])
}

fn settings() -> PpoSettings {
    let ppo = PpoConfig { entropy_coef: 0.1, normalize_advantages: false, ..PpoConfig::default() };
    PpoSettings { ppo, baseline: BaselineConfig::Linear { ridge: 1e-5, privileged: false, context: false } }
}

/// Gradient and sums of one step over these rows.
fn differentiate(rows: &[u32]) -> (Vec<f64>, RowSums) {
    let params: Vec<f32> = PARAMS.map(|p| p as f32).to_vec();
    let mut ppo = Ppo::new(&settings(), Pair::new(), params.clone(), 0);
    let (batch, advantage, draws) = gathered();
    let step = &mut ppo.optimiser.step;
    step.minibatch.gather(&batch, &advantage, rows, (1, 0, 2));
    step.minibatch.draws.gather(&draws, rows);
    let sums = step.run(&Pair::new(), &params, &ppo.optimiser.config, 0.0);
    (step.gradient.iter().map(|&g| f64::from(g)).collect(), sums)
}

fn close(found: f64, wanted: f64) {
    assert!((found - wanted).abs() < 2e-6, "{found} is not {wanted}");
}

/// Two ratios, two clips, two divergences: against central differences of the loss in double precision, with each draw
/// counted once however many rows its episode has.
#[test]
fn the_gradient_is_that_of_the_loss() {
    let (gradient, sums) = differentiate(&[0, 1, 2, 3, 4, 5]);
    for (k, found) in gradient.into_iter().enumerate() {
        let moved = |h: f64| loss(std::array::from_fn(|i| PARAMS[i] + if i == k { h } else { 0.0 }));
        close(found, (moved(1e-5) - moved(-1e-5)) / 2e-5);
    }
    let kl = |ratios: &[f64]| ratios.iter().map(|ratio| ratio - 1.0 - ratio.ln()).sum::<f64>();
    close(sums.kl, kl(&RATIO.1));
    close(sums.draws.kl, kl(&RATIO.0));
    // Of draws 1.5 with a worth of 2; of steps 0.5 with -2, 1.25 with 0.5 and 1.5 with 3.
    close(sums.draws.clipped, 1.0);
    close(sums.clipped, 3.0);
    close(sums.drawn, 3.0);
}

/// Minibatches of any rows carry their shares: with all of them of one size, their mean is the whole.
#[test]
fn minibatches_add_up() {
    let whole = differentiate(&[0, 1, 2, 3, 4, 5]).0;
    let parts = [differentiate(&[4, 0, 2]).0, differentiate(&[5, 3, 1]).0];
    for (k, whole) in whole.into_iter().enumerate() {
        close(0.5 * (parts[0][k] + parts[1][k]), whole);
    }
}

/// Divergences of draws and steps are told apart, and a policy without draws tells what it always told.
#[test]
fn draws_have_metrics_of_their_own() {
    let mut ppo = Ppo::new(&settings(), Pair::new(), PARAMS.map(|p| p as f32).to_vec(), 0);
    let metrics = ppo.update(&Serial, &gathered().0, 0.0, 0).unwrap();
    assert_eq!(ppo.metric_names(), metrics.iter().map(|(name, _)| name).collect::<Vec<_>>());
    assert!(metrics.get("design_kl").unwrap() > 0.0 && metrics.get("design_clip_fraction").is_some());
}

/// The limit of the divergence holds for draws as for steps: the epochs end where either has gone too far.
#[test]
fn epochs_end_where_draws_have_gone_too_far() {
    let mut settings = settings();
    (settings.ppo.epochs, settings.ppo.target_kl, settings.ppo.learning_rate) = (5, Some(0.4), 0.0);
    // All ratios stay as they are. The divergence of steps is 0.053, of draws 0.052: below 0.6.
    let epochs = |batch: &Batch| {
        let mut ppo = Ppo::new(&settings, Pair::new(), PARAMS.map(|p| p as f32).to_vec(), 0);
        ppo.update(&Serial, batch, 0.0, 0).unwrap().get("epochs").unwrap()
    };
    let mut batch = gathered().0;
    assert_eq!(epochs(&batch), 5.0);
    batch.episodes[0].log_prob -= 2.0;
    assert_eq!(epochs(&batch), 1.0);
}

/// The gradient of an update, in expectation, is that of the return: `J(m) = Σ_t γ^t/T·(luck - (m - best)² - σ²)`, so that
/// `dJ/dm = -2·(m - best)·Σ_t γ^t/T`, and dm/du = range·s·(1 - s) of the squash s. An update divides by its rows, of which there
/// are T in an episode. 200 batches of 50 episodes, with fixed streams: the mean is within four standard errors, which are
/// less than a twentieth of it; in 50 steps as in one. Generalised advantages would have seen (1 - (γλ)^50)/(1 - γλ) of 50
/// steps, a third of it.
#[test]
fn the_gradient_is_that_of_the_return() {
    for horizon in [1, 50] {
        let (mean, discount) = (2.0, 0.99_f64);
        let sampler = knob(horizon, mean, 0.25.into(), false);
        let policy = sampler.policy();
        let params = policy.init(1, 1.0);
        let config = PpoConfig { discount, normalize_advantages: false, ..PpoConfig::default() };
        let mut baseline = Baseline::new(&settings().baseline, InputDims::of(&**policy), 0);
        let mut optimiser = Optimiser::new(config.clone(), Arc::clone(policy), params.clone(), 0);
        let (mut sum, mut squares) = (0.0, 0.0);
        for iteration in 0..200 {
            let kind = EpisodeKind::Training;
            let asked = Episodes { seed: 2, iteration, indices: 0..50, progress: 0.0, kind };
            let batch = sampler.collect(&Serial, &params, &asked).unwrap();
            // The baseline was fitted to the batch before, so that it does not know this one.
            let targets = baseline.targets(&batch, &config.advantages(), 0).unwrap();
            baseline.fit(&batch, &targets, 0.0, 0).unwrap();
            let draws = Draws::new(&**policy, &batch, &targets, &config.advantages());
            let rows: Vec<u32> = (0..batch.rows() as u32).collect();
            let dims = (policy.obs_dim(), policy.state_dim(), policy.action_dim());
            optimiser.step.minibatch.gather(&batch, &targets.advantage, &rows, dims);
            optimiser.step.minibatch.draws.gather(&draws, &rows);
            optimiser.step.run(&**policy, &params, &config, 0.0);
            let found = -f64::from(optimiser.step.gradient[policy.design_params()][0]) * horizon as f64;
            (sum, squares) = (sum + found, squares + found * found);
        }
        let (found, n) = (sum / 200.0, 200.0);
        let error = ((squares / n - found * found) / n).sqrt();
        let discounts: f64 = (0..horizon).map(|t| discount.powi(t as i32)).sum::<f64>() / horizon as f64;
        let share = (mean - LIMITS.0) / (LIMITS.1 - LIMITS.0);
        let wanted = -2.0 * (mean - BEST) * discounts * (LIMITS.1 - LIMITS.0) * share * (1.0 - share);
        println!("{horizon} steps: {found} ± {error}, and {wanted}");
        assert!((found - wanted).abs() < 4.0 * error, "{horizon} steps: {found} ± {error} is not {wanted}");
        assert!(error < 0.05 * wanted.abs(), "{horizon} steps: {error}");
    }
}
