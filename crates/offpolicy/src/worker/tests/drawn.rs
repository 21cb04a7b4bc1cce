//! Designs that are drawn once an episode.

use std::sync::Arc;

use hwasp_diff::Scalar;

use super::*;
use crate::learner::OffPolicy;

/// Episodes of one step, with these stiffnesses, which a controller has seen.
fn drawn_batch(drawn: &[f32], reward: &[f64]) -> Batch {
    let mut batch = Batch { reward: reward.to_vec(), ..Batch::default() };
    for (row, &drawn) in drawn.iter().enumerate() {
        let (y, next, seen) = (Y[row % 3], NEXT[row % 3], 0.5 * drawn - 1.0);
        batch.obs.extend([y, seen]);
        batch.state.push(y);
        batch.action.extend([drawn, 0.25]);
        batch.log_prob.push(0.0);
        batch.episodes.push(Episode {
            rows: row..row + 1,
            end: End::Truncated,
            cut: false,
            last_obs: vec![next, seen],
            last_state: vec![next],
            context: vec![],
            log_prob: 0.0,
            outcome: None,
            terms: vec![],
        });
    }
    batch
}

/// A stiffness that is drawn once an episode, and a controller that sees it. Each step, and what follows it, has the stiffness of its
/// episode, not that of now; critics see it in the action alone, and their slope by it is that of the mean. A candidate of a search
/// takes its place.
#[test]
fn a_drawn_design_is_held() {
    let policy = policy_with(&[], false, Placement::Episode, true);
    let dims = Dims::of(&policy);
    assert_eq!((dims.obs, dims.design, dims.action), (2, 1, 2), "y and k; k and push");
    // Of 0 to 4 N/m, which the controller sees as -0.5, 0 and 0.5.
    let drawn = [1.0_f32, 2.0, 3.0];
    let batch = drawn_batch(&drawn, &REWARD);
    let mut replay = Replay::new(dims, 100);
    replay.push(&batch, &policy.action_limits());
    let mut sample = Sample::new(dims, 3, 0, 2);
    for (r, at) in replay.step_frames().enumerate() {
        sample.take(r, &replay, at, (1, DISCOUNT), (0.0, 1.0));
    }
    // Weights of y and of the seen k, bias, and u, for which k is 3.2 N/m and seen as 0.6.
    let params = vec![0.0, 1.0, 0.0, 4.0_f32.ln()];
    sample.show_design(&policy, &params, &params);
    let rows = |moments| sample.rows(moments, &(0..3)).obs.to_vec();
    let close = |given: Vec<f32>, wanted: [f32; 6]| {
        assert!(given.iter().zip(wanted).all(|(a, b)| (a - b).abs() < 1e-6), "{given:?} instead of {wanted:?}");
    };
    close(rows(&sample.now), [Y[0], -0.5, Y[1], 0.0, Y[2], 0.5]);
    close(rows(&sample.next), [NEXT[0], -0.5, NEXT[1], 0.0, NEXT[2], 0.5]);

    let view = View::new(dims, false, false);
    assert_eq!(view.width(), 3, "y, k, push");
    let mut scene = Scene::of(Td3Config::default(), policy, &[], vec![(0.0, 0.0); 2]);
    (scene.sample, scene.params) = (sample, params);
    // Both critics say k alone.
    scene.set_critics([[0.0, 1.0, 0.0, 0.0]; 2]);
    let mut worker = scene.worker();
    worker.judge(&scene.step());
    let squares = (0..3).map(|r| (f64::from(drawn[r]) * (1.0 - DISCOUNT) - REWARD[r]).powi(2)).sum::<f64>();
    assert!((worker.squares - squares).abs() < 1e-4, "{} and {squares}", worker.squares);
    worker.improve(&scene.step());
    assert!((worker.values - drawn.iter().map(|&k| f64::from(k)).sum::<f64>()).abs() < 1e-4, "{}", worker.values);
    let mut gradient = vec![0.0; scene.params.len()];
    worker.policy_gradient(&scene.policy, &mut gradient);
    // Of k = 4·sigmoid(u) at 3.2: dk/du = 4·0.8·0.2, downhill.
    assert!((gradient[3] + 0.64).abs() < 1e-5, "{gradient:?}");

    scene.sample.show_candidate(&scene.policy, &scene.params);
    close(scene.sample.rows(&scene.sample.now, &(0..3)).obs.to_vec(), [Y[0], 0.6, Y[1], 0.6, Y[2], 0.6]);
    worker.value(&scene.step());
    assert!((worker.values - 3.0 * 3.2).abs() < 1e-4, "{}: the stiffness of now", worker.values);
}

/// Of stiffnesses of 1, 3, 3 and 1 N/m, a quarter and three quarters of the range, the higher ones earned more by twice the spread: the
/// covariance is a quarter. With a rate of 2 a new episode of a window of 4 moves the mean from the half by an eighth.
#[test]
fn a_drawn_design_follows_returns() {
    let policy = policy_with(&[], false, Placement::Episode, true);
    let params = policy.init(5, 1.0);
    let u = policy.drawn_params()[0];
    let mut learner = OffPolicy::new(Td3Config::default(), Arc::new(policy), params, 5, 2.0);
    let limits = learner.policy.action_limits();
    learner.replay.push(&drawn_batch(&[1.0, 3.0, 3.0, 1.0], &[1.0, 2.0, 2.0, 1.0]), &limits);
    let mut share = |window, new| {
        learner.follow_returns(window, new);
        f64::from(learner.learned.params[u]).sigmoid()
    };
    assert_eq!(share(5, 1), 0.5, "a window that is not full");
    let moved = share(4, 1);
    assert!((moved - 0.625).abs() < 1e-6, "{moved}");
    let short = share(4, 40);
    assert!((short - 0.98).abs() < 1e-6, "{short}: short of the limit");
}
