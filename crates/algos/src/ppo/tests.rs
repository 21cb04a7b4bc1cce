//! PPO's loss, gradient and metrics against arithmetic by hand.

mod draws;

use std::ops::Range;

use hwasp_core::{End, Episode, ParamGroup, ParamKind, Rows, Serial, gaussian};

use super::optimiser::RowSums;
use super::*;

/// One command whose mean is w·o; the parameters are w and log σ.
struct Line([ParamGroup; 2]);

impl Line {
    fn new() -> Arc<Self> {
        Arc::new(Self([
            ParamGroup { kind: ParamKind::Design, range: 0..1 },
            ParamGroup { kind: ParamKind::LogStd, range: 1..2 },
        ]))
    }
}

struct LineTape {
    w: f32,
    mean: Vec<f32>,
    gradient: f32,
}

impl Policy for Line {
    type Tape = LineTape;

    fn param_count(&self) -> usize {
        2
    }
    fn groups(&self) -> &[ParamGroup] {
        &self.0
    }
    fn action_limits(&self) -> Vec<Option<(f32, f32)>> {
        vec![None; self.action_dim()]
    }

    fn action_dim(&self) -> usize {
        1
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
    fn log_std_params(&self) -> Option<Range<usize>> {
        Some(1..2)
    }
    fn log_std(&self, params: &[f32], _progress: f64, out: &mut [f32]) {
        out[0] = params[1];
    }
    fn tape(&self, max_rows: usize) -> LineTape {
        LineTape { w: 0.0, mean: vec![0.0; max_rows], gradient: 0.0 }
    }
    fn bind(&self, params: &[f32], tape: &mut LineTape) {
        (tape.w, tape.gradient) = (params[0], 0.0);
    }
    fn clear(&self, tape: &mut LineTape) {
        tape.gradient = 0.0;
    }
    fn forward<'t>(&self, rows: &Rows<'_>, tape: &'t mut LineTape) -> &'t [f32] {
        for (mean, o) in tape.mean.iter_mut().zip(rows.obs) {
            *mean = tape.w * o;
        }
        &tape.mean
    }
    fn vjp(&self, rows: &Rows<'_>, cotangent: &[f32], tape: &mut LineTape) {
        tape.gradient += rows.obs.iter().zip(cotangent).map(|(o, c)| o * c).sum::<f32>();
    }
    fn gradient(&self, tape: &mut LineTape, gradient: &mut [f32]) {
        gradient.copy_from_slice(&[tape.gradient, 0.0]);
    }
    fn add_cotangents(&self, tape: &mut LineTape, other: &LineTape) {
        tape.gradient += other.gradient;
    }
    fn bind_tangent(&self, _tangent: &[f32], _tape: &mut LineTape) {}
    fn jvp<'t>(&self, _rows: &Rows<'_>, tape: &'t mut LineTape) -> &'t [f32] {
        &tape.mean
    }
}

/// w = 1 and σ = 2.
fn params() -> Vec<f32> {
    vec![1.0, std::f32::consts::LN_2]
}

const OBS: [f64; 3] = [1.0, 2.0, 3.0];
/// With means 1, 2 and 3 these are z = 1, -2 and 1/2.
const ACTION: [f64; 3] = [3.0, -2.0, 4.0];

fn log_prob(i: usize, w: f64, log_std: f64) -> f64 {
    let z = (ACTION[i] - w * OBS[i]) * (-log_std).exp();
    -0.5 * z * z - log_std - 0.5 * gaussian::LOG_TWO_PI
}

/// Three episodes of one step, so that with a baseline of zero the advantage is the reward; the old probabilities are such
/// that the ratios are those given.
fn batch(ratio: [f64; 3], advantage: [f64; 3]) -> Batch {
    let old = |i: usize| (log_prob(i, 1.0, std::f64::consts::LN_2) - ratio[i].ln()) as f32;
    Batch {
        obs: OBS.map(|x| x as f32).to_vec(),
        state: vec![],
        action: ACTION.map(|x| x as f32).to_vec(),
        log_prob: (0..3).map(old).collect(),
        reward: advantage.to_vec(),
        episodes: (0..3)
            .map(|i| Episode {
                rows: i..i + 1,
                end: End::Terminated,
                cut: false,
                last_obs: vec![0.0],
                last_state: vec![],
                context: vec![],
                log_prob: 0.0,
                outcome: None,
                terms: vec![],
            })
            .collect(),
        ..Batch::default()
    }
}

fn settings() -> PpoSettings {
    let ppo = PpoConfig {
        clip_ratio: 0.2,
        epochs: 1,
        minibatch_rows: 0,
        learning_rate: 0.01,
        log_std_lr_scale: 0.5,
        design_lr_scale: 10.0,
        adam_epsilon: 0.0,
        entropy_coef: 0.1,
        max_grad_norm: None,
        normalize_advantages: false,
        ..PpoConfig::default()
    };
    PpoSettings { ppo, baseline: BaselineConfig::Linear { ridge: 1e-5, privileged: false, context: false } }
}

/// Gradient of w and log σ, KL and clipped rows of one step over the whole batch, and the cotangents of the means.
fn differentiate(batch: &Batch) -> ([f32; 2], RowSums, [f32; 3]) {
    let mut ppo = Ppo::new(&settings(), Line::new(), params(), 0);
    let advantage: Vec<f32> = batch.reward.iter().map(|&r| r as f32).collect();
    ppo.optimiser.step.minibatch.gather(batch, &advantage, &[0, 1, 2], (1, 0, 1));
    let sums = ppo.optimiser.step.run(&Line::new(), &params(), &ppo.optimiser.config, 0.0);
    let mut cotangent = [0.0; 3];
    cotangent.copy_from_slice(&ppo.optimiser.step.cotangent[..3]);
    ([ppo.optimiser.step.gradient[0], ppo.optimiser.step.gradient[1]], sums, cotangent)
}

/// -mean[min(ρ·A, clip(ρ, 0.8, 1.2)·A)] - 0.1·H, written down independently.
fn loss(batch: &Batch, w: f64, log_std: f64) -> f64 {
    let term = |i: usize| {
        let ratio = (log_prob(i, w, log_std) - f64::from(batch.log_prob[i])).exp();
        (ratio * batch.reward[i]).min(ratio.clamp(0.8, 1.2) * batch.reward[i])
    };
    let entropy = log_std + 0.5 * (1.0 + gaussian::LOG_TWO_PI);
    -(0..3).map(term).sum::<f64>() / 3.0 - 0.1 * entropy
}

fn close(found: impl Into<f64>, wanted: f64) {
    let found = found.into();
    assert!((found - wanted).abs() < 2e-6, "{found} is not {wanted}");
}

/// The gradient against central differences of the loss.
fn check_against_loss(batch: &Batch) {
    let (gradient, _, _) = differentiate(batch);
    let (s, h) = (std::f64::consts::LN_2, 1e-5);
    close(gradient[0], (loss(batch, 1.0 + h, s) - loss(batch, 1.0 - h, s)) / (2.0 * h));
    close(gradient[1], (loss(batch, 1.0, s + h) - loss(batch, 1.0, s - h)) / (2.0 * h));
}

/// Ratios 1.5, 0.5 and 1.25 with advantages 2, 1 and -1, clip 0.2:
///   1: min(3, 1.2·2): clipped, no gradient
///   2: min(0.5, 0.8): below the clip, but where the surrogate is the smaller one, so it pulls:
///      d loss/d log p = -1/3·0.5·1 = -1/6
///   3: min(-1.25, -1.2): above the clip, and pulls as well: -1/3·1.25·(-1) = 5/12
/// d log p/d mean = z/σ, d log p/d log σ = z² - 1, with z = 1, -2, 1/2 and σ = 2:
///   cotangents of the means: 0, -1/6·(-1) = 1/6, 5/12·1/4 = 5/48
///   of log σ: -1/6·3 + 5/12·(-3/4) = -13/16, less 0.1 for the entropy
///   of w: 1/6·2 + 5/48·3 = 31/48
/// KL: Σ ρ - 1 - ln ρ = 0.5 - 0.5 + 0.25 - ln(1.5·0.5·1.25) = 1/4 - ln(15/16)
/// Loss without entropy: -(2.4 + 0.5 - 1.25)/3 = -0.55
fn first() -> Batch {
    batch([1.5, 0.5, 1.25], [2.0, 1.0, -1.0])
}

#[test]
fn three_samples_by_hand() {
    let (gradient, sums, cotangent) = differentiate(&first());
    for (found, wanted) in cotangent.into_iter().zip([0.0, 1.0 / 6.0, 5.0 / 48.0]) {
        close(found, wanted);
    }
    close(gradient[0], 31.0 / 48.0);
    close(gradient[1], -13.0 / 16.0 - 0.1);
    close(sums.kl, 0.25 - (15.0_f64 / 16.0).ln());
    assert_eq!((sums.clipped, sums.rows), (1.0, 3));
    let entropy = std::f64::consts::LN_2 + 0.5 * (1.0 + gaussian::LOG_TWO_PI);
    close(loss(&first(), 1.0, std::f64::consts::LN_2) + 0.1 * entropy, -0.55);
    check_against_loss(&first());
}

/// Ratios 0.5, 1.1 and 0.9 with advantages -1, -2 and 3: only the first is clipped (max of -0.5 and -0.8 in size), and
///   d loss/d log p = 0, 1/3·1.1·2 = 11/15, -1/3·0.9·3 = -9/10
///   cotangents of the means: 0, 11/15·(-1) = -11/15, -9/10·1/4 = -9/40
///   of log σ: 11/15·3 - 9/10·(-3/4) = 23/8, less 0.1
///   of w: -11/15·2 - 9/40·3 = -257/120 (-22/15 = -176/120, -27/40 = -81/120)
#[test]
fn negative_advantages_are_clipped_below() {
    let batch = batch([0.5, 1.1, 0.9], [-1.0, -2.0, 3.0]);
    let (gradient, sums, cotangent) = differentiate(&batch);
    for (found, wanted) in cotangent.into_iter().zip([0.0, -11.0 / 15.0, -9.0 / 40.0]) {
        close(found, wanted);
    }
    close(gradient[0], -257.0 / 120.0);
    close(gradient[1], 23.0 / 8.0 - 0.1);
    assert_eq!(sums.clipped, 1.0);
    check_against_loss(&batch);
}

/// The bounds are where they should be: of 1.21, 1.19 and 0.79 with advantages 1, 1 and -1 the outer two are clipped; of
/// 0.79, 1.21 and 0.81 with 1, -1 and -1 none is.
#[test]
fn the_clip_acts_at_its_bounds() {
    assert_eq!(differentiate(&batch([1.21, 1.19, 0.79], [1.0, 1.0, -1.0])).1.clipped, 2.0);
    assert_eq!(differentiate(&batch([0.79, 1.21, 0.81], [1.0, -1.0, -1.0])).1.clipped, 0.0);
}

/// The first step of Adam without epsilon is the learning rate against the sign of the gradient: w has ten times 0.01 of
/// it, log σ half.
#[test]
fn one_update_by_hand() {
    let mut ppo = Ppo::new(&settings(), Line::new(), params(), 0);
    let metrics = ppo.update(&Serial, &first(), 0.0, 0).unwrap();
    let told = |name| metrics.get(name).unwrap();
    close(ppo.params()[0], 1.0 - 0.1);
    close(ppo.params()[1], std::f64::consts::LN_2 + 0.005);
    close(told("kl"), (0.25 - (15.0_f64 / 16.0).ln()) / 3.0);
    close(told("clip_fraction"), 1.0 / 3.0);
    close(told("grad_norm"), (31.0_f64 / 48.0).hypot(13.0 / 16.0 + 0.1));
    close(told("entropy"), std::f64::consts::LN_2 + 0.005 + 0.5 * (1.0 + gaussian::LOG_TWO_PI));
    close(told("epochs"), 1.0);
}

/// The rate falls linearly to its final fraction: to 0.01·(1 - 0.8·0.5) in the middle.
#[test]
fn the_learning_rate_decays() {
    let mut settings = settings();
    settings.ppo.learning_rate_final = 0.2;
    let mut ppo = Ppo::new(&settings, Line::new(), params(), 0);
    ppo.update(&Serial, &first(), 0.5, 0).unwrap();
    close(ppo.params()[0], 1.0 - 0.06);
}

/// To nothing at the end: the last update of a training moves no parameter, and breaks none.
#[test]
fn a_rate_of_nothing_moves_nothing() {
    let mut settings = settings();
    settings.ppo.learning_rate_final = 0.0;
    let mut ppo = Ppo::new(&settings, Line::new(), params(), 0);
    ppo.update(&Serial, &first(), 1.0, 0).unwrap();
    assert_eq!(ppo.params(), params());
}

/// An epoch whose advantages are computed anew is the first epoch of another update: the baseline learns after the one and is
/// what the other begins with.
#[test]
fn advantages_of_later_epochs_come_from_the_fitted_baseline() {
    let after = |recompute_advantages, epochs, updates| {
        let mut settings = settings();
        (settings.ppo.recompute_advantages, settings.ppo.epochs) = (recompute_advantages, epochs);
        let mut ppo = Ppo::new(&settings, Line::new(), params(), 0);
        for _ in 0..updates {
            ppo.update(&Serial, &first(), 0.0, 0).unwrap();
        }
        ppo.save().unwrap()
    };
    assert_eq!(after(true, 3, 1), after(false, 1, 3));
    assert_ne!(after(true, 3, 1), after(false, 3, 1));
}

/// The limit on the divergence ends the epochs of the policy. The baseline has as many as ever, and where none of the policy's
/// follows they are those that it has without.
#[test]
fn the_baseline_has_its_epochs_where_those_of_the_policy_end() {
    let after = |recompute_advantages| {
        let mlp = crate::baseline::MlpBaselineConfig { epochs: 7, ..crate::baseline::MlpBaselineConfig::default() };
        let mut settings = PpoSettings { baseline: BaselineConfig::Mlp(mlp), ..settings() };
        (settings.ppo.epochs, settings.ppo.target_kl) = (5, Some(1e-9));
        settings.ppo.recompute_advantages = recompute_advantages;
        let mut ppo = Ppo::new(&settings, Line::new(), params(), 0);
        close(ppo.update(&Serial, &first(), 0.0, 0).unwrap().get("epochs").unwrap(), 1.0);
        ppo.save().unwrap()
    };
    assert_eq!(after(true), after(false));
}

/// The second epoch ends the update where the first has moved the policy too far, and only there.
#[test]
fn epochs_end_at_the_kl_limit() {
    let epochs = |target_kl| {
        let mut settings = settings();
        (settings.ppo.epochs, settings.ppo.target_kl) = (5, target_kl);
        let mut ppo = Ppo::new(&settings, Line::new(), params(), 0);
        ppo.update(&Serial, &first(), 0.0, 0).unwrap().get("epochs").unwrap()
    };
    // In the first epoch the estimate is 0.1048, and 1.5 times the limit is what counts.
    close(epochs(Some(0.0698)), 1.0);
    assert!(epochs(Some(0.0701)) > 1.0);
    close(epochs(None), 5.0);
}

/// A minibatch weighs each of its rows by its own size, and all rows of a batch are seen once per epoch.
#[test]
fn minibatches_cover_the_batch() {
    let mut settings = settings();
    (settings.ppo.minibatch_rows, settings.ppo.learning_rate) = (2, 0.0);
    let mut ppo = Ppo::new(&settings, Line::new(), params(), 0);
    let metrics = ppo.update(&Serial, &first(), 0.0, 0).unwrap();
    let told = |name| metrics.get(name).unwrap();
    close(told("kl"), (0.25 - (15.0_f64 / 16.0).ln()) / 3.0);
    close(told("clip_fraction"), 1.0 / 3.0);
    assert_eq!(ppo.params(), params());
}

/// After an error nothing has changed: a further update is what it would have been.
#[test]
fn numbers_that_are_none_change_nothing() {
    let mut twin = Ppo::new(&settings(), Line::new(), params(), 0);
    twin.update(&Serial, &first(), 0.0, 0).unwrap();
    let mut ppo = Ppo::new(&settings(), Line::new(), params(), 0);
    ppo.update(&Serial, &first(), 0.0, 0).unwrap();
    let (mut reward, mut old, mut action) = (first(), first(), first());
    reward.reward[1] = f64::NAN;
    old.log_prob[1] = f32::NAN;
    action.action[1] = f32::INFINITY;
    for (batch, what) in [(reward, "an advantage"), (old, "the policy gradient"), (action, "the policy gradient")] {
        let before = ppo.params().to_vec();
        let error = ppo.update(&Serial, &batch, 0.0, 7).unwrap_err();
        assert_eq!(error, LearnError::NotFinite { what, iteration: 7 });
        assert_eq!(
            error.to_string(),
            format!("{what} is not finite in iteration 7; the parameters before it were kept")
        );
        assert_eq!(ppo.params(), before);
    }
    assert_eq!(ppo.update(&Serial, &first(), 0.0, 1).unwrap(), twin.update(&Serial, &first(), 0.0, 1).unwrap());
    assert_eq!(ppo.params(), twin.params());
}

/// The same where minibatches before the bad one have moved parameters and optimiser.
#[test]
fn an_update_that_fails_half_way_is_undone() {
    let mut settings = settings();
    settings.ppo.minibatch_rows = 1;
    let mut bad = first();
    bad.action[1] = f32::NAN;
    let mut twin = Ppo::new(&settings, Line::new(), params(), 0);
    let mut ppo = Ppo::new(&settings, Line::new(), params(), 0);
    // In some of the orders the bad row is not the first.
    for iteration in 0..8 {
        ppo.update(&Serial, &bad, 0.0, iteration).unwrap_err();
    }
    for iteration in 0..2 {
        twin.update(&Serial, &first(), 0.0, iteration).unwrap();
        ppo.update(&Serial, &first(), 0.0, iteration).unwrap();
    }
    assert_eq!(ppo.params(), twin.params());
}

/// Saved after an update and taken up by a fresh learner, with either baseline.
#[test]
fn resumes_bit_for_bit() {
    let mlp = BaselineConfig::Mlp(crate::baseline::MlpBaselineConfig::default());
    for (baseline, recompute) in [(settings().baseline, false), (mlp.clone(), false), (mlp, true)] {
        let mut settings = PpoSettings { baseline, ..settings() };
        (settings.ppo.recompute_advantages, settings.ppo.epochs) = (recompute, 3);
        let mut whole = Ppo::new(&settings, Line::new(), params(), 0);
        whole.update(&Serial, &first(), 0.0, 0).unwrap();
        let mut resumed = Ppo::new(&settings, Line::new(), vec![0.0; 2], 0);
        resumed.load(&whole.save().unwrap()).unwrap();
        for learner in [&mut whole, &mut resumed] {
            learner.update(&Serial, &first(), 0.5, 1).unwrap();
        }
        assert_eq!(resumed.save().unwrap(), whole.save().unwrap());
    }
}
