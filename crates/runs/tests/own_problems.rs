//! Problems that a program brings along go through the laboratory as its own do.

#![allow(clippy::unwrap_used)] // a panic is how a test fails

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use std::sync::{Mutex, MutexGuard, PoisonError};

use hwasp_core::{Dimension, Initial, Serial};
use hwasp_experiment::{self, Experiment, Layers, OwnProblem, Setting};
use hwasp_runs::{Keeping, Provenance, RunFolder, SavedRun, no_extras};
use hwasp_tasks::reach::{Reach, ReachSettings};
use hwasp_training::{Assembly, Problems, train};

const EXPERIMENT: &str = "name = \"mine\"\n[task]\nproblem = \"my-reach\"\ngoal = \"30 cm\"\n[train]\nenv_steps = 2400\n\
    episode_steps = 30\nevaluation_episodes = 20\n";

/// What is registered holds for the whole process, in which these tests run beside each other.
fn alone() -> MutexGuard<'static, ()> {
    static ALONE: Mutex<()> = Mutex::new(());
    ALONE.lock().unwrap_or_else(PoisonError::into_inner)
}

fn goal() -> Setting {
    Setting { name: "goal", dimension: Dimension::Length, default: 0.25, limits: -1.0..=1.0 }
}

/// The reach problem as a stranger would bring it along, with a gear that begins at 0.7.
fn mine(name: &'static str, settings: [Setting; 1]) -> OwnProblem {
    OwnProblem::new(name, settings, |[goal]| {
        if goal > 0.9 {
            return Err("the rail ends at 0.9 m".into());
        }
        let reach = Reach::new(ReachSettings { goal, initial: Initial::Value(0.7), ..ReachSettings::default() })?;
        Ok(Problems { optimum: vec![Some(reach.optimum())], ..Problems::new(reach.law(), reach) })
    })
}

fn resolve(text: &str) -> Result<Experiment, String> {
    let layers = Layers::from_text("experiment.toml", text).map_err(|e| e.to_string())?;
    spec::resolve(layers, None).map_err(|e| e.to_string())
}

#[test]
fn settings_horizon_and_start_are_the_experiments() {
    let _alone = alone();
    spec::register([mine("my-reach", [goal()])]).unwrap();
    let usual = resolve(EXPERIMENT).unwrap();
    assert_eq!((usual.task.name(), usual.task.horizon), ("my-reach", 30));
    let design = |spec: &Experiment| {
        let assembly = Assembly::new(spec).unwrap();
        assembly.policy.design(&assembly.init())[0]
    };
    assert!((design(&usual) - 0.7).abs() < 1e-6, "where the law begins: {}", design(&usual));
    let set = resolve(&EXPERIMENT.replace("[train]", "horizon = 40\n[design]\ninitial = \"1.5\"\n[train]")).unwrap();
    assert!((design(&set) - 1.5).abs() < 1e-6);
    assert_eq!(Assembly::new(&set).unwrap().problem.deployment.make.make(None).spec().horizon, 40);

    // What a run folder keeps is the same experiment, the goal with its unit.
    let written = usual.to_toml().unwrap();
    assert!(written.contains("problem = \"my-reach\"\n") && written.contains("goal = \"0.3 m\"\n"), "{written}");
    assert_eq!(resolve(&written).unwrap(), usual);
    assert_eq!(resolve(&set.to_toml().unwrap()).unwrap(), set);
    assert_ne!(resolve(&EXPERIMENT.replace("30 cm", "31 cm")).unwrap(), usual);
}

#[test]
fn it_trains_to_the_bits_of_the_same_problem_from_here() {
    let _alone = alone();
    spec::register([mine("my-reach", [goal()])]).unwrap();
    let design = "[design]\ninitial = \"0.7\"\n[noise]\neffort = \"0.1 m/s\"\n[train]";
    let text = EXPERIMENT.replace("[train]", design);
    let trained = |text: &str| {
        let assembly = Assembly::new(&resolve(text).unwrap()).unwrap();
        train(&assembly, &Serial, &mut (), &AtomicBool::new(false)).unwrap().params
    };
    assert_eq!(trained(&text), trained(&text.replace("my-reach", "reach")));
}

#[test]
fn its_run_folder_is_read_back() {
    let _alone = alone();
    spec::register([mine("my-reach", [goal()])]).unwrap();
    let path: PathBuf = Path::new(env!("CARGO_TARGET_TMPDIR")).join("own-problem");
    let _ = fs::remove_dir_all(&path);
    let spec = resolve(EXPERIMENT).unwrap();
    let assembly = Assembly::new(&spec).unwrap();
    let provenance = Provenance::new(vec!["mine".into()], 1, 0);
    let mut folder = RunFolder::create(&path, &spec, &provenance, Keeping::default()).unwrap();
    let trained = train(&assembly, &Serial, &mut folder, &AtomicBool::new(false)).unwrap();
    let summary = folder.finish(&assembly, &trained, &no_extras).unwrap();
    assert_eq!((summary.task.as_str(), summary.design["gear"].optimum), ("my-reach", Some(1.0)));
    assert_eq!(SavedRun::open(&path).unwrap().params().unwrap(), trained.params);

    // A program without the problem says which it knows.
    spec::register([]).unwrap();
    let error = SavedRun::open(&path).err().unwrap().to_string();
    assert!(error.contains("task.problem = \"my-reach\" is none of `stiffness`"), "{error}");
}

#[test]
fn wrong_settings_are_faults_of_the_file() {
    let _alone = alone();
    spec::register([mine("my-reach", [goal()])]).unwrap();
    for (from, to, told) in [
        ("30 cm", "3 m", "task.goal = \"3 m\" is outside [-1 m, 1 m]"),
        ("30 cm", "30 N", "task.goal = \"30 N\" has a unit that measures something else"),
        ("30 cm", "95 cm", "the problem my-reach cannot be built: the rail ends at 0.9 m"),
        ("goal", "gaol", "unknown key `gaol` in [task]"),
        ("my-reach", "my-raech", "did you mean \"my-reach\"?"),
        ("problem = \"my-reach\"\n", "", "set `problem` in [task] to one of `my-reach`, `stiffness`"),
    ] {
        let error = resolve(&EXPERIMENT.replace(from, to)).unwrap_err();
        assert!(error.contains(told), "{to}: {error}");
    }
}

#[test]
fn problems_that_cannot_be_are_refused() {
    let _alone = alone();
    spec::register([mine("my-reach", [goal()])]).unwrap();
    let told = |problem: OwnProblem| spec::register([problem]).unwrap_err().to_string();
    assert!(told(mine("reach", [goal()])).contains("a problem that comes with hwasp has this name"));
    assert!(told(mine("My reach", [goal()])).contains("the name has other characters"));
    let horizon = Setting { name: "horizon", ..goal() };
    assert!(told(mine("a", [horizon])).contains("the setting `horizon` has the name of a key that every problem has"));
    let beyond = Setting { default: 2.0, ..goal() };
    assert!(told(mine("a", [beyond])).contains("is 2 m by default, which is not inside [-1 m, 1 m]"));
    let unbuilt = Setting { default: 0.95, ..goal() };
    assert_eq!(told(mine("a", [unbuilt])), "problem `a`: the rail ends at 0.9 m");
    let optimum = OwnProblem::new("a", [], |[]| {
        let reach = Reach::new(ReachSettings::default())?;
        Ok(Problems { optimum: Vec::new(), ..Problems::new(reach.law(), reach) })
    });
    assert!(told(optimum).contains("the optimum of 0 design groups is given, but there are 1"));
    let twice = spec::register([mine("a", [goal()]), mine("a", [goal()])]).unwrap_err().to_string();
    assert!(twice.contains("two problems have this name"), "{twice}");
    // What was there before is there still.
    assert_eq!(spec::registered().iter().map(|own| own.name()).collect::<Vec<_>>(), ["my-reach"]);
}
