//! Trainings that are interrupted and go on: the same bits, from every point at which they can be.

#![allow(clippy::unwrap_used)] // helpers of tests are tests too

use std::fs;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::Duration;

use hwasp_algos::Array;
use hwasp_core::{End, EpisodeKind, Episodes, Sampler, Serial, Step};
use hwasp_experiment::Experiment;
use hwasp_runs::checkpoint::{decode, encode};
use hwasp_runs::{Keeping, Provenance, Resumed, RunError, RunFolder, SavedRun, no_extras, replay};
use hwasp_testing::{KINDS, Keeper, Stopper, catalogue, executor, run, small, spoil, told};
use hwasp_training::{
    Assembly, Event, FailedIteration, MetricsRow, Observer, TrainError, params_at, train, train_from,
};

fn empty(name: &str) -> PathBuf {
    hwasp_testing::empty(env!("CARGO_TARGET_TMPDIR"), name)
}

fn provenance(spec: &Experiment) -> Provenance {
    Provenance::new(vec!["test".into()], 1, spec.seed)
}

/// At every moment at which a checkpoint can be had: between iterations, between generations, within a generation, and
/// within the training of a candidate.
#[test]
fn a_resumed_training_has_the_bits_of_one_that_was_never_interrupted() {
    for (method, settings) in KINDS {
        let assembly = Assembly::new(&small(method, settings)).unwrap();
        let (whole, kept) = run(&assembly, None, 1);
        let count = kept.checkpoints.len();
        assert!(count > 3, "{method} {settings:?}: {count} checkpoints");
        let within = kept.checkpoints.iter().filter(|c| c.archive.keys().any(|k| k.contains(".training."))).count();
        assert_eq!(within > 0, assembly.experiment().method.trains_inside(), "{method} {settings:?}");
        // All of the first, then fewer: a test may not take minutes.
        for (i, checkpoint) in
            kept.checkpoints.iter().enumerate().filter(|(i, _)| *i < 4 || i % (count / 4).max(1) == 0)
        {
            let bytes = encode(checkpoint, "experiment", None).unwrap();
            let from = decode(&bytes, "experiment").unwrap();
            let (resumed, rows) = run(&assembly, Some(&from), 1 + i % 2);
            assert_eq!(told(&resumed), told(&whole), "{method} {settings:?}, checkpoint {i} of {count}");
            let rest = &kept.rows[from.iteration as usize..];
            assert_eq!(format!("{:?}", rows.rows), format!("{rest:?}"), "{method} {settings:?}, checkpoint {i}");
        }
    }
}

/// Numbers that are sound one by one, and make no state: parameters of another policy were handed out, and differences and
/// sums of counters overflowed.
#[test]
fn a_state_that_cannot_be_is_refused() {
    let assembly = Assembly::new(&small("cmaes", &[])).unwrap();
    let (_, kept) = run(&assembly, None, 1);
    let last = kept.checkpoints.last().unwrap();
    assert_eq!(params_at(&assembly, last).unwrap().len(), assembly.init().len());
    let told = |name: &str, array| {
        let mut checkpoint = last.clone();
        checkpoint.archive.insert(name.to_owned(), array).unwrap();
        params_at(&assembly, &checkpoint).unwrap_err().to_string()
    };
    let count = assembly.init().len();
    assert_eq!(
        told("best.params", Array::F32(vec![0.5])),
        format!("`best.params` of the saved state has 1 elements instead of {count}")
    );
    assert_eq!(
        told("search.decomposed_at", Array::U64(vec![1 << 40])),
        "`search.decomposed_at` of the saved state is 1099511627776, which is not a generation of this run so far"
    );
    for name in ["loop.env_steps", "loop.failed_candidates", "search.run_generation"] {
        assert!(told(name, Array::U64(vec![u64::MAX])).ends_with("which is not at most 2^44"), "{name}");
    }
}

fn always() -> Keeping {
    Keeping { checkpoint_every: Duration::ZERO, ..Keeping::default() }
}

/// Stopped again and again until it is done: the folder ends with the files of a run that was never stopped.
#[test]
fn a_run_folder_that_was_stopped_many_times_is_that_of_one_run() {
    for (k, (method, settings)) in KINDS.into_iter().enumerate() {
        let spec = small(method, settings);
        let assembly = Assembly::new(&spec).unwrap();
        let (one, many) = (empty(&format!("resume-one-{k}")), empty(&format!("resume-many-{k}")));
        let mut folder = RunFolder::create(&one, &spec, &provenance(&spec), Keeping::default()).unwrap();
        let trained = train(&assembly, &Serial, &mut folder, &AtomicBool::new(false)).unwrap();
        folder.finish(&assembly, &trained, &no_extras).unwrap();

        let folder = RunFolder::create(&many, &spec, &provenance(&spec), always()).unwrap();
        let mut resumed: Resumed = folder.into();
        let mut stops = 0;
        let trained = loop {
            let stop = AtomicBool::new(false);
            let mut stopper = Stopper { inner: &mut resumed.folder, stop: &stop, after: 1 + 2 * stops };
            let from = resumed.found.checkpoint.as_ref();
            match train_from(from, &assembly, &*executor(1 + stops % 2), &mut stopper, &stop) {
                Ok(trained) => break trained,
                Err(TrainError::Interrupted { .. }) => stops += 1,
                Err(error) => panic!("{error}"),
            }
            resumed.folder.settle().unwrap();
            drop(resumed);
            // Half a row, as a kill leaves it.
            let metrics = fs::read_to_string(many.join("metrics.csv")).unwrap();
            fs::write(many.join("metrics.csv"), format!("{metrics}99,12")).unwrap();
            resumed = RunFolder::resume(&many, &spec, provenance(&spec), always()).unwrap();
        };
        resumed.folder.finish(&assembly, &trained, &no_extras).unwrap();
        assert!(stops > 1, "{method}: {stops} stops");
        for file in ["policy.safetensors", "design.toml", "experiment.toml"] {
            assert_eq!(fs::read(one.join(file)).unwrap(), fs::read(many.join(file)).unwrap(), "{method}: {file}");
        }
        let rows = |path: &std::path::Path| {
            let text = fs::read_to_string(path.join("metrics.csv")).unwrap();
            let untimed = |line: &str| {
                let mut fields: Vec<String> = line.split(',').map(str::to_owned).collect();
                fields.remove(2);
                fields
            };
            text.lines().map(untimed).collect::<Vec<_>>()
        };
        assert_eq!(rows(&one), rows(&many), "{method} {settings:?}");
        let told: serde_json::Value = serde_json::from_slice(&fs::read(many.join("provenance.json")).unwrap()).unwrap();
        assert_eq!(told["resumed"].as_array().unwrap().len(), stops, "{method}");
    }
}

/// A run of four iterations that was stopped after two of them.
fn stopped(name: &str) -> (PathBuf, Experiment, Assembly) {
    let spec = small("hwasp", &[]);
    let (path, assembly) = (empty(name), Assembly::new(&spec).unwrap());
    let mut folder = RunFolder::create(&path, &spec, &provenance(&spec), always()).unwrap();
    let stop = AtomicBool::new(false);
    let mut stopper = Stopper { inner: &mut folder, stop: &stop, after: 2 };
    let error = train(&assembly, &Serial, &mut stopper, &stop).unwrap_err();
    assert!(matches!(error, TrainError::Interrupted { env_steps: 2400, budget: 9600 }), "{error}");
    (path, spec, assembly)
}

#[test]
fn an_unfinished_run_can_be_evaluated_at_its_newest_checkpoint() {
    for (k, (method, settings)) in KINDS.into_iter().enumerate() {
        let spec = small(method, settings);
        let (path, assembly) = (empty(&format!("unfinished-{k}")), Assembly::new(&spec).unwrap());
        let mut folder = RunFolder::create(&path, &spec, &provenance(&spec), always()).unwrap();
        let stop = AtomicBool::new(false);
        let mut stopper = Stopper { inner: &mut folder, stop: &stop, after: 3 };
        train(&assembly, &Serial, &mut stopper, &stop).unwrap_err();
        let params = SavedRun::open(&path, catalogue()).unwrap().params().unwrap();
        assert_eq!(params.len(), assembly.init().len());
        let moved = params != assembly.init();
        // Whether the first candidate was scored by then is another matter.
        assert!(moved || assembly.experiment().method.searches(), "{method}");
        assert!(matches!(SavedRun::open(&path, catalogue()).unwrap().summary(), Err(RunError::Unfinished { .. })));
    }
}

#[test]
fn a_damaged_newest_checkpoint_costs_the_steps_since_the_one_before() {
    let (path, spec, assembly) = stopped("damaged");
    let newest = path.join("checkpoints/iteration-00000002.safetensors");
    let mut bytes = fs::read(&newest).unwrap();
    let last = bytes.len() - 1;
    bytes[last] ^= 1;
    fs::write(&newest, bytes).unwrap();
    fs::write(path.join("metrics.csv"), "a curve that someone has edited\n").unwrap();
    let Resumed { mut folder, found } = RunFolder::resume(&path, &spec, provenance(&spec), always()).unwrap();
    assert_eq!((found.checkpoint.as_ref().unwrap().iteration, found.damaged.len()), (1, 1));
    assert!(found.damaged[0].1.to_string().contains("checksum"), "{:?}", found.damaged);
    let from = found.checkpoint.as_ref();
    let trained = train_from(from, &assembly, &Serial, &mut folder, &AtomicBool::new(false)).unwrap();
    assert_eq!(told(&trained), told(&run(&assembly, None, 1).0));
    assert!(path.join("checkpoints/iteration-00000002.damaged").is_file());
    assert!(path.join("metrics.damaged").is_file());
    assert_eq!(SavedRun::open(&path, catalogue()).unwrap().metrics().unwrap().rows[0].iteration, 1);
}

#[test]
fn what_cannot_be_resumed_is_refused_and_stays_as_it_is() {
    let (path, spec, _) = stopped("refused");
    let resume = |spec| RunFolder::resume(&path, spec, provenance(spec), Keeping::default());
    let files = || {
        let list = fs::read_dir(path.join("checkpoints")).unwrap();
        let mut list: Vec<_> = list.map(|f| f.unwrap().path()).map(|f| (fs::read(&f).unwrap(), f)).collect();
        list.sort();
        list
    };
    let before = files();
    let other = small("hwasp", &[("ppo.clip_ratio", "0.1")]);
    let error = resume(&other).unwrap_err().to_string();
    assert!(error.contains("iteration-00000002.safetensors: it belongs to another experiment"), "{error}");
    assert_eq!(files(), before);

    // One process at a time.
    let held = resume(&spec).unwrap();
    let error = resume(&spec).unwrap_err().to_string();
    assert!(error.contains(&format!("is in use by process {}", std::process::id())), "{error}");
    drop(held);
    // A file that a dead process left locks nothing.
    fs::write(path.join(".lock"), "999999\n").unwrap();
    drop(resume(&spec).unwrap());

    for entry in fs::read_dir(path.join("checkpoints")).unwrap() {
        fs::write(entry.unwrap().path(), "rubbish").unwrap();
    }
    assert!(resume(&spec).unwrap_err().to_string().contains("damaged"));
    fs::write(path.join("summary.json"), "{}").unwrap();
    assert!(matches!(resume(&spec), Err(RunError::Finished { .. })));
}

/// A run that was killed before its first checkpoint begins anew, in the same folder.
#[test]
fn a_run_without_checkpoints_begins_from_the_beginning() {
    let spec = small("hwasp", &[]);
    let (path, assembly) = (empty("no-checkpoint"), Assembly::new(&spec).unwrap());
    drop(RunFolder::create(&path, &spec, &provenance(&spec), Keeping::default()).unwrap());
    fs::write(path.join("metrics.csv"), "iteration,env").unwrap();
    let Resumed { mut folder, found } = RunFolder::resume(&path, &spec, provenance(&spec), Keeping::default()).unwrap();
    assert!(found.checkpoint.is_none() && found.damaged.is_empty());
    let trained = train_from(None, &assembly, &Serial, &mut folder, &AtomicBool::new(false)).unwrap();
    folder.finish(&assembly, &trained, &no_extras).unwrap();
    assert_eq!(SavedRun::open(&path, catalogue()).unwrap().metrics().unwrap().rows.len(), 8);
}

#[test]
fn an_iteration_that_failed_can_be_repeated_from_its_folder() {
    let spec = small("hwasp", &[]);
    let (path, assembly) = (empty("replay"), Assembly::new(&spec).unwrap());
    let kept = run(&assembly, None, 1).1;
    let checkpoint = &kept.checkpoints[2];
    let policy = assembly.policy.clone();
    let sampler = Sampler::new(policy, assembly.worlds.training.make.clone(), Some(spec.train.episode_steps));
    let progress = checkpoint.env_steps as f64 / spec.train.env_steps as f64;
    let episodes = Episodes { seed: spec.seed, iteration: 3, indices: 0..40, progress, kind: EpisodeKind::Training };
    let batch = sampler.collect(&Serial, &params_at(&assembly, checkpoint).unwrap(), &episodes).unwrap();

    let mut folder = RunFolder::create(&path, &spec, &provenance(&spec), Keeping::default()).unwrap();
    let failed = FailedIteration { checkpoint, batch: Some(&batch), what: "the policy gradient is not finite" };
    folder.on(Event::Failed(&failed)).unwrap();
    let file = folder.fault().unwrap().to_owned();
    assert_eq!(file, path.join("faults/iteration-00000003.safetensors"));
    for threads in [1, 2] {
        let replayed = replay(&file, catalogue(), &*executor(threads)).unwrap();
        assert_eq!((replayed.iteration, replayed.env_steps, replayed.same_batch), (3, 3600, Some(true)));
        assert_eq!(replayed.fault.as_deref(), Some("the policy gradient is not finite"));
        // What was told is not what happens: this iteration is sound, and gives the row of the whole training.
        assert_eq!(replayed.outcome.unwrap().values(), kept.rows[3].learner);
    }
    // The state before it is a checkpoint as well, without a batch.
    let replayed = replay(&path.join("checkpoints/iteration-00000003.safetensors"), catalogue(), &Serial).unwrap();
    assert_eq!((replayed.same_batch, replayed.fault), (None, None));
    let nowhere = replay(&path.join("experiment.toml"), catalogue(), &Serial).unwrap_err().to_string();
    assert!(nowhere.contains("is no checkpoint of a run folder"), "{nowhere}");
}

/// The state before an iteration whose rewards are no numbers: written down, and the last sound state kept.
#[test]
fn an_iteration_that_fails_leaves_the_state_before_it() {
    let spec = small("hwasp", &[]);
    let (path, mut assembly) = (empty("failed"), Assembly::new(&spec).unwrap());
    let whole = run(&assembly, None, 1).0;
    let sound = assembly.clone();
    let steps = AtomicU64::new(0);
    spoil(&mut assembly, move |_, step| {
        let spoiled = steps.fetch_add(1, Ordering::Relaxed) > 3000;
        if spoiled { Step { reward: f64::NAN, ..step } } else { step }
    });
    let mut folder = RunFolder::create(&path, &spec, &provenance(&spec), Keeping::default()).unwrap();
    let error = train(&assembly, &Serial, &mut folder, &AtomicBool::new(false)).unwrap_err();
    assert!(matches!(error, TrainError::Rollout(_)), "{error}");
    assert!(error.to_string().contains("of iteration 2 (seed 0) failed at step"), "{error}");
    let fault = folder.fault().unwrap().to_owned();
    drop(folder);
    let replayed = replay(&fault, catalogue(), &Serial).unwrap();
    assert_eq!((replayed.iteration, replayed.env_steps), (2, 2400));
    assert_eq!(replayed.fault, Some(error.to_string()));
    // In the plant that is not spoiled the training goes on from there.
    let found = RunFolder::resume(&path, &spec, provenance(&spec), Keeping::default()).unwrap().found;
    assert_eq!(told(&run(&sound, found.checkpoint.as_ref(), 1).0), told(&whole));
}

#[test]
fn physics_that_fail_again_and_again_end_the_training_with_a_reason() {
    let mut assembly = Assembly::new(&small("hwasp", &[])).unwrap();
    let steps = AtomicU64::new(0);
    spoil(&mut assembly, move |_, step| {
        let spoiled = steps.fetch_add(1, Ordering::Relaxed).is_multiple_of(20);
        if spoiled { Step { end: Some(End::Faulted), ..step } } else { step }
    });
    let mut keeper = Keeper::default();
    let error = train(&assembly, &Serial, &mut keeper, &AtomicBool::new(false)).unwrap_err();
    let TrainError::Physics { iterations, failed, asked, .. } = &error else { panic!("{error}") };
    assert!((*iterations, *asked) == (3, 40) && *failed > 20, "{error}");
    assert_eq!(keeper.rows.len(), 2);
    assert!(error.to_string().contains("in 3 iterations in a row"), "{error}");
}

/// A run that an earlier version began has the columns `kl`, `entropy` and `step_fraction`, whatever learns. Its curve goes on
/// with the learner's own names; what the learner has of the old columns is kept, what nobody wrote down is NaN.
#[test]
fn the_curve_of_an_earlier_version_goes_on() {
    let spec = small("hwasp", &[]);
    let (path, assembly) = (empty("earlier"), Assembly::new(&spec).unwrap());
    let stop = AtomicBool::new(false);
    let mut folder = RunFolder::create(&path, &spec, &provenance(&spec), always()).unwrap();
    let mut stopper = Stopper { inner: &mut folder, stop: &stop, after: 3 };
    train(&assembly, &Serial, &mut stopper, &stop).unwrap_err();
    drop(folder);
    let table = SavedRun::open(&path, catalogue()).unwrap().metrics().unwrap();
    assert_eq!(table.learner[..3], ["kl", "entropy", "clip_fraction"]);
    let line = |row: &MetricsRow| {
        let values = [row.wall_s, row.discounted_return, row.undiscounted_return, row.learner[0], row.learner[1], 1.0];
        let values = values.iter().chain(&row.design_totals).map(|value| format!(",{value:?}"));
        format!("{},{}{}\n", row.iteration, row.env_steps, values.collect::<Vec<_>>().concat())
    };
    let header = "iteration,env_steps,wall_s,discounted_return,return,kl,entropy,step_fraction,gear\n".to_owned();
    let earlier = header + &table.rows.iter().map(line).collect::<Vec<_>>().concat();
    fs::write(path.join("metrics.csv"), earlier).unwrap();

    let Resumed { mut folder, found } = RunFolder::resume(&path, &spec, provenance(&spec), always()).unwrap();
    train_from(found.checkpoint.as_ref(), &assembly, &Serial, &mut folder, &AtomicBool::new(false)).unwrap();
    drop(folder);
    let whole = SavedRun::open(&path, catalogue()).unwrap().metrics().unwrap();
    assert_eq!((whole.rows.len(), &whole.learner), (8, &table.learner));
    let kept = found.checkpoint.unwrap().iteration as usize;
    for (i, (row, before)) in whole.rows.iter().zip(&table.rows).take(kept).enumerate() {
        assert_eq!((&row.learner[..2], row.env_steps), (&before.learner[..2], before.env_steps), "{i}");
        assert!(row.learner[2..].iter().all(|value| value.is_nan()), "{i}");
        assert!(row.episodes.is_nan() && row.noise.command.is_nan(), "{i}");
    }
    assert!(
        whole.rows[kept..].iter().all(|row| row.learner.iter().all(|value| value.is_finite()) && row.episodes > 0.0)
    );
}
