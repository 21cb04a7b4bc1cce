//! Comparisons: a killed one goes on and ends with the same figures, and a folder of another one is refused.

#![allow(clippy::unwrap_used)] // helpers of tests are tests too

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::AtomicBool;

use hwasp_core::{Serial, Threads};
use hwasp_study::{self as study, CompareError, Comparison, Contender, Grid, Outcome, Watch, Work};
use hwasp_training::{Event, TrainError};

fn grid(methods: &[&str], clip: &str) -> Grid {
    let settings = [("train.evaluation_episodes", "20"), ("train.env_steps", "12000"), ("ppo.clip_ratio", clip)];
    let layers = settings.iter().fold(hwasp_testing::layers("reach"), |layers, (k, v)| layers.with_override(k, v));
    Grid { layers, contenders: methods.iter().map(|m| Contender::parse(m).unwrap()).collect(), seeds: 0..3 }
}

fn empty(name: &str) -> PathBuf {
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join("comparisons").join(name);
    let _ = fs::remove_dir_all(&path);
    path
}

/// Counts the cells that were there and those that were trained; sets `stop` after some.
#[derive(Default)]
struct Counter {
    old: Mutex<usize>,
    trained: Mutex<usize>,
    stop: AtomicBool,
    stop_after: Option<usize>,
}

impl Watch for Counter {
    fn grid(&self, cells: &[(String, u64, bool)]) {
        *self.old.lock().unwrap() = cells.iter().filter(|cell| cell.2).count();
    }
    fn cell(&self, _: usize, event: Event<'_>) {
        if let Event::Evaluated(_) = event {
            let mut trained = self.trained.lock().unwrap();
            *trained += 1;
            if self.stop_after.is_some_and(|most| *trained >= most) {
                self.stop.store(true, std::sync::atomic::Ordering::Relaxed);
            }
        }
    }
    fn failed(&self, _: usize, error: &TrainError) {
        panic!("{error}");
    }
}

fn run(grid: &Grid, folder: &Path, watch: &Counter) -> Result<Outcome, CompareError> {
    study::run(
        &grid.cells(folder, hwasp_testing::catalogue())?,
        &Threads::new(2).unwrap(),
        Work { command_line: &["hwasp".into()], watch, trainer: &Serial, stop: &watch.stop },
    )
}

/// The figures without times.
fn figures(outcome: &Outcome) -> Comparison {
    let mut comparison = Comparison::new("reach", outcome, None).unwrap();
    for method in &mut comparison.methods {
        method.wall_s = None;
    }
    comparison
}

#[test]
fn a_killed_comparison_goes_on_and_ends_with_the_same_figures() {
    let grid = grid(&["hwasp", "fixed:middle", "cmaes"], "0.2");
    let whole = figures(&run(&grid, &empty("whole"), &Counter::default()).unwrap());
    assert_eq!(whole.methods.len(), 3);
    assert_eq!(whole.improvement.len(), 3);

    let folder = empty("killed");
    let first = Counter { stop_after: Some(2), ..Counter::default() };
    let finished = run(&grid, &folder, &first).unwrap().finished.len();
    assert!((1..9).contains(&finished), "{finished}");
    // A kill leaves a cell without a summary, or a folder without anything whole.
    let mut cells: Vec<_> = fs::read_dir(folder.join("cells")).unwrap().map(|e| e.unwrap().path()).collect();
    cells.sort();
    let done = cells.iter().find(|cell| cell.join("summary.json").exists()).unwrap();
    fs::remove_file(done.join("summary.json")).unwrap();
    let never = grid
        .cells(&folder, hwasp_testing::catalogue())
        .unwrap()
        .into_iter()
        .map(|cell| cell.path)
        .find(|path| !path.exists());
    let never = never.unwrap();
    fs::create_dir(&never).unwrap();
    fs::write(never.join(".experiment.toml.partial"), "name = ").unwrap();

    let second = Counter::default();
    let cells = run(&grid, &folder, &second).unwrap();
    assert_eq!(*second.old.lock().unwrap(), finished - 1, "what was done was not done again");
    assert_eq!(*second.trained.lock().unwrap(), 9 - (finished - 1));
    assert_eq!(figures(&cells), whole);

    let third = Counter::default();
    assert_eq!(figures(&run(&grid, &folder, &third).unwrap()), whole);
    assert_eq!(*third.trained.lock().unwrap(), 0);
}

#[test]
fn a_folder_of_another_comparison_is_refused_and_left_alone() {
    let folder = empty("other");
    run(&grid(&["hwasp"], "0.2"), &folder, &Counter::default()).unwrap();
    let error = run(&grid(&["hwasp"], "0.1"), &folder, &Counter::default()).unwrap_err();
    assert!(matches!(error, CompareError::Other { .. }), "{error}");
    let again = Counter::default();
    assert_eq!(run(&grid(&["hwasp"], "0.2"), &folder, &again).unwrap().finished.len(), 3);
    assert_eq!(*again.trained.lock().unwrap(), 0);
}

#[test]
fn what_a_comparison_writes() {
    let folder = empty("written");
    let grid = grid(&["hwasp", "fixed:0.3"], "0.2");
    let cells = run(&grid, &folder, &Counter::default()).unwrap();
    let comparison = Comparison::new("reach", &cells, Some(-1e9)).unwrap();
    let options = grid.cells(&folder, hwasp_testing::catalogue()).unwrap()[0].plot_options();
    comparison.write(&folder, &cells.finished, &options).unwrap();
    let read = |name: &str| fs::read_to_string(folder.join(name)).unwrap();
    assert_eq!(read("table.md"), comparison.markdown());
    assert!(read("table.md").contains("| fixed:0.3 | 3 of 3 |"));
    assert_eq!(read("table.csv").lines().count(), 3);
    let json: serde_json::Value = serde_json::from_str(&read("comparison.json")).unwrap();
    // Every first row is above such a threshold.
    assert_eq!(json["methods"][0]["threshold"]["seeds"], 3);
    assert!(read("curves.svg").contains("real environment steps"));
    assert!(read("time.svg").contains("wall-clock time (s)"));
    let fixed = comparison.methods.iter().find(|m| m.label == "fixed:0.3").unwrap();
    assert!(fixed.design_totals[0].1.iter().all(|gear| (gear - 0.3).abs() < 1e-9));
}

/// What stands within braces and quotes is one contender's.
#[test]
fn a_list_of_contenders() {
    let text = r#"hwasp,fixed:{gear = 0.7, shank = "0.5 m"}, fixed:"1, 2",cmaes"#;
    let labels: Vec<_> = Contender::parse_list(text).unwrap().into_iter().map(|contender| contender.label).collect();
    let wanted = ["hwasp", r#"fixed:{gear = 0.7, shank = "0.5 m"}"#, r#"fixed:"1, 2""#, "cmaes"];
    assert_eq!(labels, wanted);
}

/// A table says where each parameter stays.
#[test]
fn fixed_by_name() {
    let grid = grid(&["fixed:{ gear = 0.7 }"], "0.2");
    let comparison = figures(&run(&grid, &empty("by_name"), &Counter::default()).unwrap());
    assert!(comparison.methods[0].design_totals[0].1.iter().all(|gear| (gear - 0.7).abs() < 1e-9));
}

#[test]
fn contenders_that_are_none() {
    for (text, told) in
        [("hwsap", "`hwsap` is no contender: the methods are hwasp,"), ("fixed:", "`fixed:` is no contender")]
    {
        let error = Contender::parse(text).unwrap_err().to_string();
        assert!(error.starts_with(told), "{error}");
    }
    let twice = grid(&["hwasp", "hwasp"], "0.2");
    assert!(matches!(twice.cells(Path::new("nowhere"), hwasp_testing::catalogue()), Err(CompareError::Twice(_))));
}
