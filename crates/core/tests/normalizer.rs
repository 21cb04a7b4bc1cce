//! Policies whose centre and scale are running statistics: parameters that nothing learns.

#![allow(clippy::unwrap_used)] // a panic is how a test fails

mod common;

use std::sync::Arc;

use hwasp_core::{
    EpisodeKind, Episodes, Executor, HardwarePolicy, Moments, ParamKind, Placement, Policy, Purpose, Rows, Sampler,
    Serial, Threads, stream,
};

fn policy(placements: Vec<Placement>, clip: f64) -> HardwarePolicy {
    let spec = hwasp_core::PolicySpec { normalize: Some(clip), ..common::policy_spec(placements) };
    HardwarePolicy::new(spec, &common::env_spec()).unwrap()
}

/// They follow the controller's weights, so that both together are the parameters of the controller on fixed hardware; all
/// other parameters begin as they do without.
#[test]
fn centre_and_scale_are_parameters_behind_the_controller() {
    for placements in common::all_placements() {
        let (with, without) = (policy(placements.clone(), 2.0), common::policy(placements).unwrap());
        let (params, plain) = (with.init(3, 1.0), without.init(3, 1.0));
        let range = with.normalizer_params();
        assert_eq!(range, 80..86);
        assert_eq!(params[range.clone()], [0.1, 0.0, -0.2, 0.5, 1.0, 2.0]);
        assert_eq!([&params[..80], &params[86..]].concat(), plain);
        assert_eq!(with.controller_params(&params), &params[..86]);
        assert_eq!(without.controller_params(&plain), &plain[..80]);
        assert!(without.normalizer_params().is_empty());
        assert!(without.groups().iter().all(|group| group.kind != ParamKind::Normalizer));
        assert_eq!(with.design(&params), without.design(&plain));
    }
}

/// (5 - 1)/2 = 2 and (0 - 1)/0.5 = -2 are within 2, (9 - 1)/2 = 4 is not.
#[test]
fn what_is_seen_is_clipped() {
    let policy = policy(vec![Placement::Graph; 4], 2.0);
    let mut params = policy.init(3, 1.0);
    params[policy.normalizer_params()].copy_from_slice(&[1.0, 1.0, 1.0, 2.0, 0.5, 2.0]);
    let normalizer = policy.normalizer(&params);
    let mut seen = [0.0; 3];
    normalizer.apply(&[5.0, 0.0, 9.0], &mut seen);
    assert_eq!(seen, [2.0, -2.0, 2.0]);
    assert_eq!(
        (normalizer.center(), normalizer.scale(), normalizer.clip()),
        (&[1.0; 3][..], &[2.0, 0.5, 2.0][..], Some(2.0))
    );
}

/// Neither a gradient nor a tangent knows of them.
#[test]
fn nothing_learns_them() {
    for placements in common::all_placements() {
        let policy = policy(placements, 2.0);
        let params = policy.init(3, 1.0);
        let (rows, range) = (16, policy.normalizer_params());
        let (obs, state) = (common::irregular(3 * rows, 1), common::irregular(2 * rows, 2));
        let action = common::irregular(policy.action_dim() * rows, 3);
        let block = Rows { count: rows, obs: &obs, state: &state, action: &action, stride: rows };
        let mut tape = policy.tape(rows);
        policy.bind(&params, &mut tape);
        let before = policy.forward(&block, &mut tape).to_vec();
        policy.vjp(&block, &common::irregular(policy.action_dim() * rows, 4), &mut tape);
        let mut gradient = vec![f32::NAN; params.len()];
        policy.gradient(&mut tape, &mut gradient);
        assert!(gradient[range.clone()].iter().all(|&g| g == 0.0) && gradient[..80].iter().any(|&g| g != 0.0));
        let mut direction = vec![0.0; params.len()];
        direction[range.clone()].fill(1.0);
        policy.bind_tangent(&direction, &mut tape);
        assert!(policy.jvp(&block, &mut tape).iter().all(|&t| t == 0.0));
        // What was seen is in the rows, so they do not matter to an update either.
        let mut moved = params.clone();
        moved[range].fill(7.0);
        policy.bind(&moved, &mut tape);
        assert_eq!(policy.forward(&block, &mut tape), before);
    }
}

fn episodes(kind: EpisodeKind) -> Episodes {
    Episodes { seed: 11, iteration: 2, indices: 0..9, progress: 0.1, kind }
}

/// The moments of every training episode are those of the observations in its rows, in SI and not clipped. The first is checked
/// against its start; evaluations tell none, and so cannot change statistics.
#[test]
fn training_episodes_tell_what_was_observed() {
    let policy = Arc::new(policy(vec![Placement::Graph; 4], 0.1));
    let mut params = policy.init(3, 1.0);
    let sampler = Sampler::new(Arc::clone(&policy), common::make(), None);
    let batch = sampler.collect(&Serial, &params, &episodes(EpisodeKind::Training)).unwrap();
    assert!(batch.obs.iter().all(|seen| seen.abs() <= 0.1) && batch.obs.contains(&0.1));
    assert_eq!(batch.observed.len(), batch.episodes.len());
    // The point's state is its first two observations.
    for (episode, observed) in batch.episodes.iter().zip(&batch.observed) {
        let mut wanted = Moments::new(2);
        for row in episode.rows.clone() {
            wanted.push(&[0, 1].map(|j| f64::from(batch.state[2 * row + j])));
        }
        assert_eq!(observed.count, episode.rows.len() as f64);
        for j in 0..2 {
            assert!((observed.mean[j] - wanted.mean[j]).abs() < 1e-6, "{observed:?} against {wanted:?}");
            assert!((observed.squares[j] - wanted.squares[j]).abs() < 1e-5, "{observed:?} against {wanted:?}");
        }
    }
    let mut robot = common::robot(None);
    robot.reset(&mut stream(11, Purpose::TrainingReset, 2, 0));
    let mut first = [0.0; 3];
    robot.observe(&mut first);
    let once = Sampler::new(Arc::clone(&policy), common::make(), Some(1));
    let one = once.collect(&Serial, &params, &episodes(EpisodeKind::Training)).unwrap();
    assert_eq!(one.observed[0], Moments { count: 1.0, mean: first.to_vec(), squares: vec![0.0; 3] });
    // They do not depend on who gathered them, and what is seen depends on the parameters.
    let two: &dyn Executor = &Threads::new(2).unwrap();
    assert_eq!(sampler.collect(two, &params, &episodes(EpisodeKind::Training)).unwrap(), batch);
    for kind in [EpisodeKind::Evaluation, EpisodeKind::NoisyEvaluation, EpisodeKind::Deterministic] {
        assert!(sampler.collect(&Serial, &params, &episodes(kind)).unwrap().observed.is_empty());
    }
    params[policy.normalizer_params()].copy_from_slice(&[0.0, 0.0, 0.0, 100.0, 100.0, 100.0]);
    let other = sampler.collect(&Serial, &params, &episodes(EpisodeKind::Training)).unwrap();
    assert!(other.obs.iter().all(|seen| seen.abs() < 0.1));
}
