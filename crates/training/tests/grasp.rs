//! The hand from an experiment file to a trained controller.

#![allow(clippy::unwrap_used)] // a panic is how a test fails

use std::sync::atomic::AtomicBool;

use hwasp_core::{Serial, Threads};
use hwasp_training::{Assembly, Trained, evaluate, evaluate_native, train};

/// A small training: 60 steps an episode, of one shape.
fn assembly(experiment: &str, method: &str, settings: &[(&str, &str)]) -> Assembly {
    let small = [
        ("task.horizon", "60"),
        ("task.shapes", "[\"sphere\"]"),
        ("task.size", "\"60 mm\""),
        ("task.height", "\"100 mm\""),
        ("controller.hidden", "[16]"),
        ("controller.output_gain", "0.1"),
        ("train.episode_steps", "60"),
        ("train.episodes_per_iteration", "8"),
        ("train.env_steps", "960"),
        ("train.evaluation_episodes", "8"),
        ("ppo.minibatch_rows", "60"),
        ("baseline.minibatch_rows", "60"),
    ];
    let layers = hwasp_testing::layers(experiment);
    let layers = small.iter().chain(settings).fold(layers, |layers, (key, value)| layers.with_override(key, value));
    Assembly::new(&hwasp_testing::resolve(layers, Some(method)).unwrap()).unwrap()
}

fn run(assembly: &Assembly, threads: usize) -> Trained {
    let stop = AtomicBool::new(false);
    match threads {
        1 => train(assembly, &Serial, &mut (), &stop),
        n => train(assembly, &Threads::new(n).unwrap(), &mut (), &stop),
    }
    .unwrap()
}

#[test]
fn every_method_runs_and_threads_change_nothing() {
    for experiment in ["z-grasp", "3d-grasp"] {
        for (method, settings) in [
            ("hwasp", &[][..]),
            ("minimal", &[]),
            ("fixed", &[("design.initial", "{ thumb_distal_radius = \"6 mm\" }")]),
            ("cmaes", &[("cmaes.popsize", "4"), ("cmaes.separable", "true"), ("train.env_steps", "4000")]),
            ("ars", &[("ars.directions", "2"), ("train.env_steps", "4000")]),
            ("cmaes-rl", &[("cmaes.popsize", "4"), ("search.inner_env_steps", "480"), ("train.env_steps", "1920")]),
            ("ars-rl", &[("ars.directions", "2"), ("search.inner_env_steps", "480"), ("train.env_steps", "1920")]),
        ] {
            let assembly = assembly(experiment, method, settings);
            let (one, two) = (run(&assembly, 1), run(&assembly, 2));
            assert_eq!(one.params, two.params, "{experiment} {method}");
            assert_eq!(one.evaluation, two.evaluation, "{experiment} {method}");
            assert!(one.env_steps > 0 && one.discarded_episodes == 0, "{experiment} {method}");
            let kinds: Vec<&str> = one.evaluation.success.iter().map(|rate| rate.kind.as_str()).collect();
            assert_eq!(kinds, ["all", "sphere"], "{experiment} {method}");
        }
    }
}

/// The palm learns to come down to the object.
#[test]
fn a_short_training_improves_the_return() {
    let longer = [
        ("train.env_steps", "24000"),
        ("train.episodes_per_iteration", "20"),
        ("learner.algorithm", "trpo"),
        ("noise.command", "0.5"),
        ("noise.anneal", "[0.2, 0.7]"),
        ("baseline.context", "false"),
        ("trpo.max_kl", "0.05"),
        ("trpo.fisher_rows", "1.0"),
    ];
    let assembly = assembly("z-grasp", "hwasp", &longer);
    let before = evaluate(&assembly, &assembly.init(), (20, 1), &Serial).unwrap().undiscounted_return.mean;
    let trained = run(&assembly, 2);
    let after = evaluate(&assembly, &trained.params, (20, 1), &Serial).unwrap().undiscounted_return.mean;
    assert!(after > before + 4.0, "{before} became {after}");
    // The engine's own tendons make the same of it.
    let native = evaluate_native(&assembly, &trained.params, (20, 1), &Serial).unwrap().undiscounted_return.mean;
    assert!((native - after).abs() < 1.0, "{after} by the law, {native} by tendons");
}
