//! Schedules: how much of training is done, as environments and learners are told.

#![allow(clippy::unwrap_used)] // helpers of tests are tests too

use std::sync::{Arc, Mutex};

use hwasp_core::{Environment, Step, Watch, Watched};
use hwasp_experiment::{Files, Folder, Layers};
use hwasp_testing::{OFF_POLICY, POLISH, executor, run, small};
use hwasp_training::{Assembly, evaluate};

/// Writes down how much of training is done at each start.
struct Recording {
    told: Arc<Mutex<Vec<f64>>>,
}

impl Watch for Recording {
    fn set_progress(&mut self, inner: &mut dyn Environment, progress: f64) {
        self.told.lock().unwrap().push(progress);
        inner.set_progress(progress);
    }

    fn step(&mut self, inner: &mut dyn Environment, effort: &[f64], command: &[f64]) -> Step {
        inner.step(effort, command)
    }
}

/// An assembly whose training episodes are written down.
fn recorded(method: &str, settings: hwasp_testing::Settings) -> (Assembly, Arc<Mutex<Vec<f64>>>) {
    let mut assembly = Assembly::new(&small(method, settings)).unwrap();
    let (told, whole) = (Arc::new(Mutex::new(Vec::new())), assembly.worlds.training.make.clone());
    let recording = Arc::clone(&told);
    assembly.worlds.training.make = Arc::new(move |horizon| {
        Box::new(Watched::new(whole.make(horizon), Recording { told: Arc::clone(&recording) })) as Box<dyn Environment>
    });
    (assembly, told)
}

/// Searches trained at progress 0 from the first generation to the last: `cmaes` and `ars` saw nothing but the easiest objects
/// of a curriculum, noise stayed as it was at the beginning, and even the last choice was made so.
#[test]
fn a_search_gets_on() {
    for (method, settings) in [("cmaes", &[][..]), ("ars", &[("ars.directions", "8")][..])] {
        let (assembly, told) = recorded(method, settings);
        let rows = run(&assembly, None, 1).1.rows;
        let train = &assembly.experiment().train;
        // A generation is as far as the steps before it.
        let before = std::iter::once(0).chain(rows.iter().map(|row| row.env_steps));
        let mut expected: Vec<f64> = before.take(rows.len()).map(|steps| train.progress(steps)).collect();
        // The choice at the end is for what comes after training.
        expected.push(1.0);
        let mut told = std::mem::take(&mut *told.lock().unwrap());
        told.dedup();
        assert_eq!(told, expected, "{method}");
        assert!(expected.len() > 3 && expected[1] > 0.0, "{method}: {expected:?}");
    }
}

/// Further training on parts that can be bought began its schedules anew: the first iterations were at progress 0, with the
/// learning rate of the first steps.
#[test]
fn a_training_begins_where_its_schedules_are_to_begin() {
    let (assembly, told) = recorded("hwasp", &[("train.progress_start", "0.5")]);
    run(&assembly, None, 1);
    let mut half = std::mem::take(&mut *told.lock().unwrap());
    half.dedup();
    let expected: Vec<f64> = (0..8).map(|iteration| 0.5 + 0.5 * (f64::from(iteration) / 8.0)).collect();
    assert_eq!(half, expected);

    // At the end of every schedule nothing is left of the learning rate here, so that nothing is learned.
    let end = &[("train.progress_start", "1.0"), ("ppo.learning_rate_final", "0.0")];
    let (assembly, told) = recorded("hwasp", end);
    let trained = run(&assembly, None, 1).0;
    assert!(told.lock().unwrap().iter().all(|&progress| progress == 1.0));
    assert_eq!(trained.params, assembly.init());
    let (assembly, _) = recorded("hwasp", &[("ppo.learning_rate_final", "0.0")]);
    assert_ne!(run(&assembly, None, 1).0.params, assembly.init());
}

/// The schedules of a main stage end with it, and those of its polish go from `progress_start` to their end.
#[test]
fn a_polish_has_schedules_of_its_own() {
    let (mut assembly, told) = recorded("hwasp", POLISH);
    assembly.worlds.deployment = assembly.worlds.training.clone();
    run(&assembly, None, 1);
    let mut told = std::mem::take(&mut *told.lock().unwrap());
    told.dedup();
    // Of 9600 steps 5760 are five iterations, the last of 960 steps, and 3840 are three.
    let main = (0..5).map(|k| f64::from(1200 * k) / 5760.0);
    let polish = (0..3).map(|k| 0.2 + (1.0 - 0.2) * (f64::from(1200 * k) / 3840.0));
    // And the evaluation.
    assert_eq!(told, main.chain(polish).chain([1.0]).collect::<Vec<_>>());
}

/// A design that moved before its controller could do anything ran away to where no controller gets it back.
#[test]
fn under_td3_a_design_may_wait_for_its_controller() {
    let own = [("td3.warmup_steps", "500"), ("td3.design_start", "0.5"), ("train.env_steps", "9600")];
    let all = OFF_POLICY.iter().chain(&own).chain(&[("train.evaluation_episodes", "4")]);
    let layers = all.fold(hwasp_testing::layers("reach"), |layers, (key, value)| layers.with_override(key, value));
    let assembly = Assembly::new(&hwasp_testing::resolve(layers, None).unwrap()).unwrap();
    let (trained, kept) = run(&assembly, None, 1);
    let totals: Vec<f64> = kept.rows.iter().map(|row| row.design_totals[0]).collect();
    // The fifth iteration of 1200 steps begins half way.
    assert!(totals[..4].iter().all(|&total| total == totals[0]), "{totals:?}");
    assert_ne!(totals[4], totals[0]);
    assert_ne!(trained.params, assembly.init());
}

/// A robot from text is rewarded by how much of training is done; evaluated it is at the end, however early that is.
#[test]
fn formulas_know_the_progress_of_training_and_evaluations_its_end() {
    let model = r#"<mujoco><worldbody><body><joint name="a"/><geom size="0.1"/></body></worldbody>
        <actuator><motor name="a" joint="a" ctrlrange="-1 1"/></actuator></mujoco>"#;
    let text = "name = \"late\"\n[task]\nproblem = \"model\"\nmodel = \"a.xml\"\nhorizon = 10\nobserve = [\"qpos\"]\n\
                [task.reward]\nprogress = \"progress\"\n[train]\nenv_steps = 400\nepisodes_per_iteration = 10\nepisode_steps = 10\n";
    let files = Files::from([("a.xml".to_owned(), Arc::from(model.as_bytes()))]);
    let layers = Layers::from_text("late.toml", text).unwrap().with_folder(Folder::Sent(Arc::new(files)));
    let experiment = hwasp_testing::resolve(layers, Some("fixed")).unwrap_or_else(|faults| panic!("{faults}"));
    let assembly = Assembly::new(&experiment).unwrap();
    let (trained, keeper) = run(&assembly, None, 1);
    let returns: Vec<f64> = keeper.rows.iter().map(|row| row.undiscounted_return).collect();
    assert!(returns.len() == 4, "{returns:?}");
    for (found, progress) in returns.iter().zip([0.0, 0.25, 0.5, 0.75]) {
        assert!((found - 10.0 * progress).abs() < 1e-5, "{returns:?}");
    }
    let evaluation = evaluate(&assembly, &trained.params, (5, 1), &*executor(1)).unwrap();
    assert_eq!(evaluation.undiscounted_return.mean, 10.0);
}
