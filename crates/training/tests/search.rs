//! Methods that search: the ledger, threads, stopping, candidates that fail, budgets.

#![allow(clippy::unwrap_used)] // helpers of tests are tests too

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use hwasp_core::{Serial, Step, Threads};
use hwasp_testing::spoil;
use hwasp_training::{AssembleError, Assembly, Event, MetricsRow, Observer, ObserverError, Trained, evaluate, train};

/// Small searches on the reach problem: 30 steps an episode.
fn assembly(method: &str, settings: &[(&str, &str)]) -> Result<Assembly, AssembleError> {
    let small = [("train.evaluation_episodes", "20"), ("train.env_steps", "60000"), ("search.inner_env_steps", "1200")];
    let layers =
        small.iter().chain(settings).fold(hwasp_testing::layers("reach"), |layers, (k, v)| layers.with_override(k, v));
    Assembly::new(&hwasp_testing::resolve(layers, Some(method)).unwrap())
}

#[derive(Default)]
struct Rows(Vec<MetricsRow>);

impl Observer for Rows {
    fn on(&mut self, event: Event<'_>) -> Result<(), ObserverError> {
        if let Event::Iteration(row) = event {
            self.0.push(MetricsRow { wall_s: 0.0, ..row.clone() });
        }
        Ok(())
    }
}

/// The result with its rows; NaN columns are compared as bits.
fn run(assembly: &Assembly, threads: usize) -> (Trained, Vec<String>) {
    let mut rows = Rows::default();
    let stop = AtomicBool::new(false);
    let trained = match threads {
        1 => train(assembly, &Serial, &mut rows, &stop),
        n => train(assembly, &Threads::new(n).unwrap(), &mut rows, &stop),
    };
    (trained.unwrap(), rows.0.iter().map(|row| format!("{row:?}")).collect())
}

const METHODS: [&str; 6] = ["cmaes", "ars", "cmaes-rl", "ars-rl", "bo-rl", "random-rl"];

#[test]
fn the_number_of_threads_changes_nothing() {
    for method in METHODS {
        let assembly = assembly(method, &[]).unwrap();
        let ((one, rows), (two, rows_of_two)) = (run(&assembly, 1), run(&assembly, 2));
        assert_eq!(one.params, two.params, "{method}");
        assert_eq!((one.env_steps, one.evaluation), (two.env_steps, two.evaluation), "{method}");
        assert_eq!(rows, rows_of_two, "{method}");
        assert!(!rows.is_empty());
    }
}

/// Every step that a search causes is charged: candidates × episodes × steps a generation, and for the choice at the end
/// two candidates on 16 episodes.
#[test]
fn the_ledger_counts_every_step() {
    let count = |method, settings: &[_]| {
        let (trained, rows) = run(&assembly(method, settings).unwrap(), 1);
        assert_eq!(rows.len() as u64, trained.iterations);
        // All candidates' episodes are told; those of trainings inside are not counted.
        let told = match method {
            "cmaes" => "episodes: 18.0, episode_steps: 30.0",
            "ars" => "episodes: 20.0, episode_steps: 30.0",
            _ => "episodes: NaN, episode_steps: NaN",
        };
        assert!(rows[0].contains(told), "{method}: {}", rows[0]);
        (trained.iterations, trained.env_steps)
    };
    let steps = hwasp_testing::resolve(hwasp_testing::layers("reach"), None).unwrap().train.episode_steps as u64;
    let (generations, charged) = count("cmaes", &[("cmaes.popsize", "6"), ("search.episodes", "3")]);
    assert_eq!(charged, generations * 6 * 3 * steps + 2 * 16 * steps);
    let (generations, charged) = count("ars", &[("ars.directions", "5"), ("search.episodes", "2")]);
    assert_eq!(charged, generations * 10 * 2 * steps + 2 * 16 * steps);
    let (generations, charged) = count("cmaes-rl", &[("cmaes.popsize", "5")]);
    assert_eq!(charged, generations * 5 * 1200);
    let (generations, charged) = count("ars-rl", &[("ars.directions", "2")]);
    assert_eq!(charged, generations * 4 * 1200);
    // No generation is begun that the budget does not hold, and none is left out that it does.
    for (method, each) in [("cmaes-rl", 5 * 1200), ("ars-rl", 4 * 1200)] {
        let settings: &[_] = if method == "ars-rl" { &[("ars.directions", "2")] } else { &[("cmaes.popsize", "5")] };
        assert_eq!(count(method, settings).0, 60_000 / each, "{method}");
    }
    // The last generation of these takes what is left: 3 · 3 + 2 candidates, or one alone.
    for (method, popsize) in [("bo-rl", "bo.popsize"), ("random-rl", "random.popsize")] {
        let count = |budget| count(method, &[("train.env_steps", budget), (popsize, "3"), ("bo.initial_points", "3")]);
        assert_eq!((count("14000"), count("1300")), ((4, 11 * 1200), (1, 1200)), "{method}");
    }
}

#[test]
fn a_budget_below_one_generation_is_refused() {
    let error = assembly("cmaes", &[("train.env_steps", "1200")]).err().unwrap().to_string();
    assert!(error.starts_with("train.env_steps = 1200 is less than one generation takes:"), "{error}");
    let fixed = [("design.placement", "fixed")];
    let error = assembly("cmaes-rl", &fixed).err().unwrap().to_string();
    assert_eq!(
        error,
        "method cmaes-rl searches the design, but all of it is fixed; let design.placement be \"action\""
    );
    let error = assembly("random-rl", &[("train.env_steps", "1300"), ("search.inner_env_steps", "1400")])
        .err()
        .unwrap()
        .to_string();
    assert!(error.contains("1400 steps, for 1 candidate of 1400 steps"), "{error}");
    let error = assembly("bo-rl", &[("train.env_steps", "1202000")]).err().unwrap().to_string();
    assert!(error.starts_with("method bo-rl would train 1001 candidates, and its model bears 1000;"), "{error}");
}

/// All searches find where the point has to be, and what they give is what was evaluated.
#[test]
fn searches_learn_to_reach() {
    for (method, settings) in [
        ("cmaes", &[("cmaes.sigma", "0.2"), ("cmaes.separable", "true"), ("search.episodes", "2")][..]),
        ("ars", &[("ars.step_size", "0.1"), ("search.episodes", "2"), ("ars.directions", "16")]),
    ] {
        let assembly = assembly(method, settings).unwrap();
        let before = evaluate(&assembly, &assembly.init(), (20, 1), &Serial).unwrap().discounted_return.mean;
        let trained = run(&assembly, 1).0;
        let after = trained.evaluation.discounted_return.mean;
        assert!(after > 0.5 * before, "{method}: {before} became {after}");
        assert_eq!(trained.failed_candidates, Some(0));
    }
}

const FASTEST: f64 = 0.3; // m/s

/// Candidates whose episode or whose training fails are counted, charged in full, and passed over.
#[test]
fn failing_candidates_rank_last_and_are_charged() {
    type Case<'a> = (&'a str, &'a [(&'a str, &'a str)], u64);
    let settings: [Case<'_>; 6] = [
        ("cmaes", &[("cmaes.sigma", "0.5"), ("search.episodes", "1"), ("search.noise", "false")], 30),
        ("ars", &[("ars.noise_std", "0.5"), ("search.episodes", "1"), ("search.noise", "false")], 30),
        ("cmaes-rl", &[("cmaes.popsize", "5")], 1200),
        ("ars-rl", &[("ars.directions", "4"), ("ars.noise_std", "0.4"), ("ars.step_size", "0.01")], 1200),
        ("bo-rl", &[("bo.popsize", "5")], 1200),
        ("random-rl", &[("random.popsize", "5")], 1200),
    ];
    for (method, settings, each) in settings {
        let mut assembly = assembly(method, settings).unwrap();
        let sound = run(&assembly, 1).0;
        let faults = Arc::new(AtomicU64::new(0));
        let counted = faults.clone();
        // No number where the motor is driven too fast; the episode ends there.
        spoil(&mut assembly, move |effort, step| {
            if effort[0].abs() <= FASTEST {
                return step;
            }
            counted.fetch_add(1, Ordering::Relaxed);
            Step { reward: f64::NAN, ..step }
        });
        let trained = run(&assembly, 1).0;
        let failed = trained.failed_candidates.unwrap();
        let candidates = trained.iterations * assembly.generation().unwrap().0 as u64;
        assert!(0 < failed && failed < candidates, "{method}: {failed} of {candidates}");
        assert_eq!((trained.iterations, trained.env_steps), (sound.iterations, sound.env_steps), "{method}");
        // Episodes of a training go side by side, so that two of them may fail in one step. The two candidates that another search ends
        // with run 16 episodes more each, which are no candidates.
        let faults_seen = faults.load(Ordering::Relaxed);
        let most = if method.ends_with("-rl") { u64::MAX } else { failed + 2 * 16 };
        assert!((failed..=most).contains(&faults_seen), "{method}: {faults_seen} {failed}");
        assert!(each * candidates <= trained.env_steps);
        assert!(trained.evaluation.discounted_return.mean.is_finite());
        faults.store(0, Ordering::Relaxed);
        evaluate(&assembly, &trained.params, (20, 1), &Serial).unwrap();
        assert_eq!(faults.load(Ordering::Relaxed), 0, "{method} gives a candidate that fails");
    }
}

/// A square of so many parameters would take all memory there is.
#[test]
fn a_covariance_that_would_not_fit_is_refused() {
    let wide = [("controller.hidden", "[100, 100]"), ("train.env_steps", "1000000")];
    let error = assembly("cmaes", &[wide[0], wide[1], ("cmaes.separable", "false")]).err().unwrap();
    assert!(matches!(error, AssembleError::Covariance { parameters } if parameters > 10_000), "{error}");
    assert!(error.to_string().contains("set cmaes.separable = true"), "{error}");
    // What nobody has asked for is no fault.
    let diagonal = assembly("cmaes", &wide).unwrap();
    assert!(diagonal.experiment().cmaes.separable);
    assert!(assembly("cmaes-rl", &[wide[0], wide[1], ("cmaes.popsize", "4")]).is_ok());
}

/// A search said how many candidates failed and nothing of how, and where all did, that they did: a learner tells episode, step
/// and reason.
#[test]
fn failing_candidates_tell_their_cause() {
    for (method, settings) in [
        ("cmaes", &[("search.episodes", "1"), ("cmaes.sigma", "0.5")][..]),
        ("ars", &[("ars.variant", "v2-t"), ("ars.noise_std", "0.5")]),
        ("cmaes-rl", &[("cmaes.popsize", "5")]),
    ] {
        let fail_above = |fastest: f64| {
            let mut assembly = assembly(method, settings).unwrap();
            spoil(
                &mut assembly,
                move |effort, step| {
                    if effort[0].abs() > fastest { Step { reward: f64::NAN, ..step } } else { step }
                },
            );
            train(&assembly, &Serial, &mut (), &AtomicBool::new(false))
        };
        let error = fail_above(-1.0).unwrap_err().to_string();
        assert!(error.starts_with("all ") && error.contains(" candidates of generation 0 failed, "), "{error}");
        // All of the same cause, and the first in the first step of its first episode.
        let counts: Vec<&str> = error.split(' ').filter(|word| word.parse::<u64>().is_ok()).take(3).collect();
        assert_eq!(counts[0], counts[2], "{error}");
        let first = error.split_once(" of them as the first: ").unwrap().1;
        assert!(first.starts_with("episode 0 of iteration 0 (seed "), "{first}");
        assert!(first.ends_with(") failed at step 0: the reward is NaN"), "{first}");

        let some = fail_above(FASTEST).unwrap();
        assert!(some.failed_candidates > Some(0), "{method}");
        let first = some.first_failure.unwrap();
        assert!(first.starts_with("episode ") && first.ends_with(": the reward is NaN"), "{method}: {first}");
    }
}
