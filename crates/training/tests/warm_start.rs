//! Trainings that begin with what another one learned.

#![allow(clippy::unwrap_used)] // a panic is how a test fails

use hwasp_core::Actor;
use hwasp_testing::{layers, resolve, small};
use hwasp_training::{Assembly, Learned, WarmStartError, beginning, params_at, warm_start};

fn assembly(problem: &str, settings: &[(&str, &str)]) -> Assembly {
    let layers = settings.iter().fold(layers(problem), |layers, (key, value)| layers.with_override(key, value));
    Assembly::new(&resolve(layers, None).unwrap()).unwrap()
}

/// So much noise that nothing lies beyond what a controller knows.
const ANYWHERE: (&str, &str) = ("task.position_noise", "\"50 mm\"");

/// What the controller of `assembly` commands where it sees these observations, SI.
fn commands(assembly: &Assembly, params: &[f32], seen: &[f64]) -> Vec<f64> {
    let (policy, env) = (&assembly.policy, &assembly.worlds.training.env);
    let deployed = assembly.deployed(&assembly.built(params)).unwrap();
    let controller = policy.controller_params(params).to_vec();
    let mut input = vec![0.0; seen.len()];
    policy.normalizer(params).apply(seen, &mut input);
    let mut actor = Actor::new(&deployed, &controller, 1.0, 1);
    actor.act(&input, &vec![0.0; env.state.len()], 1, None);
    actor.action(0).to_vec()
}

/// With other centres and scales, and a further input, the controller does the same; a further command begins near rest.
#[test]
fn the_controller_does_what_it_did() {
    let hand = assembly("z-grasp", &[("seed", "4"), ANYWHERE]);
    let mut params = hand.init();
    // Larger outputs than a fresh controller has.
    let (weights, biases) = hand.policy.controller().last_layer();
    params[weights].iter_mut().for_each(|weight| *weight *= 10.0);
    params[biases].copy_from_slice(&[0.1, -0.2]);
    let bench = assembly(
        "3d-grasp",
        &[
            ("task.viewpoint", "world"),
            ANYWHERE,
            ("task.travel_sensed", "both"),
            ("controller.observation_center", "[0.1, 0, 0.3, 0, 0.02, 0.1, 0.06, 0.07, 0.07, 0.02, 0.2, 0.01]"),
            ("controller.observation_scale", "[0.1, 0.05, 0.2, 0.05, 0.05, 0.2, 0.02, 0.03, 0.02, 0.02, 0.3, 0.01]"),
        ],
    );
    let start = warm_start(&bench, &[Learned { assembly: &hand, params: &params }]).unwrap();
    let seen = [0.01, -0.02, 0.25, 0.03, 0.0, 0.05, 0.06, 0.05, 0.08, 0.012, 0.4];
    let before = commands(&hand, &params, &seen);
    let now = commands(&bench, &start, &[&seen[..], &[0.02]].concat());
    for (before, now) in [(before[0], now[2]), (before[1], now[3])] {
        assert!((before - now).abs() < 1e-5 * before.abs() && before != 0.0, "{before}, {now}");
    }
    assert!(now[0].abs() < 1e-3 && now[1].abs() < 1e-3, "{now:?}");
    // The hand is the same, too: the limits are.
    for (before, now) in hand.built(&params).iter().zip(bench.built(&start)) {
        assert!((before - now).abs() < 1e-6 * before.abs(), "{before}, {now}");
    }
    let checkpoint = beginning(&bench, start.clone(), 1).unwrap();
    assert_eq!((checkpoint.iteration, params_at(&bench, &checkpoint).unwrap()), (0, start));
}

/// A command is that of the first run that has it: of a grasp from above the fall and the motor, of one in space what is left.
#[test]
fn networks_stand_side_by_side() {
    let loud = |problem: &str, seed: &str, hidden: &str| {
        let assembly =
            assembly(problem, &[("seed", seed), ("controller.hidden", hidden), ("task.viewpoint", "world"), ANYWHERE]);
        let mut params = assembly.init();
        let (weights, _) = assembly.policy.controller().last_layer();
        params[weights].iter_mut().for_each(|weight| *weight *= 10.0);
        (assembly, params)
    };
    let ((above, grasp), (space, way)) = (loud("z-grasp", "4", "[8, 6]"), loud("3d-grasp", "5", "[5, 7]"));
    let settings = [("controller.hidden", "[13, 13]"), ("task.viewpoint", "world"), ANYWHERE];
    let both = assembly("3d-grasp", &settings);
    let runs = [Learned { assembly: &above, params: &grasp }, Learned { assembly: &space, params: &way }];
    let start = warm_start(&both, &runs).unwrap();
    let seen = [0.01, -0.02, 0.25, 0.03, 0.0, 0.05, 0.06, 0.05, 0.08, 0.012, 0.4];
    let now = commands(&both, &start, &seen);
    let (grasps, goes) = (commands(&above, &grasp, &seen), commands(&space, &way, &seen));
    for (now, wanted) in now.iter().zip([goes[0], goes[1], grasps[0], grasps[1]]) {
        assert!((now - wanted).abs() < 1e-5 * wanted.abs() && wanted != 0.0, "{now}, {wanted}");
    }
    let error = warm_start(&above, &runs).unwrap_err();
    let told = "controller.hidden = [128, 128], where what it is to begin with has [8, 6] and [5, 7]: set controller.hidden = [13, 13]";
    let wide = assembly("z-grasp", &[("task.viewpoint", "world")]);
    assert!(matches!(error, WarmStartError::Hidden { .. }));
    assert_eq!(warm_start(&wide, &runs).unwrap_err().to_string(), told);
}

/// To a grasp from above an object lies in the middle: wherever it lies in space, what it knew goes on.
#[test]
fn what_lies_beyond_is_as_it_was() {
    let above = assembly("z-grasp", &[("seed", "4"), ("controller.hidden", "[8, 6]")]);
    let mut grasp = above.init();
    let (weights, _) = above.policy.controller().last_layer();
    grasp[weights].iter_mut().for_each(|weight| *weight *= 10.0);
    let space = assembly("3d-grasp", &[("controller.hidden", "[8, 6]"), ("task.viewpoint", "world")]);
    let start = warm_start(&space, &[Learned { assembly: &above, params: &grasp }]).unwrap();
    let seen = |at: f64| [0.0, 0.0, 0.25, at, -at, 0.05, 0.06, 0.05, 0.08, 0.012, 0.4];
    let (before, now) = (commands(&above, &grasp, &seen(0.0)), commands(&space, &start, &seen(0.0)));
    let most = before.iter().fold(0.0, |most: f64, command| most.max(command.abs()));
    for (now, wanted) in now[2..].iter().zip(&before) {
        assert!((now - wanted).abs() < 0.05 * most, "{now}, {wanted}");
    }
    assert_eq!(commands(&space, &start, &seen(0.05)), now);
    assert_ne!(commands(&above, &grasp, &seen(0.05)), before);
}

/// Running statistics begin with the other one's, and a design within the limits.
#[test]
fn statistics_and_design_are_taken_along() {
    const NORMALIZED: &[(&str, &str)] = &[
        ("controller.observation_center", "[0.0]"),
        ("controller.observation_scale", "[1.0]"),
        ("controller.normalize_observations", "true"),
    ];
    let other = Assembly::new(&small("hwasp", NORMALIZED)).unwrap();
    let mut params = other.init();
    let at = other.policy.normalizer_params();
    params[at.clone()].copy_from_slice(&[0.3, 0.7]);
    let design = other.policy.design_params();
    params[design.clone()][0] = 30.0; // at its upper limit
    let assembly = Assembly::new(&small("hwasp", NORMALIZED)).unwrap();
    let start = warm_start(&assembly, &[Learned { assembly: &other, params: &params }]).unwrap();
    assert_eq!(start[at], [0.3, 0.7]);
    assert!((4.0..10.0).contains(&start[design][0]), "no way back from the limit");
}

/// What does not fit is told by name and value.
#[test]
fn what_does_not_fit_is_refused() {
    let here = Assembly::new(&small("hwasp", &[])).unwrap();
    let wide = Assembly::new(&small("hwasp", &[("controller.hidden", "[7]")])).unwrap();
    let error = warm_start(&here, &[Learned { assembly: &wide, params: &wide.init() }]).unwrap_err();
    assert!(error.to_string().starts_with("controller.hidden = "), "{error}");
    assert!(error.to_string().ends_with("has [7]: set controller.hidden = [7]"), "{error}");
    let hand = assembly("z-grasp", &[("controller.hidden", "[8]")]);
    let spring = assembly("mass-spring", &[("controller.hidden", "[8]"), ("controller.squash", "false")]);
    let error = warm_start(&spring, &[Learned { assembly: &hand, params: &hand.init() }]).unwrap_err();
    assert!(matches!(error, WarmStartError::Strange { what: "observation", .. }), "{error}");
}
