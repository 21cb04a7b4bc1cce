//! Actors and policies speak of the same Gaussian.

#![allow(clippy::unwrap_used)] // a panic is how a test fails

mod common;

use std::sync::Arc;

use hwasp_core::{
    EpisodeKind, Episodes, HardwarePolicy, Placement, Policy, PolicySpec, Rows, Sampler, Serial, gaussian,
};

fn episodes(indices: std::ops::Range<u64>, progress: f64, kind: EpisodeKind) -> Episodes {
    Episodes { seed: 11, iteration: 2, indices, progress, kind }
}

/// Columns from rows.
fn transposed(rows: &[f32], width: usize) -> Vec<f32> {
    (0..width).flat_map(|c| rows.iter().skip(c).step_by(width).copied()).collect()
}

/// The recorded log-probability is the density of the recorded action under the policy's own means, which it computes
/// from what is recorded: where some of the design is sampled the law has to see that sample, within its limits.
#[test]
fn log_probabilities_are_densities() {
    for placements in common::all_placements() {
        let policy = Arc::new(common::policy(placements).unwrap());
        let mut params = policy.init(5, 1.0);
        // As after some training, not as at the start.
        for (p, change) in params[policy.log_std_params().unwrap()].iter_mut().zip(common::irregular(8, 1)) {
            *p += 0.3 * change;
        }
        // Early, where designs are sampled beyond their limits, and late, where the commands' noise has changed too.
        let outside: usize = [0.1, 0.4].into_iter().map(|progress| check_log_prob(&policy, &params, progress)).sum();
        let placements = &policy.spec().placements;
        let samples = placements.contains(&Placement::Action) || placements.contains(&Placement::Episode);
        assert_eq!(outside > 0, samples, "the limits of sampled designs were not met");
    }
}

/// Returns how many design parameters were sampled outside of their limits.
fn check_log_prob(policy: &Arc<HardwarePolicy>, params: &[f32], progress: f64) -> usize {
    let sampler = Sampler::new(Arc::clone(policy), common::make(), None);
    let batch = sampler.collect(&Serial, params, &episodes(0..4, progress, EpisodeKind::Training)).unwrap();
    let rows = batch.rows();
    let state = transposed(&batch.state, policy.state_dim());
    let action = transposed(&batch.action, policy.action_dim());
    let mut tape = policy.tape(rows);
    policy.bind(params, &mut tape);
    let block = Rows { count: rows, obs: &batch.obs, state: &state, action: &action, stride: rows };
    let mean = policy.forward(&block, &mut tape);
    let log_std = log_std(policy, params, progress);
    let names = policy.space().names();
    let mut outside = 0;
    for (r, episode) in batch.episodes.iter().flat_map(|episode| episode.rows.clone().map(move |r| (r, episode))) {
        // Of what is drawn once an episode, and of what is sampled at this step.
        let mut density = [0.0; 2];
        for (j, name) in policy.action_names().iter().enumerate() {
            let (a, m, s) = (f64::from(action[j * rows + r]), f64::from(mean[j * rows + r]), f64::from(log_std[j]));
            let z = (a - m) / s.exp();
            density[usize::from(j >= policy.drawn_actions())] -= 0.5 * z * z + s + 0.5 * gaussian::LOG_TWO_PI;
            if let Some(i) = names.iter().position(|n| n == name) {
                let (lo, hi) = policy.space().bounds(i);
                outside += usize::from(!(lo..=hi).contains(&a));
            }
        }
        for (recorded, density) in [episode.log_prob, batch.log_prob[r]].into_iter().zip(density) {
            let off = f64::from(recorded) - density;
            assert!(off.abs() < 1e-3, "{recorded} against {density}, {:?}", policy.spec().placements);
        }
    }
    outside
}

/// Without noise the action is the mean, whatever the standard deviation.
#[test]
fn evaluation_is_deterministic() {
    let policy = Arc::new(common::policy(vec![Placement::Graph; 4]).unwrap());
    let mut params = policy.init(5, 1.0);
    let sampler = Sampler::new(Arc::clone(&policy), common::make(), None);
    let quiet = episodes(0..2, 0.0, EpisodeKind::Evaluation);
    let before = sampler.collect(&Serial, &params, &quiet).unwrap();
    params[policy.log_std_params().unwrap()].fill(1.0);
    let after = sampler.collect(&Serial, &params, &quiet).unwrap();
    assert_eq!((&before.obs, &before.action, &before.reward), (&after.obs, &after.action, &after.reward));
    assert_ne!(before.log_prob, after.log_prob);
    let noisy = episodes(0..2, 0.0, EpisodeKind::NoisyEvaluation);
    let noisy = sampler.collect(&Serial, &params, &noisy).unwrap();
    assert_eq!(before.obs[..3], noisy.obs[..3], "the same held-out starts");
    assert_ne!(before.action, noisy.action);
}

fn log_std(policy: &HardwarePolicy, params: &[f32], progress: f64) -> Vec<f32> {
    let mut out = vec![f32::NAN; policy.action_dim()];
    policy.log_std(params, progress, &mut out);
    out
}

/// The winch's noise: design 0.4 of its range, falling to a tenth in the first half; efforts 2; commands 0.3 and 0.2
/// of their range, falling to a hundredth between a quarter and three quarters.
#[test]
fn noise_follows_its_schedule() {
    use Placement::{Action, Fixed, Graph};
    let mut spec = common::policy_spec(vec![Fixed(1.0), Action, Action, Graph]);
    for train in [true, false] {
        spec.noise.train = train;
        let policy = HardwarePolicy::new(spec.clone(), &common::env_spec()).unwrap();
        let params = policy.init(0, 1.0);
        assert_eq!(policy.log_std_params().is_some(), train);
        // Ranges: gear 2.5, spring 8; commands 2 and 6.
        let start = [0.4 * 2.5, 0.4 * 8.0, 2.0, 2.0, 0.3 * 2.0, 0.2 * 6.0];
        for (progress, design, command) in
            [(0.0, 1.0, 1.0), (0.125, 0.1_f64.powf(0.25), 1.0), (0.5, 0.1, 0.1), (0.75, 0.1, 0.01), (1.0, 0.1, 0.01)]
        {
            let factor = [design, design, 1.0, 1.0, command, command];
            let sizes = policy.noise_sizes(&params, progress);
            let wanted = [0.4 * design, 2.0, 0.25 * command];
            for (size, wanted) in [sizes.design, sizes.effort, sizes.command].into_iter().zip(wanted) {
                assert!((size - wanted).abs() < 1e-6 * wanted, "{progress}: {sizes:?}");
            }
            for (j, log_std) in log_std(&policy, &params, progress).into_iter().enumerate() {
                let wanted = (start[j] * factor[j]).ln();
                assert!((f64::from(log_std) - wanted).abs() < 1e-6, "{progress} {j}: {log_std} against {wanted}");
            }
        }
    }
}

/// An action of commands alone has no noise of another kind, and commands whose spread the controller tells have no one size.
#[test]
fn what_the_action_has_not_has_no_noise() {
    let sizes = |state_dependent_std| {
        let spec = PolicySpec { state_dependent_std, ..common::policy_spec(vec![Placement::Fixed(1.0); 4]) };
        let policy = HardwarePolicy::new(spec, &common::env_spec()).unwrap();
        policy.noise_sizes(&policy.init(0, 1.0), 0.0)
    };
    let plain = sizes(false);
    assert!((plain.command - 0.25).abs() < 1e-6 && plain.effort.is_nan() && plain.design.is_nan(), "{plain:?}");
    assert!(sizes(true).command.is_nan());
}

/// What was learned is added to the schedule.
#[test]
fn trained_noise_keeps_its_schedule() {
    let policy = common::policy(vec![Placement::Action; 4]).unwrap();
    let mut params = policy.init(0, 1.0);
    let before = [log_std(&policy, &params, 0.0), log_std(&policy, &params, 1.0)].concat();
    for p in &mut params[policy.log_std_params().unwrap()] {
        *p += 0.25;
    }
    let after = [log_std(&policy, &params, 0.0), log_std(&policy, &params, 1.0)].concat();
    for (before, after) in before.iter().zip(&after) {
        assert!((after - before - 0.25).abs() < 1e-6);
    }
}
