//! Run folders: what is in them, and what can be had back from them.

#![allow(clippy::unwrap_used)] // helpers of tests are tests too

use std::collections::BTreeSet;
use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

use hwasp_core::{Executor, Serial, Threads};
use hwasp_experiment::{self, Experiment};
use hwasp_runs::metrics::MetricsTable;
use hwasp_runs::{Keeping, Provenance, RunError, RunFolder, SavedRun, Summary, no_extras};
use hwasp_training::{Assembly, Event, MetricsRow, Observer, ObserverError, evaluate, train};

const SETTINGS: &[(&str, &str)] = &[("train.env_steps", "2400"), ("train.evaluation_episodes", "20")];

fn experiment(name: &str, method: Option<&str>, settings: &[(&str, &str)]) -> Experiment {
    let layers = hwasp_testing::layers(name);
    let layers = settings.iter().fold(layers, |layers, (key, value)| layers.with_override(key, value));
    hwasp_testing::resolve(layers, method).unwrap()
}

fn empty(name: &str) -> PathBuf {
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join("run-folders").join(name);
    let _ = fs::remove_dir_all(&path);
    path
}

fn provenance(spec: &Experiment) -> Provenance {
    Provenance::new(vec!["hwasp".into(), "train".into(), "a \"name\"".into()], 1, spec.seed)
}

fn run_with(path: &Path, spec: &Experiment, executor: &dyn Executor) -> Summary {
    let assembly = Assembly::new(spec).unwrap();
    let mut folder = RunFolder::create(path, spec, &provenance(spec), Keeping::default()).unwrap();
    assert_eq!(folder.path(), path);
    let trained = train(&assembly, executor, &mut folder, &AtomicBool::new(false)).unwrap();
    folder.finish(&assembly, &trained, &no_extras).unwrap()
}

fn run(path: &Path, spec: &Experiment) -> Summary {
    run_with(path, spec, &Serial)
}

fn rows(path: &Path) -> Vec<MetricsRow> {
    let table = MetricsTable::read(File::open(path.join("metrics.csv")).unwrap()).unwrap();
    table.rows.into_iter().map(|row| MetricsRow { wall_s: 0.0, ..row }).collect()
}

fn json(path: PathBuf) -> serde_json::Value {
    serde_json::from_slice(&fs::read(path).unwrap()).unwrap()
}

fn files(path: &Path) -> BTreeSet<String> {
    fs::read_dir(path).unwrap().map(|file| file.unwrap().file_name().into_string().unwrap()).collect()
}

const ALL: [&str; 8] = [
    ".lock",
    "checkpoints",
    "design.toml",
    "experiment.toml",
    "metrics.csv",
    "policy.safetensors",
    "provenance.json",
    "summary.json",
];

#[test]
fn every_file_is_there_and_well_formed() {
    let path = empty("files");
    let settings = [("train.env_steps", "8000"), ("train.evaluation_episodes", "3"), ("seed", "7")];
    let spec = experiment("bar-length", Some("hwasp"), &settings);
    let summary = run(&path, &spec);
    assert_eq!(files(&path), ALL.map(str::to_owned).into());

    let provenance = json(path.join("provenance.json"));
    assert_eq!(provenance["command_line"], serde_json::json!(["hwasp", "train", "a \"name\""]));
    assert_eq!((&provenance["seed"], &provenance["threads"]), (&7.into(), &1.into()));
    assert_eq!(provenance["hwasp_version"], env!("CARGO_PKG_VERSION"));
    assert!(provenance["started_unix_s"].as_u64().unwrap() > 1_700_000_000);

    let table = MetricsTable::read(File::open(path.join("metrics.csv")).unwrap()).unwrap();
    assert_eq!(table.design_totals, ["length_total"]);
    assert_eq!(table.rows.iter().map(|row| row.env_steps).collect::<Vec<_>>(), [4000, 8000]);

    // Figures agree between the files, and with the parameters.
    let read = json(path.join("summary.json"));
    for key in ["experiment", "method", "task", "seed", "env_steps", "wall_s", "steps_per_s", "evaluation"] {
        assert!(!read[key].is_null(), "{key} in {read}");
    }
    assert_eq!((&read["method"], &read["task"], &read["seed"]), (&"hwasp".into(), &"bar-length".into(), &7.into()));
    let design: toml::Table = fs::read_to_string(path.join("design.toml")).unwrap().parse().unwrap();
    let length = design["length"].as_table().unwrap();
    assert_eq!(length["unit"].as_str(), Some("m"));
    let saved = SavedRun::open(&path, hwasp_testing::catalogue()).unwrap();
    let values = saved.assembly().policy.design(&saved.params().unwrap());
    let written: Vec<f64> = length["values"].as_array().unwrap().iter().map(|v| v.as_float().unwrap()).collect();
    assert_eq!(written, values);
    assert_eq!(length["total"].as_float(), Some(table.rows[1].design_totals[0]));
    assert_eq!(summary.design["length"].values, values);
    // The interface of the trained bar is soft: what is built is another length.
    assert_ne!(length["total"], length["total_as_built"]);
}

/// A run that has a summary is taken for finished: whatever else belongs to it is there by then.
#[test]
fn further_files_come_before_the_summary() {
    let path = empty("extras");
    let spec = experiment("reach", None, SETTINGS);
    let assembly = Assembly::new(&spec).unwrap();
    let mut folder = RunFolder::create(&path, &spec, &provenance(&spec), Keeping::default()).unwrap();
    let trained = train(&assembly, &Serial, &mut folder, &AtomicBool::new(false)).unwrap();
    let error = folder.finish(&assembly, &trained, &|_| Err("no ink".into())).unwrap_err();
    assert!(matches!(&error, RunError::Extra(_)) && error.to_string() == "no ink", "{error}");
    assert!(!path.join("summary.json").exists());
    let rows = |saved: &SavedRun| {
        assert!(!path.join("summary.json").exists());
        Ok(vec![("rows.txt".to_owned(), saved.metrics()?.rows.len().to_string().into_bytes())])
    };
    folder.finish(&assembly, &trained, &rows).unwrap();
    assert_eq!(fs::read_to_string(path.join("rows.txt")).unwrap(), trained.iterations.to_string());
    assert!(path.join("summary.json").exists());
}

#[test]
fn the_experiment_in_the_folder_repeats_the_run_bit_by_bit() {
    let placements = [("design.placements", r#"{ "stiffness[2..5]" = "action", "stiffness[0]" = "fixed" }"#)];
    let few = [("train.env_steps", "8000"), ("train.evaluation_episodes", "3")];
    let mixed = [&placements[..], &few].concat();
    for (name, experiment) in [
        ("hwasp", experiment("reach", Some("hwasp"), SETTINGS)),
        ("minimal", experiment("reach", Some("minimal"), SETTINGS)),
        ("fixed", experiment("reach", Some("fixed"), SETTINGS)),
        ("mixed", experiment("mass-spring", None, &mixed)),
        ("paper", experiment("paper/bar-length", None, &few[1..])),
    ] {
        // The authors' iterations are long: one of them.
        let experiment = if name == "paper" { one_iteration(experiment) } else { experiment };
        let (first, second) = (empty(&format!("first-{name}")), empty(&format!("second-{name}")));
        let summary = run(&first, &experiment);
        let again =
            hwasp_testing::resolve(hwasp_testing::layers(first.join("experiment.toml").to_str().unwrap()), None)
                .unwrap();
        assert_eq!(again, experiment, "{name}");
        let repeated = run(&second, &again);
        assert_eq!(summary.evaluation, repeated.evaluation, "{name}");
        assert_eq!(rows(&first), rows(&second), "{name}");
        for file in ["experiment.toml", "policy.safetensors", "design.toml"] {
            assert_eq!(fs::read(first.join(file)).unwrap(), fs::read(second.join(file)).unwrap(), "{name}: {file}");
        }
    }
}

fn one_iteration(mut spec: Experiment) -> Experiment {
    spec.train.env_steps = spec.train.rows() as u64;
    spec
}

#[test]
fn the_number_of_threads_changes_no_file_but_the_provenance() {
    let spec = experiment("reach", None, SETTINGS);
    let (one, two) = (empty("one-thread"), empty("two-threads"));
    run(&one, &spec);
    run_with(&two, &spec, &Threads::new(2).unwrap());
    for file in ["experiment.toml", "policy.safetensors", "design.toml"] {
        assert_eq!(fs::read(one.join(file)).unwrap(), fs::read(two.join(file)).unwrap(), "{file}");
    }
    assert_eq!(rows(&one), rows(&two));
}

#[test]
fn a_saved_run_evaluates_to_what_its_summary_says() {
    for (name, method) in [("mass-spring", "hwasp"), ("bar-length", "minimal"), ("reach", "fixed")] {
        let path = empty(&format!("evaluated-{name}"));
        let spec = experiment(name, Some(method), &[("train.env_steps", "4000"), ("train.evaluation_episodes", "20")]);
        let summary = run(&path, &spec);
        let saved = SavedRun::open(&path, hwasp_testing::catalogue()).unwrap();
        let settings = &saved.assembly().experiment().train;
        let asked = (settings.evaluation_episodes as u64, settings.evaluation_seed);
        let evaluation = evaluate(saved.assembly(), &saved.params().unwrap(), asked, &Serial).unwrap();
        assert_eq!(evaluation, summary.evaluation, "{name}");
        // JSON is read back by the same parser on both sides, so that its last digit is no difference.
        let text = serde_json::to_string(&evaluation).unwrap();
        let again: serde_json::Value = serde_json::from_str(&text).unwrap();
        assert_eq!(again, json(path.join("summary.json"))["evaluation"], "{name}");
    }
}

#[test]
fn a_folder_with_something_in_it_is_not_touched() {
    let path = empty("occupied");
    let spec = experiment("reach", None, SETTINGS);
    fs::create_dir_all(&path).unwrap();
    fs::write(path.join("thesis.tex"), "precious").unwrap();
    let error = RunFolder::create(&path, &spec, &provenance(&spec), Keeping::default()).unwrap_err();
    assert!(matches!(&error, RunError::Exists { path: found } if *found == path), "{error}");
    assert_eq!(files(&path), ["thesis.tex".to_owned()].into());
    assert_eq!(fs::read_to_string(path.join("thesis.tex")).unwrap(), "precious");
}

#[test]
fn names_are_numbered_where_they_are_taken() {
    let root = empty("names");
    let spec = experiment("paper/mass-spring", Some("minimal"), &[("seed", "4")]);
    for name in
        ["paper-mass-spring-minimal-seed4", "paper-mass-spring-minimal-seed4-2", "paper-mass-spring-minimal-seed4-3"]
    {
        let free = RunFolder::free_name(&root, &spec);
        assert_eq!(free, root.join(name));
        fs::create_dir_all(free).unwrap();
    }
}

#[test]
fn an_experiment_cannot_name_a_folder_outside_of_the_root() {
    let root = empty("escape");
    for name in ["../../evil", "/etc/evil", "..\\evil"] {
        let spec = experiment("reach", None, &[("name", name)]);
        let free = RunFolder::free_name(&root, &spec);
        assert_eq!(free.parent(), Some(&*root), "{}", free.display());
    }
}

#[test]
fn a_folder_that_vanishes_is_made_again() {
    let path = empty("vanished");
    let spec = experiment("reach", None, SETTINGS);
    let assembly = Assembly::new(&spec).unwrap();
    let mut folder = RunFolder::create(&path, &spec, &provenance(&spec), Keeping::default()).unwrap();
    let trained = train(&assembly, &Serial, &mut Vanishing { folder: &mut folder }, &AtomicBool::new(false)).unwrap();
    folder.finish(&assembly, &trained, &no_extras).unwrap();
    // The rows before that are gone, and nothing else.
    assert_eq!(rows(&path).iter().map(|row| row.iteration).collect::<Vec<_>>(), [1]);
    assert_eq!(files(&path), ALL[1..].iter().map(|&file| file.to_owned()).collect());
    assert!(SavedRun::open(&path, hwasp_testing::catalogue()).unwrap().params().is_ok());
}

/// Someone removes the folder after the first iteration.
struct Vanishing<'a> {
    folder: &'a mut RunFolder,
}

impl Observer for Vanishing<'_> {
    fn on(&mut self, event: Event<'_>) -> Result<(), ObserverError> {
        self.folder.on(event)?;
        if let Event::Iteration(MetricsRow { iteration: 0, .. }) = event {
            fs::remove_dir_all(self.folder.path()).unwrap();
        }
        Ok(())
    }
}

#[test]
fn a_run_that_has_not_finished_says_so() {
    let path = empty("begun");
    let spec = experiment("reach", None, SETTINGS);
    RunFolder::create(&path, &spec, &provenance(&spec), Keeping::default()).unwrap();
    let saved = SavedRun::open(&path, hwasp_testing::catalogue()).unwrap();
    assert!(matches!(saved.params(), Err(RunError::Unfinished { file: "policy.safetensors", .. })));
    assert!(matches!(
        SavedRun::open(&path.join(".."), hwasp_testing::catalogue()),
        Err(RunError::NotARun { file: "experiment.toml", .. })
    ));
}
