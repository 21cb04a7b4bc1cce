//! Training as a program that embeds it sees it: events, stopping, failing observers, methods and placements.

#![allow(clippy::unwrap_used)] // helpers of tests are tests too

use std::sync::atomic::{AtomicBool, Ordering};

use hwasp_core::{Placement, Serial, Threads};
use hwasp_training::{Assembly, Event, MetricsRow, Observer, ObserverError, TrainError, Trained, train};

/// An experiment with settings on top; `reach` is cut to two iterations.
fn assembly(experiment: &str, method: Option<&str>, settings: &[(&str, &str)]) -> Assembly {
    let mut layers = hwasp_testing::layers(experiment).with_override("train.evaluation_episodes", "20");
    if experiment == "reach" {
        layers = layers.with_override("train.env_steps", "2400");
    }
    for (key, value) in settings {
        layers = layers.with_override(key, value);
    }
    Assembly::new(&hwasp_testing::resolve(layers, method).unwrap()).unwrap()
}

fn finish(assembly: &Assembly, observer: &mut dyn Observer) -> Trained {
    train(assembly, &Serial, observer, &AtomicBool::new(false)).unwrap()
}

/// Keeps what it is told, and sets `stop` after some iterations.
#[derive(Default)]
struct Recorder {
    events: String,
    rows: Vec<MetricsRow>,
    learner: Vec<String>,
    stop: AtomicBool,
    stop_after: Option<usize>,
}

impl Observer for Recorder {
    fn on(&mut self, event: Event<'_>) -> Result<(), ObserverError> {
        self.events.push(match event {
            Event::Started { learner, .. } => {
                self.learner = learner.iter().map(ToString::to_string).collect();
                'S'
            }
            Event::Iteration(row) => {
                self.rows.push(row.clone());
                'i'
            }
            Event::Checkpoint(_) => 'c',
            Event::Failed(_) => 'f',
            Event::Evaluating => 'e',
            Event::Evaluated(_) => 'E',
        });
        if self.stop_after == Some(self.rows.len()) {
            self.stop.store(true, Ordering::Relaxed);
        }
        Ok(())
    }
}

fn untimed(rows: &[MetricsRow]) -> Vec<MetricsRow> {
    rows.iter().map(|row| MetricsRow { wall_s: 0.0, ..row.clone() }).collect()
}

#[test]
fn events_come_in_order_and_agree_with_the_result() {
    let mut recorder = Recorder::default();
    let trained = finish(&assembly("reach", None, &[]), &mut recorder);
    assert_eq!(recorder.events, "SiiceE");
    assert_eq!((trained.iterations, trained.env_steps), (2, 2400));
    let rows = &recorder.rows;
    assert_eq!(rows.iter().map(|r| (r.iteration, r.env_steps)).collect::<Vec<_>>(), [(0, 1200), (1, 2400)]);
    assert!(0.0 < rows[0].wall_s && rows[0].wall_s < rows[1].wall_s && rows[1].wall_s <= trained.wall_s);
    // Fewer iterations than the trailing window has: all of them.
    let mean = |pick: fn(&MetricsRow) -> f64| rows.iter().map(pick).sum::<f64>() / 2.0;
    assert_eq!(trained.training_discounted_return, mean(|r| r.discounted_return));
    assert_eq!(trained.training_return, mean(|r| r.undiscounted_return));
}

#[test]
fn the_last_iteration_ends_within_the_budget() {
    let trained = finish(&assembly("reach", None, &[("train.env_steps", "1300")]), &mut ());
    // 43 episodes of 30 steps; one more would be beyond.
    assert_eq!((trained.iterations, trained.env_steps), (1, 1290));
}

#[test]
fn a_stopped_training_is_the_beginning_of_the_whole_one() {
    let assembly = assembly("reach", None, &[("train.env_steps", "12000")]);
    let mut whole = Recorder::default();
    finish(&assembly, &mut whole);
    let stop = AtomicBool::new(false);
    let mut part = Stopper { recorder: Recorder { stop_after: Some(3), ..Recorder::default() }, stop: &stop };
    let error = train(&assembly, &Serial, &mut part, &stop).unwrap_err();
    assert!(matches!(error, TrainError::Interrupted { env_steps: 3600, budget: 12_000 }), "{error}");
    assert_eq!(part.recorder.events, "Siiic");
    assert_eq!(untimed(&part.recorder.rows), untimed(&whole.rows[..3]));
    assert_eq!(whole.rows.len(), 10);
}

/// Hands the recorder's wish to the flag that the training looks at.
struct Stopper<'a> {
    recorder: Recorder,
    stop: &'a AtomicBool,
}

impl Observer for Stopper<'_> {
    fn on(&mut self, event: Event<'_>) -> Result<(), ObserverError> {
        self.recorder.on(event)?;
        self.stop.store(self.recorder.stop.load(Ordering::Relaxed), Ordering::Relaxed);
        Ok(())
    }
}

#[test]
fn an_observer_that_cannot_go_on_ends_the_training_with_its_error() {
    struct Full(u32);
    impl Observer for Full {
        fn on(&mut self, event: Event<'_>) -> Result<(), ObserverError> {
            let Event::Iteration(_) = event else { return Ok(()) };
            self.0 += 1;
            Err(ObserverError("the disk is full".into()))
        }
    }
    let mut full = Full(0);
    let error = train(&assembly("reach", None, &[]), &Serial, &mut full, &AtomicBool::new(false)).unwrap_err();
    assert!(matches!(error, TrainError::Observer(_)));
    assert_eq!((error.to_string().as_str(), full.0), ("the disk is full", 1));
}

#[test]
fn the_number_of_threads_changes_no_bit() {
    for method in ["hwasp", "minimal"] {
        let assembly = assembly("mass-spring", Some(method), &[("train.env_steps", "8000")]);
        let (mut one, mut two) = (Recorder::default(), Recorder::default());
        let serial = finish(&assembly, &mut one);
        let parallel = train(&assembly, &Threads::new(2).unwrap(), &mut two, &AtomicBool::new(false)).unwrap();
        assert_eq!(bits(&serial.params), bits(&parallel.params), "{method}");
        assert_eq!(serial.evaluation, parallel.evaluation, "{method}");
        assert_eq!(untimed(&one.rows), untimed(&two.rows), "{method}");
    }
}

fn bits(params: &[f32]) -> Vec<u32> {
    params.iter().map(|p| p.to_bits()).collect()
}

#[test]
fn the_seed_changes_the_result() {
    let params = |seed| finish(&assembly("reach", None, &[("seed", seed)]), &mut ()).params;
    assert_eq!(bits(&params("5")), bits(&params("5")));
    assert_ne!(bits(&params("5")), bits(&params("6")));
}

#[test]
fn with_a_fixed_design_the_controller_learns_and_the_design_stays() {
    let assembly = assembly("mass-spring", Some("fixed"), &[("train.env_steps", "12000")]);
    let mut recorder = Recorder::default();
    let trained = finish(&assembly, &mut recorder);
    let first = assembly.init();
    assert_eq!(assembly.policy.design(&first), assembly.policy.design(&trained.params));
    let totals: Vec<_> = recorder.rows.iter().map(|row| row.design_totals.clone()).collect();
    assert!(totals.len() == 3 && totals.iter().all(|t| *t == totals[0]), "{totals:?}");
    let controller = |params: &[f32]| bits(assembly.policy.controller_params(params));
    assert_ne!(controller(&first), controller(&trained.params));
    // The hardware is not in the parameters at all, and begins as with a design that learns.
    assert!(assembly.policy.spec().placements.iter().all(|p| matches!(p, Placement::Fixed(_))));
    let free = self::assembly("mass-spring", None, &[]);
    for (fixed, free) in assembly.policy.design(&first).iter().zip(free.policy.design(&free.init())) {
        assert!((fixed - free).abs() < 1e-6 * free.abs(), "{fixed} {free}");
    }
}

#[test]
fn parameters_may_sit_in_different_places() {
    let placements = r#"{ "stiffness[0..3]" = "action", "stiffness[7]" = "fixed" }"#;
    let assembly = assembly("mass-spring", None, &[("design.placements", placements), ("train.env_steps", "12000")]);
    let trained = finish(&assembly, &mut ());
    let (before, after) = (assembly.policy.design(&assembly.init()), assembly.policy.design(&trained.params));
    for i in 0..10 {
        let expected = match i {
            0..3 => "action",
            7 => "fixed",
            _ => "graph",
        };
        let found = match assembly.policy.spec().placements[i] {
            Placement::Graph => "graph",
            Placement::Action => "action",
            Placement::Episode => "episode",
            Placement::Fixed(_) | Placement::Built(_) => "fixed",
        };
        assert_eq!(found, expected, "{i}");
        assert_eq!(before[i] == after[i], i == 7, "{i}: {} {}", before[i], after[i]);
    }
    // The sampled design comes beside the effort and the command of the springs that stay in the graph.
    let names = assembly.policy.action_names();
    assert_eq!(names.iter().filter(|name| name.contains("stiffness")).count(), 3, "{names:?}");
}

/// A start that is given went through the squash and back, and lost its last bits: the pendulum was the classic one only
/// almost.
#[test]
fn a_fixed_design_is_what_it_is_given_to_be() {
    let design = |experiment, settings: &[(&str, &str)]| {
        let assembly = assembly(experiment, Some("fixed"), settings);
        assembly.policy.design(&assembly.init())
    };
    assert_eq!(design("pendulum", &[]), [1.0]);
    assert_eq!(design("reach", &[("design.initial", "0.7")]), [0.7]);
    assert_eq!(design("mass-spring", &[("design.initial", "1.96 N/m")]), [1.96; 10]);
}

/// `{ gear = 90 }` put the other parameters into the middle of their limits, whatever the robot said of where they begin.
#[test]
fn parameters_that_are_not_named_begin_where_the_problem_says() {
    let assembly = assembly("hopper", Some("fixed"), &[("design.initial", "{ gear = 90 }")]);
    // gear, rest, shank, stiffness: the file says where the last one begins, the others begin in the middle.
    assert_eq!(assembly.policy.design(&assembly.init()), [90.0, -0.5, 0.5, 20.0]);
}

/// TRPO is a learner like another: for every method that follows a gradient, alone or inside of a search.
#[test]
fn trpo_trains_by_every_method() {
    for (method, steps) in
        [("hwasp", "2400"), ("minimal", "2400"), ("fixed", "2400"), ("cmaes-rl", "12000"), ("ars-rl", "12000")]
    {
        let settings = [
            ("learner.algorithm", "trpo"),
            ("trpo.fisher_rows", "200"),
            ("search.inner_env_steps", "1200"),
            ("train.env_steps", steps),
        ];
        let assembly = assembly("reach", Some(method), &settings);
        let run = |executor| {
            let mut recorder = Recorder::default();
            let trained = train(&assembly, executor, &mut recorder, &AtomicBool::new(false)).unwrap();
            (trained.params, recorder.rows, recorder.learner)
        };
        let (params, rows, names) = run(&Serial);
        assert_ne!(params, assembly.init(), "{method}");
        assert_eq!(params, run(&Threads::new(2).unwrap()).0, "{method}");
        if !method.ends_with("-rl") {
            // Divergence and the share of the full step, by their places among the names.
            let place = |name| names.iter().position(|known| known == name).unwrap();
            let (kl, fraction) = (place("kl"), place("step_fraction"));
            assert!(
                rows.iter().all(|row| row.learner[kl] <= 0.01 && row.learner[fraction] <= 1.0),
                "{method}: {rows:?}"
            );
            assert!(rows.iter().any(|row| row.learner[kl] > 0.0 && row.learner[fraction] > 0.0), "{method}: {rows:?}");
        }
    }
}

/// A bar low enough for any seed, and out of reach for a learner that does nothing: the first design has gear 1.27.
#[test]
fn reach_is_learned() {
    let assembly = assembly("reach", None, &[("train.env_steps", "120000")]);
    let trained = finish(&assembly, &mut ());
    let gear = assembly.policy.design(&trained.params)[0];
    assert!((gear - 1.0).abs() < 0.15, "gear {gear}");
    let mean = trained.evaluation.discounted_return.mean;
    assert!(mean > -3.0, "{mean}");
}

/// A tenth of the steps, from old experience.
#[test]
fn reach_is_learned_from_old_experience() {
    let td3 = [("td3.critic_hidden", "[32, 32]"), ("td3.warmup_steps", "600"), ("td3.learning_rate", "1e-3")];
    let sac = [("sac.critic_hidden", "[32, 32]"), ("sac.warmup_steps", "600"), ("sac.learning_rate", "1e-3")];
    // The design goes where critics see the most value instead of along their slope; critics may have normalised layers.
    let searched = [("sac.design_search", "600"), ("sac.critic_layer_norm", "true")];
    for (learner, settings) in [("td3", td3.to_vec()), ("sac", sac.to_vec()), ("sac", [&sac[..], &searched].concat())] {
        let train =
            [("learner.algorithm", learner), ("train.env_steps", "12000"), ("train.episodes_per_iteration", "4")];
        let assembly = assembly("reach", None, &[&train[..], &settings[..]].concat());
        let trained = finish(&assembly, &mut ());
        let gear = assembly.policy.design(&trained.params)[0];
        let mean = trained.evaluation.discounted_return.mean;
        assert!((gear - 1.0).abs() < 0.05 && mean > -2.5, "{learner}: gear {gear}, return {mean}");
    }
}

/// Nothing that is drawn, nothing for returns to move; a design that is fixed asks for nothing.
#[test]
fn returns_move_what_is_drawn_alone() {
    let assemble = |method| {
        Assembly::new(&hwasp_testing::small(method, &[("learner.algorithm", "sac"), ("sac.design_returns", "60")]))
    };
    for method in ["hwasp", "minimal"] {
        let error = assemble(method).err().unwrap().to_string();
        let told = "sac.design_returns is for a design that is drawn once an episode, and none is; \
                    set design.placement = \"episode\", or leave it out";
        assert_eq!(error, told);
    }
    assert!(assemble("episode").is_ok() && assemble("fixed").is_ok());
}

/// Before critics have learned, they expect everywhere what they are told to, give or take the tenth that they were born with, of
/// their unit.
#[test]
fn critics_begin_at_their_initial_value() {
    let first_value = |initial_value, value_scale| {
        let settings = [
            ("learner.algorithm", "td3"),
            ("train.env_steps", "2400"),
            ("td3.warmup_steps", "1200"),
            ("td3.updates_per_step", "0.01"),
            ("td3.learning_rate", "1e-9"),
            ("td3.critic_learning_rate", "1e-9"),
            ("td3.initial_value", initial_value),
            ("td3.value_scale", value_scale),
        ];
        let mut recorder = Recorder::default();
        finish(&assembly("reach", None, &settings), &mut recorder);
        let value = recorder.learner.iter().position(|name| name == "value").unwrap();
        recorder.rows[0].learner[value]
    };
    let (measured, zero, more) = (first_value("none", "none"), first_value("0", "none"), first_value("100", "none"));
    assert!(measured < -5.0 && zero.abs() < 5.0, "{measured} where returns are, {zero} at 0");
    assert!((more - zero - 100.0).abs() < 1e-3, "{more} is not 100 above {zero}");
    let (one, ten) = (first_value("0", "1"), first_value("0", "10"));
    assert!(one != 0.0 && (ten - 10.0 * one).abs() < 1e-3 * one.abs(), "{ten} is not 10 times {one}");
}
