//! Parts in simulation: what snapping changes, the same for any number of threads, and the controller trained further.

#![allow(clippy::unwrap_used)] // a panic is how a test fails

use std::path::PathBuf;
use std::sync::atomic::AtomicBool;

use hwasp_core::{Executor, Serial};
use hwasp_experiment::{Experiment, Place};
use hwasp_runs::{Provenance, RunError, SavedRun, no_extras};
use hwasp_testing::executor;
use hwasp_training::{Assembly, LocalCollector, evaluate, evaluate_in, params_at, train, train_from};
use hwasp_workshop::parts::{
    PartsError, PartsList, SHEET, Snapped, SpringCatalogue, Tuning, TuningFolder, Workshop, snap,
};

fn empty(name: &str) -> PathBuf {
    hwasp_testing::empty(env!("CARGO_TARGET_TMPDIR"), name)
}

fn provenance(spec: &Experiment) -> Provenance {
    Provenance::new(vec!["test".into()], 1, spec.seed)
}

const ASKED: (u64, u64) = (6, 5);

/// A small hand, and a training that has been for two iterations.
fn run() -> (Assembly, Vec<f32>) {
    let small = [
        ("task.horizon", "60"),
        ("task.shapes", "[\"sphere\"]"),
        ("task.size", "\"60 mm\""),
        ("task.height", "\"100 mm\""),
        ("design.logit_half_width", "0.5"),
        ("controller.hidden", "[16]"),
        ("train.episode_steps", "60"),
        ("train.episodes_per_iteration", "8"),
        ("train.env_steps", "960"),
        ("train.evaluation_episodes", "2"),
        ("ppo.minibatch_rows", "60"),
        ("baseline.minibatch_rows", "60"),
    ];
    let layers =
        small.iter().fold(hwasp_testing::layers("z-grasp"), |layers, (key, value)| layers.with_override(key, value));
    let assembly = Assembly::new(&hwasp_testing::resolve(layers, Some("hwasp")).unwrap()).unwrap();
    let trained = train(&assembly, &Serial, &mut (), &AtomicBool::new(false)).unwrap();
    (assembly, trained.params)
}

fn snapped(assembly: &Assembly, params: &[f32]) -> Snapped {
    snap(assembly, params, &SpringCatalogue::built_in().unwrap(), &Workshop::default()).unwrap()
}

fn list(assembly: &Assembly, params: &[f32], executor: &dyn Executor) -> PartsList {
    let snapped = snapped(assembly, params);
    let collector = LocalCollector::new(assembly, executor).unwrap();
    let worth = snapped.judge(assembly, params, ASKED, &collector).unwrap().worth().clone();
    snapped.list(assembly, worth)
}

#[test]
fn snapping_changes_the_design_by_what_is_told() {
    let (assembly, params) = run();
    let list = list(&assembly, &params, &Serial);
    let trained = assembly.policy.design(&params);
    assert_eq!(list.design.iter().map(|d| d.trained).collect::<Vec<_>>(), trained);
    for (i, parameter) in list.design.iter().enumerate() {
        let joint = &list.joints[i % 4];
        let (told, wanted) = match i / 4 {
            0 => (joint.built.radius, joint.trained.radius),
            1 => (joint.built.stiffness, joint.trained.stiffness),
            _ => (joint.built.preload, joint.trained.preload),
        };
        assert_eq!((parameter.built, parameter.trained), (told, wanted), "{}", parameter.name);
        assert!(parameter.name.starts_with(&joint.joint), "{}", parameter.name);
    }
    assert!(list.design.iter().all(|d| d.built != d.trained));
    // What is said of it is what it is worth: the numbers of an evaluation.
    assert_eq!(list.worth.trained, evaluate(&assembly, &params, ASKED, &Serial).unwrap());
    let built: Vec<f64> = list.design.iter().map(|d| d.built).collect();
    let on_parts = evaluate_in(&assembly, &assembly.worlds.deployment, &built, &params, ASKED, &Serial).unwrap();
    assert_eq!(list.worth.snapped, on_parts);
    let difference = on_parts.undiscounted_return.mean - list.worth.trained.undiscounted_return.mean;
    assert!((list.worth.snapping.undiscounted_return.mean - difference).abs() < 1e-9 && difference != 0.0);

    // Files read back, whatever the number of threads.
    assert_eq!(list, self::list(&assembly, &params, &*executor(2)));
    let folder = empty("parts-written");
    list.write(&folder).unwrap();
    let json = std::fs::read_to_string(folder.join("parts.json")).unwrap();
    assert_eq!(serde_json::from_str::<PartsList>(&json).unwrap(), list);
    let sheet = std::fs::read_to_string(folder.join(SHEET)).unwrap();
    for joint in &list.joints {
        assert!(sheet.contains(&format!("2 × {}", joint.spring.part)), "{sheet}");
    }
    assert!(sheet.contains(&format!("groove radius {:.2}", 1e3 * list.joints[2].pulley.groove_radius)), "{sheet}");
}

#[test]
fn a_controller_is_trained_further_on_parts() {
    let (assembly, params) = run();
    let snapped = snapped(&assembly, &params);
    assert!(matches!(
        Tuning::new(&assembly, &params, &snapped.built, 479, ASKED),
        Err(PartsError::ShortTuning { env_steps: 479, rows: 480 })
    ));
    let tuning = Tuning::new(&assembly, &params, &snapped.built, 960, ASKED).unwrap();
    let (spec, path) = (tuning.assembly.experiment(), empty("parts-tuned"));
    assert_eq!((spec.design.placement, spec.train.env_steps), (Place::Fixed, 960));
    assert_eq!((spec.train.progress_start, spec.noise.command_final.clone()), (1.0, None));

    let TuningFolder::Open(mut folder, from) = tuning.folder(&path, provenance(spec)).unwrap() else { panic!() };
    // It begins with the run's controller on the built hand, and so it is from the first moment on: that is in the folder.
    let start = params_at(&tuning.assembly, &from).unwrap();
    assert_eq!(tuning.assembly.policy.controller_params(&start), assembly.policy.controller_params(&params));
    assert_eq!(tuning.assembly.policy.design(&start), snapped.built);
    assert_eq!(SavedRun::open(&path, hwasp_testing::catalogue()).unwrap().params().unwrap(), start);
    let collector = LocalCollector::new(&assembly, &Serial).unwrap();
    let judge = snapped.judge(&assembly, &params, ASKED, &collector).unwrap();
    assert_eq!(judge.worth().snapped, evaluate(&tuning.assembly, &start, ASKED, &Serial).unwrap());

    // Interrupted before the first iteration, it goes on from the same.
    drop(folder);
    let TuningFolder::Open(again, from_again) = tuning.folder(&path, provenance(spec)).unwrap() else { panic!() };
    assert_eq!(from_again, from);
    folder = again;

    let trained = train_from(Some(&from), &tuning.assembly, &Serial, &mut *folder, &AtomicBool::new(false)).unwrap();
    assert_eq!(trained.env_steps, 960);
    folder.finish(&tuning.assembly, &trained, &no_extras).unwrap();
    drop(folder);
    let saved = SavedRun::open(&path, hwasp_testing::catalogue()).unwrap();
    assert_eq!(saved.assembly().experiment(), spec);
    let worth = judge.tuned(&trained.params, "tuned", 960).unwrap().tuned.unwrap();
    assert_eq!(worth.evaluation, trained.evaluation);
    assert_eq!(worth.evaluation, evaluate(saved.assembly(), &saved.params().unwrap(), ASKED, &Serial).unwrap());

    // Called again it is there; another training in its place is not touched.
    let there = tuning.folder(&path, provenance(spec)).unwrap();
    assert!(matches!(there, TuningFolder::Finished(params) if params == trained.params));
    let longer = Tuning::new(&assembly, &params, &snapped.built, 1440, ASKED).unwrap();
    let taken = longer.folder(&path, provenance(longer.assembly.experiment()));
    assert!(matches!(taken, Err(RunError::Exists { .. })));
}
