//! What learners need on robots that nobody has scaled by hand: running statistics, and iterations that are counted in steps.

#![allow(clippy::unwrap_used)] // a panic is how a test fails

use hwasp_core::{Batch, EpisodeKind, Episodes, Policy, Sampler, Serial};
use hwasp_testing::{UNSCALED, layers, resolve, run, small};
use hwasp_training::{Assembly, Checkpoint, beginning, evaluate, params_at};

/// Running statistics of observations on the reach problem, whose iterations have 40 episodes of 30 steps.
const NORMALIZED: &[(&str, &str)] = &[
    ("controller.observation_center", "[0.0]"),
    ("controller.observation_scale", "[1.0]"),
    ("controller.normalize_observations", "true"),
];

fn normalizer(assembly: &Assembly, checkpoint: &Checkpoint) -> Vec<f32> {
    params_at(assembly, checkpoint).unwrap()[assembly.policy.normalizer_params()].to_vec()
}

/// The episodes of an iteration, as these parameters act in them.
fn batch(assembly: &Assembly, iteration: u64, params: &[f32], progress: f64) -> Batch {
    let spec = assembly.experiment();
    let make = assembly.worlds.training.make.clone();
    let sampler = Sampler::new(assembly.policy.clone(), make, Some(spec.train.episode_steps));
    let asked = Episodes { seed: spec.seed, iteration, indices: 0..40, progress, kind: EpisodeKind::Training };
    sampler.collect(&Serial, params, &asked).unwrap()
}

/// Centre and scale after two iterations, from the observations of both by hand. The first saw them as they are; what the second
/// saw is turned back by the centre and scale of the first.
#[test]
fn the_statistics_are_those_of_all_observations_so_far() {
    let assembly = Assembly::new(&small("hwasp", NORMALIZED)).unwrap();
    let (_, kept) = run(&assembly, None, 1);
    let first = batch(&assembly, 0, &assembly.init(), 0.0);
    let mut seen: Vec<f64> = first.obs.iter().map(|&o| f64::from(o)).collect();
    for (iteration, checkpoint) in kept.checkpoints[..2].iter().enumerate() {
        let n = seen.len() as f64;
        assert_eq!(n, 1200.0 * (iteration + 1) as f64);
        let mean = seen.iter().sum::<f64>() / n;
        let std = (seen.iter().map(|o| (o - mean).powi(2)).sum::<f64>() / n + 1e-8).sqrt();
        let found = normalizer(&assembly, checkpoint);
        assert!((f64::from(found[0]) - mean).abs() < 1e-6 && (f64::from(found[1]) - std).abs() < 1e-6, "{found:?}");
        assert!(std < 0.9 && mean.abs() > 0.01, "nothing was to be done: {mean} {std}");
        let progress = assembly.experiment().train.progress(checkpoint.env_steps);
        let next = batch(&assembly, 1, &params_at(&assembly, checkpoint).unwrap(), progress);
        seen.extend(next.obs.iter().map(|&o| f64::from(o) * f64::from(found[1]) + f64::from(found[0])));
    }
}

/// Evaluations, in which the observations are others, use the statistics of training as they are.
#[test]
fn evaluation_leaves_the_statistics_alone() {
    let assembly = Assembly::new(&small("hwasp", UNSCALED)).unwrap();
    let (trained, kept) = run(&assembly, None, 1);
    let last = kept.checkpoints.last().unwrap();
    let before = normalizer(&assembly, last);
    assert_eq!(trained.params[assembly.policy.normalizer_params()], before);
    let asked = (trained.evaluation.episodes, trained.evaluation.seed);
    for _ in 0..2 {
        assert_eq!(evaluate(&assembly, &trained.params, asked, &Serial).unwrap(), trained.evaluation);
    }
    assert_eq!(normalizer(&assembly, last), before);
}

/// What is told is what the task gives: the first iteration, whose policy has learned nothing, has the same returns, and then the
/// learners part.
#[test]
fn scaled_rewards_are_for_the_learner_alone() {
    let rows = |settings| run(&Assembly::new(&small("hwasp", settings)).unwrap(), None, 1).1.rows;
    let (plain, scaled) = (rows(&[]), rows(&[("train.reward_scaling", "true")]));
    let told = |rows: &[hwasp_training::MetricsRow], i: usize| (rows[i].discounted_return, rows[i].undiscounted_return);
    assert_eq!(told(&plain, 0), told(&scaled, 0));
    assert_ne!(told(&plain, 1), told(&scaled, 1));
}

/// Iterations of exactly 1000 steps in 7 lanes of 142 or 143: four episodes of 30 steps and one that is cut in each. The budget of
/// 9600 is spent to the step, 600 in the last iteration.
#[test]
fn iterations_may_be_counted_in_steps() {
    let assembly = Assembly::new(&small("hwasp", UNSCALED)).unwrap();
    assert_eq!((assembly.iterations(), assembly.piece().env_steps), ((10, 600), 1));
    let (trained, kept) = run(&assembly, None, 1);
    let steps: Vec<u64> = kept.rows.iter().map(|row| row.env_steps).collect();
    assert_eq!(steps, [1000, 2000, 3000, 4000, 5000, 6000, 7000, 8000, 9000, 9600]);
    assert_eq!((trained.env_steps, trained.iterations), (9600, 10));
    assert!(kept.rows.iter().all(|row| row.undiscounted_return.is_finite()));
    // Those that are cut do not count; in 85 or 86 steps there are two whole ones.
    let ended: Vec<(f64, f64)> = kept.rows.iter().map(|row| (row.episodes, row.episode_steps)).collect();
    assert_eq!(ended, [[(28.0, 30.0); 9].as_slice(), &[(14.0, 30.0)]].concat());
    assert!(kept.rows.iter().all(|row| row.noise.command > 0.0));
    for (given, taken, iterations, last) in
        [("1000", 1000, 1, 1000), ("1499", 1499, 1, 1499), ("1500", 1500, 2, 500), ("2501", 2501, 3, 501)]
    {
        let layers = UNSCALED.iter().fold(layers("reach"), |layers, (k, v)| layers.with_override(k, v));
        let layers = layers.with_override("train.env_steps", given).with_override("train.evaluation_episodes", "4");
        let assembly = Assembly::new(&resolve(layers, None).unwrap()).unwrap();
        let trained = run(&assembly, None, 1).0;
        assert_eq!((trained.env_steps, trained.iterations), (taken, iterations), "{given}");
        assert_eq!(assembly.iterations(), (iterations, last), "{given}");
    }
}

/// Lanes of 20 steps never see the end of an episode of 30: there is no return to tell, and no number in its place. What is
/// resumed goes on without it.
#[test]
fn where_no_episode_ends_there_is_no_return() {
    let settings = &[("train.steps_per_iteration", "1200"), ("train.episodes_per_iteration", "60")];
    let assembly = Assembly::new(&small("hwasp", settings)).unwrap();
    assert_eq!(assembly.experiment().train.short_lanes(), Some(20));
    let (trained, kept) = run(&assembly, None, 1);
    assert!(kept.rows.len() == 8 && kept.rows.iter().all(|row| row.undiscounted_return.is_nan()));
    assert!(kept.rows.iter().all(|row| row.episodes == 0.0 && row.episode_steps.is_nan()));
    assert!(trained.training_return.is_nan() && trained.evaluation.undiscounted_return.mean.is_finite());
    assert!(kept.checkpoints.iter().all(|checkpoint| checkpoint.training_return.is_none()));
    let resumed = run(&assembly, Some(&kept.checkpoints[2]), 2).0;
    assert_eq!(resumed.params, trained.params);
}

/// A training that goes on with the parameters of another one begins with its statistics, and each further row counts as one
/// of all: after one iteration they have hardly moved.
#[test]
fn further_training_goes_on_with_the_statistics() {
    let assembly = Assembly::new(&small("hwasp", NORMALIZED)).unwrap();
    let mut params = assembly.init();
    let range = assembly.policy.normalizer_params();
    params[range.clone()].copy_from_slice(&[0.2, 0.05]);
    let start = beginning(&assembly, params, 1_000_000).unwrap();
    assert_eq!(normalizer(&assembly, &start), [0.2, 0.05]);
    let (_, kept) = run(&assembly, Some(&start), 1);
    let after = normalizer(&assembly, &kept.checkpoints[0]);
    assert!(after != [0.2, 0.05] && (after[0] - 0.2).abs() < 1e-3 && (after[1] - 0.05).abs() < 0.01, "{after:?}");
}

/// The bar of `train.rs` for the same problem with everything on.
#[test]
fn what_nobody_has_scaled_is_learned() {
    for seed in ["0", "1", "2"] {
        let layers = UNSCALED.iter().fold(layers("reach"), |layers, (k, v)| layers.with_override(k, v));
        let layers = layers.with_override("seed", seed).with_override("train.evaluation_episodes", "20");
        let assembly = Assembly::new(&resolve(layers, None).unwrap()).unwrap();
        assert_eq!(assembly.policy.param_count(), assembly.init().len());
        let trained = run(&assembly, None, 1).0;
        let gear = assembly.policy.design(&trained.params)[0];
        let mean = trained.evaluation.discounted_return.mean;
        println!("seed {seed}: gear {gear}, {mean}");
        assert!((gear - 1.0).abs() < 0.15 && mean > -3.0, "seed {seed}: gear {gear}, {mean}");
    }
}
