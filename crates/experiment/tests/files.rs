//! Experiments that come with the program: they resolve for every method, and what is written is read back the same.

#![allow(clippy::unwrap_used)] // a panic is how a test fails

use std::sync::Arc;

use hwasp_algos::{PpoConfig, TrpoConfig};
use hwasp_experiment::{Experiment, Folder, InitialDesign, Layers, Method, Place};
use hwasp_tasks::mass_spring::StiffnessTask;
use hwasp_testing::{catalogue, layers as load, resolve};
use proptest::prelude::*;

/// What a run folder keeps has to give the same experiment again.
fn read_back(spec: &Experiment) -> Experiment {
    let text = spec.to_toml().expect("a spec is made of what TOML has");
    assert!(!text.contains("[methods"), "{text}");
    let layers = Layers::from_text("experiment.toml", &text).unwrap_or_else(|e| panic!("{e}\n{text}"));
    let layers = layers.with_folder(Folder::Sent(Arc::clone(spec.files())));
    resolve(layers, None).unwrap_or_else(|e| panic!("{e}\n{text}"))
}

fn ppo(spec: &Experiment) -> &PpoConfig {
    spec.learner.of().unwrap()
}

fn trpo(spec: &Experiment) -> &TrpoConfig {
    spec.learner.of().unwrap()
}

fn stiffness(spec: &Experiment) -> &StiffnessTask {
    spec.task.settings().unwrap()
}

#[test]
fn every_experiment_resolves_for_every_method_and_is_read_back() {
    for preset in catalogue().presets() {
        let name = preset.name;
        for (method, expected) in Method::ALL {
            let spec = resolve(load(name), Some(method)).unwrap_or_else(|e| panic!("{name}: {e}"));
            assert_eq!(spec.name, name, "the file is called what its experiment is");
            assert_eq!(spec.method, *expected);
            assert_eq!(read_back(&spec), spec);
        }
    }
}

#[test]
fn the_resolved_file_says_everything() {
    let spec = resolve(load("paper/bar-length"), None).unwrap();
    insta::assert_snapshot!("resolved_paper_bar_length", spec.to_toml().unwrap());
    let reach = resolve(load("reach").with_override("design.initial", "0.7"), Some("fixed")).unwrap();
    insta::assert_snapshot!("resolved_reach_fixed", reach.to_toml().unwrap());
}

/// Another learner is not another problem: what the experiment says of discounting holds for it too. How PPO
/// takes its gradient steps does not: the value baseline took its minibatches, decay and gradient limit from `[ppo]`.
#[test]
fn trpo_discounts_as_ppo_does_unless_it_is_told_otherwise() {
    let spec = |settings: &[&str]| {
        let layers = load("pendulum").with_assignment("learner.algorithm = trpo");
        resolve(settings.iter().fold(layers, |layers, s| layers.with_assignment(s)), None).unwrap()
    };
    let plain = spec(&[]);
    assert_eq!(
        (plain.discount(), trpo(&plain).advantages.gae_lambda, plain.baseline.mlp.minibatch_rows),
        (0.9, 0.95, 1000)
    );
    let told = spec(&["trpo.discount = 0.95", "baseline.minibatch_rows = 50"]);
    assert_eq!((told.discount(), ppo(&told).discount, told.baseline.mlp.minibatch_rows), (0.95, 0.9, 50));
    let of_ppo = ["ppo.learning_rate_final = 0.1", "ppo.max_grad_norm = 7"];
    let decay = |spec: &Experiment| (spec.baseline.mlp.learning_rate_final, spec.baseline.mlp.max_grad_norm);
    assert_eq!(decay(&spec(&of_ppo)), (1.0, Some(0.5)));
    // Under PPO they are the baseline's, too, where it has none of its own.
    let under_ppo = of_ppo.iter().fold(load("pendulum"), |layers, s| layers.with_assignment(s));
    assert_eq!(decay(&resolve(under_ppo, None).unwrap()), (0.1, Some(7.0)));
}

#[test]
fn later_layers_win() {
    let text = "name = 'a'\nmethod = 'minimal'\ntask = { problem = 'stiffness', segments = 3 }\n\
                [ppo]\nclip_ratio = 0.1\nepochs = 1\ndiscount = 0.5\n\
                [methods.minimal.ppo]\nclip_ratio = 0.2\nepochs = 2\n";
    let layers = || Layers::from_text("a.toml", text).unwrap();
    let spec = resolve(layers().with_assignment("ppo.epochs = 3"), None).unwrap();
    assert_eq!((ppo(&spec).discount, ppo(&spec).clip_ratio, ppo(&spec).epochs), (0.5, 0.2, 3));
    assert_eq!(spec.design.placement, Place::Action);
    // The method of the command line decides whose tables count, and the last one given holds.
    let spec = resolve(layers().with_override("method", "fixed"), Some("hwasp")).unwrap();
    assert_eq!((spec.method, ppo(&spec).clip_ratio, ppo(&spec).epochs), (Method::Hwasp, 0.1, 1));
    assert_eq!(spec.design.placement, Place::Graph);
}

#[test]
fn options_need_no_quotes() {
    let layers = load("mass-spring")
        .with_assignment("noise.effort=2500 mN")
        .with_assignment("task.effort_clip=5 N")
        .with_assignment("design.placements.stiffness[2..4]=action")
        .with_assignment("design.placements.'stiffness[9]'=\"fixed\"")
        .with_assignment("design.initial=middle")
        .with_option("--env-steps 1e6".into(), "train.env_steps", "1e6");
    let spec = resolve(layers, None).unwrap();
    assert_eq!(spec.noise.effort.as_deref(), Some(&[2.5][..]));
    assert_eq!(spec.train.env_steps, 1_000_000);
    assert_eq!(spec.design.initial, InitialDesign::Middle);
    assert_eq!(stiffness(&spec).base.effort_clip, Some(5.0));
    let places: Vec<_> = (0..10).filter(|&i| spec.design.place_of(i) != Place::Graph).collect();
    assert_eq!(places, [2, 3, 9]);
    assert_eq!(spec.design.place_of(9), Place::Fixed);
    assert_eq!(read_back(&spec), spec);
}

#[test]
fn an_absent_limit_can_be_asked_for() {
    let clip = |layers: Layers| stiffness(&resolve(layers, None).unwrap()).base.effort_clip;
    assert_eq!(clip(load("paper/mass-spring")), Some(5.0));
    assert_eq!(clip(load("paper/mass-spring").with_assignment("task.effort_clip=none")), None);
}

#[test]
fn defaults_fit_each_other() {
    // 3 episodes of 30 steps are fewer rows than the usual minibatch, and the usual episode is longer than these.
    let text = "name = 'small'\ntask = { problem = 'reach' }\ntrain = { episodes_per_iteration = 3 }";
    let spec = resolve(Layers::from_text("small.toml", text).unwrap(), None).unwrap();
    assert_eq!((spec.task.horizon, spec.train.episode_steps, ppo(&spec).minibatch_rows), (30, 30, 90));
    assert_eq!(read_back(&spec), spec);
}

#[test]
fn a_hostile_megabyte_is_answered_at_once() {
    let begin = std::time::Instant::now();
    let megabyte = 1 << 20;
    let mut texts = vec![
        "[".repeat(megabyte),
        format!("a = {}", "[".repeat(megabyte - 4)),
        format!("{} = 1", "a.".repeat(megabyte / 2 - 4)),
        format!("{} = 1", "k".repeat(megabyte - 4)),
        format!("controller.hidden = [{}]", "1,".repeat(megabyte / 2 - 20)),
        format!("name = \"{}\"", "x".repeat(megabyte - 20)),
        "\n".repeat(megabyte),
        "é".repeat(megabyte / 2),
    ];
    texts.push((0..60_000).fold(String::new(), |text, i| text + "key" + &i.to_string() + " = 1\n"));
    // Each fault is shown with its line, and to find that line took as long as the file is: half a minute in all.
    texts.push((0..40_000).fold(String::new(), |text, i| text + "[methods.m" + &i.to_string() + "]\n"));
    texts.push("=\n".repeat((1 << 15) - 8));
    let unknown = |method: &str| (0..8000).fold(format!("[methods.{method}.ppo]\n"), |t, i| t + &format!("x{i} = 1\n"));
    texts.push(["hwasp", "minimal", "fixed", "cmaes", "ars", "ars-rl"].map(unknown).concat());
    for text in texts {
        assert!(text.len() <= megabyte);
        let error = match Layers::from_text("huge.toml", &text) {
            Ok(layers) => resolve(layers, None).unwrap_err(),
            Err(error) => error,
        };
        let told = error.to_string();
        assert!(!told.is_empty() && told.len() < 60_000, "{} bytes", told.len());
    }
    assert!(begin.elapsed().as_secs() < 30, "{:?}", begin.elapsed());
}

/// Texts that are near enough to an experiment to get past the first line.
fn almost_toml() -> impl Strategy<Value = String> {
    let table = prop::sample::select(vec![
        "",
        "[task]",
        "[design]",
        "[noise]",
        "[ppo]",
        "[train]",
        "[controller]",
        "[methods.minimal.ppo]",
        "[design.placements]",
        "[[task]]",
    ]);
    let key = prop_oneof![
        prop::sample::select(vec![
            "name",
            "problem",
            "segments",
            "horizon",
            "goal",
            "initial",
            "placements",
            "effort",
            "anneal",
            "hidden",
            "episode_steps",
            "episodes_per_iteration",
            "env_steps",
            "minibatch_rows",
            "\"stiffness[3]\"",
            "\"stiffness[0..99]\"",
            "method",
            "methods",
            "observation_scale",
        ])
        .prop_map(str::to_owned),
        "[a-z_]{1,6}",
    ];
    let value = prop_oneof![
        prop::sample::select(vec![
            "'stiffness'",
            "'bar-length'",
            "'reach'",
            "'pendulum'",
            "'action'",
            "'3 N'",
            "'0.3'",
            "'-1e400 m'",
            "nan",
            "-inf",
            "[]",
            "[0.1, 1]",
            "[[1]]",
            "{ a = 1 }",
            "{ 'gear' = 'action' }",
            "true",
            "1979-05-27",
            "9999999999999999999",
            "'é N'",
        ])
        .prop_map(str::to_owned),
        any::<i64>().prop_map(|v| v.to_string()),
        any::<f64>().prop_map(|v| format!("{v:?}")),
        ".{0,8}",
    ];
    let line = (table, key, value).prop_map(|(table, key, value)| format!("{table}\n{key} = {value}\n"));
    prop::collection::vec(line, 0..6).prop_map(|lines| lines.concat())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn no_text_panics(text in prop_oneof![almost_toml(), any::<String>(), "[\\PC\\n=\\[\\]\"']{0,80}"]) {
        if let Ok(layers) = Layers::from_text("any.toml", &text) {
            for method in [None, Some("minimal"), Some(text.as_str())] {
                match resolve(layers.clone(), method) {
                    Ok(spec) => prop_assert_eq!(read_back(&spec), spec),
                    Err(errors) => prop_assert!(errors.count() > 0 && !errors.to_string().is_empty()),
                }
            }
        }
    }

    #[test]
    fn no_option_panics(
        key in prop_oneof![
            any::<String>(),
            "[a-z.\\[\\]\"' ]{0,20}",
            prop::sample::select(vec!["task.problem", "design.initial", "noise.anneal", "design.placements", "task"])
                .prop_map(str::to_owned),
        ],
        value in prop_oneof![any::<String>(), "[0-9\\[\\]\"'a-zN/., {}=-]{0,20}"],
    ) {
        let layers = load("mass-spring").with_override(&key, &value).with_assignment(&value);
        match resolve(layers, None) {
            Ok(spec) => prop_assert_eq!(read_back(&spec), spec),
            Err(errors) => prop_assert!(!errors.to_string().is_empty()),
        }
    }
}

/// Whether the search is around a training counted, so that settings that say the same were not the same.
#[test]
fn settings_of_a_search_are_the_same_for_either_method() {
    let with = |method| {
        let set = [("ars.variant", "v1-t"), ("ars.directions", "8"), ("controller.normalize_observations", "false")];
        let layers = set.iter().fold(load("reach"), |layers, (key, value)| layers.with_override(key, value));
        resolve(layers, Some(method)).unwrap().ars
    };
    assert_eq!(with("ars"), with("ars-rl"));
}
