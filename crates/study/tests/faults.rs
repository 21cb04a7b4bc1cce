//! Faults that comparisons had: seeds that failed without a word, certainty from nothing, processes in each other's way.

#![allow(clippy::unwrap_used)] // helpers of tests are tests too

use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};

use hwasp_core::{Serial, Threads};
use hwasp_study::{
    self as study, CompareError, Comparison, Contender, FAILURE, Grid, Outcome, SavedComparison, Watch, Work,
};
use hwasp_testing::{catalogue, empty, layers};
use hwasp_training::{Event, TrainError};

type Settings<'a> = &'a [(&'a str, &'a str)];

/// Steps so large, and noise so free, that most trainings diverge.
const DIVERGES: Settings<'_> =
    &[("ppo.learning_rate", "0.05"), ("ppo.max_grad_norm", "0"), ("noise.learning_rate_scale", "100")];

fn grid(methods: &[&str], seeds: u64, settings: Settings<'_>) -> Grid {
    let few = [("train.evaluation_episodes", "20"), ("train.env_steps", "2400")];
    let layers = few.iter().chain(settings).fold(layers("reach"), |layers, (k, v)| layers.with_override(k, v));
    Grid { layers, contenders: methods.iter().map(|m| Contender::parse(m).unwrap()).collect(), seeds: 0..seeds }
}

fn folder(name: &str) -> PathBuf {
    empty(env!("CARGO_TARGET_TMPDIR"), &format!("faults-{name}"))
}

/// Counts what it is told.
#[derive(Default)]
struct Told {
    events: Mutex<Vec<String>>,
    stop: AtomicBool,
}

impl Told {
    fn push(&self, event: String) {
        self.events.lock().unwrap().push(event);
    }

    fn count(&self, beginning: &str) -> usize {
        self.events.lock().unwrap().iter().filter(|event| event.starts_with(beginning)).count()
    }
}

impl Watch for Told {
    fn grid(&self, _: &[(String, u64, bool)]) {}
    fn cell(&self, cell: usize, event: Event<'_>) {
        if let Event::Started { .. } = event {
            self.push(format!("started {cell}"));
        }
    }
    fn failed(&self, cell: usize, error: &TrainError) {
        self.push(format!("failed {cell}: {error}"));
    }
    fn failed_before(&self, cell: usize, reason: &str) {
        self.push(format!("before {cell}: {reason}"));
    }
    fn waiting(&self, cell: usize, owner: &str) {
        self.push(format!("waiting {cell} for {owner}"));
    }
    fn joined(&self, cell: usize) {
        self.push(format!("joined {cell}"));
    }
}

fn run(grid: &Grid, folder: &Path, told: &Told) -> Outcome {
    let cells = grid.cells(folder, catalogue()).unwrap();
    let work = Work { command_line: &["hwasp".into()], watch: told, trainer: &Serial, stop: &told.stop };
    study::run(&cells, &Threads::new(2).unwrap(), work).unwrap()
}

fn write(grid: &Grid, folder: &Path, outcome: &Outcome) -> Comparison {
    let comparison = Comparison::new("reach", outcome, None).unwrap();
    let options = grid.cells(folder, catalogue()).unwrap()[0].plot_options();
    comparison.write(folder, &outcome.finished, &options).unwrap();
    comparison
}

/// Seven of ten trainings diverged, and the table said `minimal | 1`: no word of the others, which the same command trained
/// again, to the same end.
#[test]
fn seeds_that_failed_are_told_with_their_reasons_and_not_repeated() {
    let folder = folder("diverged");
    let longer = [DIVERGES, &[("train.env_steps", "36000")]].concat();
    let grid = grid(&["hwasp", "minimal"], 5, &longer);
    let told = Told::default();
    let outcome = run(&grid, &folder, &told);
    let failed = outcome.failed();
    assert!(failed > 0 && outcome.unfinished() == 0 && failed == told.count("failed"), "{outcome:?}");
    assert_eq!(outcome.finished.len() + failed, 10);

    let comparison = write(&grid, &folder, &outcome);
    assert!(comparison.methods.iter().all(|method| method.asked() == Some(5)));
    let read = |name: &str| fs::read_to_string(folder.join(name)).unwrap();
    for method in &comparison.methods {
        let (label, seeds) = (&method.label, method.seeds);
        assert!(read("table.md").contains(&format!("| {label} | {seeds} of 5 |")), "{}", read("table.md"));
        for seed in &method.missing {
            assert!(read("table.md").contains(&format!("- {label}, seed {} failed: {}", seed.seed, seed.reason)));
            assert!(read("table.csv").contains(&seed.to_string()), "{}", read("table.csv"));
            assert!(read("comparison.json").contains(&format!("\"reason\": \"{}\"", seed.reason)));
        }
    }
    let first = &outcome.missing[0];
    let cell = folder.join("cells").join(format!("{}-seed{}", first.label, first.seed.seed));
    assert!(cell.join(FAILURE).is_file());

    let again = Told::default();
    assert_eq!(Comparison::new("reach", &run(&grid, &folder, &again), None).unwrap(), comparison);
    assert_eq!((again.count("started"), again.count("before")), (0, failed));
    // The way out: without its folder, a cell is trained anew.
    fs::remove_dir_all(cell).unwrap();
    let once = Told::default();
    run(&grid, &folder, &once);
    assert_eq!((once.count("started"), once.count("failed")), (1, 1));
    assert_eq!(SavedComparison::open(&folder).unwrap().comparison, comparison);
}

/// Where all seeds of a method failed it vanished from every list; where all of all failed there were no tables.
#[test]
fn a_method_without_a_finished_seed_stays_in_every_list() {
    let folder = folder("nothing-left");
    let grid = grid(&["hwasp", "fixed:0.3"], 2, &[]);
    let mut outcome = run(&grid, &folder, &Told::default());
    let lose = |outcome: &mut Outcome, label: &str| {
        outcome.finished.retain(|cell| cell.label != label);
        for seed in 0..2 {
            let seed = study::MissingSeed { seed, failed: true, reason: "the update is not finite".into() };
            outcome.missing.push(study::MissingCell { label: label.to_owned(), seed });
        }
    };
    lose(&mut outcome, "hwasp");
    let comparison = write(&grid, &folder, &outcome);
    assert_eq!(comparison.methods[1].label, "hwasp", "methods without figures come last");
    assert!(comparison.markdown().contains("| hwasp | 0 of 2 | – | – |"), "{}", comparison.markdown());
    let curves = fs::read_to_string(folder.join("curves.svg")).unwrap();
    assert!(curves.contains("no run finished of hwasp"), "{curves}");
    assert_eq!(SavedComparison::open(&folder).unwrap().comparison, comparison);

    lose(&mut outcome, "fixed:0.3");
    let nothing = write(&grid, &folder, &outcome);
    assert!(nothing.markdown().contains("| fixed:0.3 | 0 of 2 | – | – |"));
    let saved = SavedComparison::open(&folder).unwrap();
    assert_eq!((saved.comparison, saved.cells.len()), (nothing, 0));
}

/// After Ctrl-C the seeds that had not finished were missing without a word, as if nobody had asked for them.
#[test]
fn seeds_that_were_stopped_are_unfinished_and_not_failed() {
    let folder = folder("stopped");
    let told = Told { stop: AtomicBool::new(true), ..Told::default() };
    let grid = grid(&["hwasp"], 2, &[]);
    let outcome = run(&grid, &folder, &told);
    assert_eq!((outcome.failed(), outcome.unfinished()), (0, 2));
    let text = Comparison::new("reach", &outcome, None).unwrap().markdown();
    assert!(text.contains("- hwasp, seed 1 is not finished: it was not begun"), "{text}");
    told.stop.store(false, Ordering::Relaxed);
    assert_eq!(run(&grid, &folder, &told).finished.len(), 2);
}

/// One seed was printed as `[-8.5, -8.5]` and as better in all pairs, two seeds too.
#[test]
fn few_seeds_have_neither_intervals_nor_probabilities() {
    let folder = folder("few");
    let grid = grid(&["hwasp", "minimal"], 2, &[]);
    let comparison = write(&grid, &folder, &run(&grid, &folder, &Told::default()));
    assert!(comparison.methods.iter().all(|m| m.evaluation.is_some_and(|evaluation| evaluation.interval.is_none())));
    assert_eq!(comparison.improvement[0].improvement, None);
    let text = comparison.markdown();
    assert!(text.contains(" (2 seeds) |") && !text.contains('['), "{text}");
    assert!(text.contains("| hwasp | minimal | – |") || text.contains("| minimal | hwasp | – |"), "{text}");
}

/// A comparison that was written when every figure had an interval, and seeds no names.
#[test]
fn old_comparisons_are_read() {
    let folder = folder("old");
    let grid = grid(&["hwasp"], 2, &[]);
    write(&grid, &folder, &run(&grid, &folder, &Told::default()));
    let old = r#"{"experiment": "reach", "threshold": -10.0, "improvement": [], "methods": [{"label": "hwasp", "seeds": 2,
        "evaluation": {"iqm": -8.5, "low": -9.0, "high": -8.0}, "evaluations": [-9.0, -8.0],
        "area_under_curve": {"iqm": -12.0, "low": -12.5, "high": -11.5}, "threshold": {"seeds": 2, "median_env_steps": 1200.0},
        "design_error": [], "design_totals": [], "env_steps": 2400.0, "wall_s": 0.5, "failed_candidates": 0}]}"#;
    fs::write(folder.join("comparison.json"), old).unwrap();
    let saved = SavedComparison::open(&folder).unwrap();
    let method = &saved.comparison.methods[0];
    assert_eq!((method.finished(), method.asked(), saved.cells.len()), ("2".to_owned(), None, 2));
    assert!(method.evaluation.is_some_and(|figure| figure.interval.is_some_and(|i| i.low == -9.0 && i.high == -8.0)));
}

/// A second comparison on the same folder killed the first: both ended with `is in use`, without a table.
#[test]
fn a_cell_that_another_process_trains_is_waited_for_and_taken_over() {
    let folder = folder("held");
    let grid = grid(&["hwasp"], 3, &[]);
    let cell = folder.join("cells/hwasp-seed1");
    fs::create_dir_all(&cell).unwrap();
    let lock = File::create(cell.join(".lock")).unwrap();
    lock.lock().unwrap();
    fs::write(cell.join(".lock"), "4711\n").unwrap();
    let told = Told::default();
    let outcome = std::thread::scope(|scope| {
        let waiting = scope.spawn(|| run(&grid, &folder, &told));
        while told.count("waiting") == 0 {
            std::thread::sleep(std::time::Duration::from_millis(5));
        }
        // The owner dies without having done anything.
        drop(lock);
        waiting.join().unwrap()
    });
    assert_eq!((outcome.finished.len(), told.count("started")), (3, 3));
    assert_eq!((told.count("waiting 1 for 4711"), told.count("joined")), (1, 0));
}

/// Two comparisons at once share the cells, train none of them twice, and both have all of them.
#[test]
fn two_comparisons_share_a_folder() {
    let folder = folder("shared");
    let grid = grid(&["hwasp", "fixed:middle"], 3, &[("train.env_steps", "12000")]);
    let tolds = [Told::default(), Told::default()];
    let outcomes: Vec<Outcome> = std::thread::scope(|scope| {
        let both: Vec<_> = tolds.iter().map(|told| scope.spawn(|| run(&grid, &folder, told))).collect();
        both.into_iter().map(|one| one.join().unwrap()).collect()
    });
    assert_eq!(tolds.iter().map(|told| told.count("started")).sum::<usize>(), 6);
    let figures = |outcome| Comparison::new("reach", outcome, None).unwrap();
    assert_eq!(outcomes[0].finished.len(), 6);
    assert_eq!(figures(&outcomes[0]), figures(&outcomes[1]));
}

/// `fixed:1,fixed:1.0` were two contenders; a comparison with fewer methods lost those of its folder without a word.
#[test]
fn contenders_that_train_the_same_are_refused_and_cells_of_others_named() {
    let folder = folder("others");
    let same = grid(&["fixed:1", "hwasp", "fixed:1.0"], 1, &[]).cells(&folder, catalogue());
    assert!(
        matches!(&same, Err(CompareError::Same { one, other }) if one == "fixed:1" && other == "fixed:1.0"),
        "{:?}",
        same.err()
    );
    let both = grid(&["hwasp", "fixed:1"], 2, &[]);
    assert_eq!(Comparison::new("reach", &run(&both, &folder, &Told::default()), None).unwrap().others(), None);
    let one = grid(&["hwasp"], 1, &[]);
    let comparison = write(&one, &folder, &run(&one, &folder, &Told::default()));
    let others = comparison.others().unwrap();
    assert!(others.ends_with("not in this comparison: fixed_1-seed0, fixed_1-seed1, hwasp-seed1."), "{others}");
    assert!(comparison.markdown().contains(&others));
    // The cells that are more than the comparison keep nobody from reading it.
    assert_eq!(SavedComparison::open(&folder).unwrap().cells.len(), 1);
}

/// A label with a line break ended its row of the table, and reasons took escapes and marks of the direction of writing along.
#[test]
fn labels_and_reasons_stay_in_their_rows() {
    let grid = grid(&["fixed:\n0.3", "hwasp"], 1, &[]);
    let mut outcome = run(&grid, &folder("hostile"), &Told::default());
    let reason = "a \u{1b}[2J\u{202e}b | <script>".to_owned();
    let seed = study::MissingSeed { seed: 7, failed: true, reason };
    outcome.missing.push(study::MissingCell { label: "fixed:\n0.3".to_owned(), seed });
    outcome.others.push("x|\ny".to_owned());
    let text = Comparison::new("reach", &outcome, None).unwrap().markdown();
    for told in [
        "\n| fixed:\u{fffd}0.3 | 1 of 2 |",
        "\n- fixed:\u{fffd}0.3, seed 7 failed: a \u{fffd}[2J\u{fffd}b \\| &lt;script>\n",
        // Its evaluation, which stands for itself.
        "\n- fixed:\u{fffd}0.3: -",
        "not in this comparison: x\\|\u{fffd}y.\n",
    ] {
        assert!(text.contains(told), "{told:?}: {text}");
    }
    assert!(
        text.contains("| fixed:\u{fffd}0.3 | hwasp | – |") || text.contains("| hwasp | fixed:\u{fffd}0.3 | – |"),
        "{text}"
    );
    assert!(!text.contains(['\u{1b}', '\u{202e}']) && !text.contains("fixed:\n"), "{text}");
}

/// Budgets of 21,000 steps were spent as 24,000, 16,400 and so on.
#[test]
fn the_table_says_what_of_the_budget_each_method_took() {
    let folder = folder("budget");
    let grid = grid(&["hwasp", "cmaes"], 1, &[("train.env_steps", "3500")]);
    let comparison = write(&grid, &folder, &run(&grid, &folder, &Told::default()));
    for method in &comparison.methods {
        let (piece, left) = (method.piece.as_ref().unwrap(), 3500.0 - method.env_steps.unwrap());
        // A generation is begun where it fits beside the last choice, which a search makes in any case.
        assert!(left >= 0.0 && left < piece.env_steps as f64, "{method:?}");
    }
    let text = comparison.markdown();
    assert!(text.contains("| 3,480 of 3,500 | episode, 30 |") && text.contains("| generation, "), "{text}");
}
