//! Problems that a program brings along go through the laboratory as its own do.

#![allow(clippy::unwrap_used)] // a panic is how a test fails

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

use hwasp_core::{DesignGroup, DesignSpace, Dimension, Hardware, Initial, Law, Ports, Serial};
use hwasp_diff::Scalar;
use hwasp_experiment::{Catalogue, Experiment, Layers};
use hwasp_problem::{AnyError, Built, Problem};
use hwasp_runs::{Keeping, Provenance, RunFolder, SavedRun, no_extras};
use hwasp_settings::{Fields, Settings};
use hwasp_tasks::reach::{Reach, ReachSettings};
use hwasp_training::{Assembly, train};

const EXPERIMENT: &str = "name = \"mine\"\n[task]\nproblem = \"my-reach\"\ngoal = \"30 cm\"\n[train]\nenv_steps = 2400\n\
    episode_steps = 30\nevaluation_episodes = 20\n";

/// The reach problem as a stranger would bring it along, with a gear that begins at 0.7.
struct Mine {
    name: &'static str,
    key: &'static str,
    goal: f64,
    optimum: usize,
}

const MINE: Mine = Mine { name: "my-reach", key: "goal", goal: 0.25, optimum: 1 };

#[derive(Clone, Debug, PartialEq)]
struct Goal {
    key: &'static str,
    goal: f64,
}

impl Settings for Goal {
    fn fields(&mut self, fields: &mut Fields<'_, '_>) {
        fields.quantity(self.key, &mut self.goal, Dimension::Length, -1.0..=1.0, "where the point has to be");
    }
}

impl Problem for Mine {
    type Settings = Goal;

    fn name(&self) -> &str {
        self.name
    }

    fn defaults(&self) -> Goal {
        Goal { key: self.key, goal: self.goal }
    }

    fn build(&self, &Goal { goal, .. }: &Goal) -> Result<Built, AnyError> {
        if goal > 0.9 {
            return Err("the rail ends at 0.9 m".into());
        }
        let reach = Reach::new(ReachSettings { goal, initial: Initial::Value(0.7), ..ReachSettings::default() })?;
        Ok(Built { optimum: vec![Some(reach.optimum()); self.optimum], ..Built::new(reach.law(), reach) })
    }
}

fn catalogue() -> Catalogue {
    hwasp_testing::catalogue().clone().with(MINE).unwrap()
}

fn resolve(text: &str) -> Result<Experiment, String> {
    let layers = Layers::from_text("experiment.toml", text).map_err(|e| e.to_string())?;
    hwasp_experiment::resolve(layers, None, &catalogue()).map_err(|e| e.to_string())
}

#[test]
fn settings_horizon_and_start_are_the_experiments() {
    let usual = resolve(EXPERIMENT).unwrap();
    assert_eq!((usual.task.name(), usual.task.horizon), ("my-reach", 30));
    let design = |spec: &Experiment| {
        let assembly = Assembly::new(spec).unwrap();
        assembly.policy.design(&assembly.init())[0]
    };
    assert!((design(&usual) - 0.7).abs() < 1e-6, "where the law begins: {}", design(&usual));
    let set = resolve(&EXPERIMENT.replace("[train]", "horizon = 40\n[design]\ninitial = \"1.5\"\n[train]")).unwrap();
    assert!((design(&set) - 1.5).abs() < 1e-6);
    assert_eq!(Assembly::new(&set).unwrap().worlds.deployment.make.make(None).spec().horizon, 40);

    // What a run folder keeps is the same experiment, the goal with its unit.
    let written = usual.to_toml().unwrap();
    assert!(written.contains("problem = \"my-reach\"\n") && written.contains("goal = \"0.3 m\"\n"), "{written}");
    assert_eq!(resolve(&written).unwrap(), usual);
    assert_eq!(resolve(&set.to_toml().unwrap()).unwrap(), set);
    assert_ne!(resolve(&EXPERIMENT.replace("30 cm", "31 cm")).unwrap(), usual);
}

#[test]
fn it_trains_to_the_bits_of_the_same_problem_from_here() {
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
    let path: PathBuf = Path::new(env!("CARGO_TARGET_TMPDIR")).join("own-problem");
    let _ = fs::remove_dir_all(&path);
    let spec = resolve(EXPERIMENT).unwrap();
    let assembly = Assembly::new(&spec).unwrap();
    let provenance = Provenance::new(vec!["mine".into()], 1, 0);
    let mut folder = RunFolder::create(&path, &spec, &provenance, Keeping::default()).unwrap();
    let trained = train(&assembly, &Serial, &mut folder, &AtomicBool::new(false)).unwrap();
    let summary = folder.finish(&assembly, &trained, &no_extras).unwrap();
    assert_eq!((summary.task.as_str(), summary.design["gear"].optimum), ("my-reach", Some(1.0)));
    assert_eq!(SavedRun::open(&path, &catalogue()).unwrap().params().unwrap(), trained.params);

    // A program without the problem says which it knows.
    let error = SavedRun::open(&path, hwasp_testing::catalogue()).err().unwrap().to_string();
    assert!(error.contains("task.problem = \"my-reach\" is none of `stiffness`"), "{error}");
}

#[test]
fn wrong_settings_are_faults_of_the_file() {
    for (from, to, told) in [
        ("30 cm", "3 m", "task.goal = \"3 m\" is outside [-1 m, 1 m]"),
        ("30 cm", "30 N", "task.goal = \"30 N\" has a unit that measures something else"),
        ("30 cm", "95 cm", "the problem my-reach cannot be built: the rail ends at 0.9 m"),
        ("goal", "gaol", "unknown key `gaol` in [task]"),
        ("my-reach", "my-raech", "did you mean \"my-reach\"?"),
        ("problem = \"my-reach\"\n", "", "set `problem` in [task] to one of `stiffness`"),
    ] {
        let error = resolve(&EXPERIMENT.replace(from, to)).unwrap_err();
        assert!(error.contains(told), "{to}: {error}");
    }
}

#[test]
fn problems_that_cannot_be_are_refused() {
    let told = |mine: Mine| catalogue().with(mine).map(|_| ()).unwrap_err().to_string();
    assert!(told(Mine { name: "reach", ..MINE }).contains("problem `reach`: the name is taken"));
    assert!(told(MINE).contains("problem `my-reach`: the name is taken"));
    assert!(told(Mine { name: "My reach", ..MINE }).contains("the name has other characters"));
    let horizon = told(Mine { name: "a", key: "horizon", ..MINE });
    assert!(horizon.contains("the setting `horizon` has the name of a key that every problem has"), "{horizon}");
    assert_eq!(told(Mine { name: "a", goal: 0.95, ..MINE }), "problem `a`: the rail ends at 0.9 m");
    let optimum = told(Mine { name: "a", optimum: 0, ..MINE });
    assert!(optimum.contains("the optimum of 0 design groups is given, but there are 1"), "{optimum}");
}

/// The reach problem with a design of any groups, of which the first parameter is the gear.
struct Grouped(Vec<(String, usize)>);

struct Gears(DesignSpace);

impl Hardware for Gears {
    fn design(&self) -> &DesignSpace {
        &self.0
    }

    fn ports(&self) -> Ports {
        Reach::new(ReachSettings::default()).unwrap().law().ports().clone()
    }

    fn effort<T: Scalar>(&self, design: &[T], command: &[T], _state: &[T], effort: &mut [T]) {
        effort[0] = design[0] * command[0];
    }
}

impl Problem for Grouped {
    type Settings = ();

    fn name(&self) -> &'static str {
        "grouped"
    }

    fn defaults(&self) {}

    fn build(&self, (): &()) -> Result<Built, AnyError> {
        let group = |(name, count): &(String, usize)| DesignGroup {
            name: name.clone(),
            dimension: Dimension::None,
            lo: 0.1,
            hi: 2.0,
            count: *count,
            initial: Initial::Value(0.7),
        };
        let law = Law::new(Gears(DesignSpace::new(self.0.iter().map(group).collect())?));
        Ok(Built::new(law, Reach::new(ReachSettings::default())?))
    }
}

fn grouped<S: ToString>(groups: &[(S, usize)]) -> Result<Catalogue, String> {
    let groups = groups.iter().map(|(name, count)| (name.to_string(), *count)).collect();
    hwasp_testing::catalogue().clone().with(Grouped(groups)).map_err(|error| error.to_string())
}

/// `check` called a design group sound whose name or whose total a learning curve has no column for, and `train` failed at its first
/// row; so it was with more groups than a learning curve has columns for, and with two whose totals have one name.
#[test]
fn groups_that_no_learning_curve_can_have_are_refused() {
    let long = "a".repeat(59);
    for (name, told) in [
        ("return", "learning curves have a column of this name"),
        ("kl", "learning curves have a column of this name"),
        ("wall_s", "learning curves have a column of this name"),
        ("spring stiffness", "use 1 to 58 letters, digits, `_` and `-`"),
        ("learner.kl", "use 1 to 58 letters, digits, `_` and `-`"),
        ("a,b", "use 1 to 58 letters, digits, `_` and `-`"),
        (&long, "use 1 to 58 letters, digits, `_` and `-`"),
        ("", "use 1 to 58 letters, digits, `_` and `-`"),
    ] {
        let error = grouped(&[("gear", 1), (name, 2)]).unwrap_err();
        assert!(error.contains(&format!("the design group `{name}` cannot be called so: {told}")), "{name}: {error}");
    }
    let error = grouped(&[("x", 2), ("y", 1), ("x_total", 1)]).unwrap_err();
    assert!(error.contains("the design groups `x` and `x_total` would both be the column `x_total`"), "{error}");
    let many = |count| (0..count).map(|i| (format!("gear-{i}"), 1)).collect::<Vec<_>>();
    let error = grouped(&many(65)).unwrap_err();
    assert!(error.contains("its design has 65 groups, and learning curves have columns for 64"), "{error}");

    // What is not refused can be trained: as many as there may be, and totals beside groups of one.
    let mut most = vec![("x".to_owned(), 2), ("x-total".to_owned(), 1), ("a".repeat(58), 2)];
    most.extend(many(61));
    let catalogue = grouped(&most).unwrap();
    let text = EXPERIMENT.replace("my-reach", "grouped").replace("goal = \"30 cm\"\n", "");
    let spec = hwasp_experiment::resolve(Layers::from_text("a.toml", &text).unwrap(), None, &catalogue).unwrap();
    let assembly = Assembly::new(&spec).unwrap();
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join("many-groups");
    let _ = fs::remove_dir_all(&path);
    let provenance = Provenance::new(vec!["mine".into()], 1, 0);
    let mut folder = RunFolder::create(&path, &spec, &provenance, Keeping::default()).unwrap();
    let trained = train(&assembly, &Serial, &mut folder, &AtomicBool::new(false)).unwrap();
    folder.finish(&assembly, &trained, &no_extras).unwrap();
    let saved = SavedRun::open(&path, &catalogue).unwrap();
    assert_eq!(saved.metrics().unwrap().design_totals, assembly.total_names());
}
