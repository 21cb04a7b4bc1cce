//! File systems that fail: at every single step of writing, once, for a while or for good, whole or half done.

#![allow(clippy::unwrap_used)] // helpers of tests are tests too

use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::Duration;

use hwasp_core::Serial;
use hwasp_experiment::Experiment;
use hwasp_runs::files::{Disk, Files};
use hwasp_runs::{ExtraFiles, Keeping, Provenance, Resumed, RunError, RunFolder, SavedRun};
use hwasp_testing::{Stopper, small};
use hwasp_training::{Assembly, TrainError, train, train_from};

fn empty(name: &str) -> PathBuf {
    hwasp_testing::empty(env!("CARGO_TARGET_TMPDIR"), name)
}

fn provenance(spec: &Experiment) -> Provenance {
    Provenance::new(vec!["test".into()], 1, spec.seed)
}

/// A further file that is made of the learning curve, as the program's picture is.
fn picture(saved: &SavedRun) -> ExtraFiles {
    let rows = saved.metrics()?.rows.len();
    Ok(vec![("curves.svg".to_owned(), format!("<svg>{rows}</svg>").into_bytes())])
}

/// A disk on which some steps fail.
#[derive(Debug)]
struct Faulty {
    steps: AtomicU64,
    /// Those that fail.
    from: u64,
    to: u64,
    /// Whether a step that fails has done a part of its work.
    half: bool,
    kind: io::ErrorKind,
}

impl Faulty {
    fn new(failing: std::ops::Range<u64>, half: bool, kind: io::ErrorKind) -> Arc<Self> {
        Arc::new(Self { steps: AtomicU64::new(0), from: failing.start, to: failing.end, half, kind })
    }

    fn step(&self, part: impl FnOnce(), whole: impl FnOnce() -> io::Result<()>) -> io::Result<()> {
        let step = self.steps.fetch_add(1, Ordering::Relaxed);
        if step < self.from || step >= self.to {
            return whole();
        }
        if self.half {
            part();
        }
        Err(io::Error::new(self.kind, "as the test wants it"))
    }
}

impl Files for Faulty {
    fn create_folder(&self, path: &Path) -> io::Result<()> {
        self.step(|| (), || Disk.create_folder(path))
    }

    fn write(&self, path: &Path, contents: &[u8]) -> io::Result<()> {
        self.step(|| drop(fs::write(path, &contents[..contents.len() / 2])), || Disk.write(path, contents))
    }

    fn append(&self, path: &Path, length: u64, contents: &[u8]) -> io::Result<()> {
        let half = || drop(Disk.append(path, length, &contents[..contents.len() / 2]));
        self.step(half, || Disk.append(path, length, contents))
    }

    fn sync(&self, path: &Path) -> io::Result<()> {
        self.step(|| (), || Disk.sync(path))
    }

    fn rename(&self, from: &Path, to: &Path) -> io::Result<()> {
        // The name has changed, but the folder did not come to the disk.
        self.step(|| drop(fs::rename(from, to)), || Disk.rename(from, to))
    }

    fn remove(&self, path: &Path) -> io::Result<()> {
        self.step(|| (), || Disk.remove(path))
    }
}

fn keeping(files: &Arc<Faulty>) -> Keeping {
    Keeping { files: files.clone(), checkpoint_every: Duration::ZERO }
}

/// Trains into a folder until the end or the fault; what became of it.
fn attempt(path: &Path, files: &Arc<Faulty>) -> Result<(), String> {
    let spec = small("hwasp", &[("train.env_steps", "6000")]);
    let assembly = Assembly::new(&spec).unwrap();
    let mut folder = RunFolder::create(path, &spec, &provenance(&spec), keeping(files)).map_err(|e| e.to_string())?;
    let trained =
        train(&assembly, &Serial, &mut folder, &AtomicBool::new(false)).map_err(|e| format!("training: {e}"))?;
    folder.finish(&assembly, &trained, &picture).map_err(|e| format!("at the end: {e}"))?;
    Ok(())
}

/// The steps of a run in which nothing fails, and its policy.
fn sound() -> (u64, Vec<u8>) {
    let files = Faulty::new(0..0, false, io::ErrorKind::Other);
    let path = empty("files-sound");
    attempt(&path, &files).unwrap();
    (files.steps.load(Ordering::Relaxed), fs::read(path.join("policy.safetensors")).unwrap())
}

fn checkpoints(path: &Path) -> Vec<PathBuf> {
    let Ok(entries) = fs::read_dir(path.join("checkpoints")) else { return Vec::new() };
    let files = entries.map(|e| e.unwrap().path());
    files.filter(|p| p.file_name().is_some_and(|n| n.to_string_lossy().starts_with("iteration-"))).collect()
}

/// Whatever step fails, and however: a run that has a checkpoint has a sound one, and goes on from it to the same bits.
#[test]
fn no_fault_of_the_disk_leaves_a_run_without_a_sound_checkpoint() {
    let (steps, policy) = sound();
    assert!(steps > 40, "{steps}");
    let spec = small("hwasp", &[("train.env_steps", "6000")]);
    let assembly = Assembly::new(&spec).unwrap();
    let (mut survived, mut resumed_runs) = (0, 0);
    for (half, for_good) in [(false, false), (true, false), (false, true), (true, true)] {
        for at in 0..steps {
            let path = empty("files-faulty");
            let until = if for_good { u64::MAX } else { at + 1 };
            let told = attempt(&path, &Faulty::new(at..until, half, io::ErrorKind::StorageFull));
            let what = format!("step {at} of {steps}, half {half}, for good {for_good}: {told:?}");
            if told.is_ok() {
                survived += 1;
                assert_eq!(fs::read(path.join("policy.safetensors")).unwrap(), policy, "{what}");
                continue;
            }
            assert!(told.unwrap_err().contains("as the test wants it"), "{what}");
            if !path.join("experiment.toml").is_file() {
                // It failed before anything was learned.
                continue;
            }
            if path.join("summary.json").is_file() {
                // The very last name was given, and only the folder did not come to the disk.
                assert_eq!(fs::read(path.join("policy.safetensors")).unwrap(), policy, "{what}");
                continue;
            }
            let begun = !checkpoints(&path).is_empty();
            let Resumed { mut folder, found } =
                RunFolder::resume(&path, &spec, provenance(&spec), Keeping::default()).unwrap();
            assert_eq!(found.checkpoint.is_some(), begun, "{what}");
            assert!(found.damaged.is_empty(), "{what}: {:?}", found.damaged);
            resumed_runs += 1;
            let from = found.checkpoint.as_ref();
            let trained = train_from(from, &assembly, &Serial, &mut folder, &AtomicBool::new(false)).unwrap();
            folder.finish(&assembly, &trained, &picture).unwrap();
            assert_eq!(fs::read(path.join("policy.safetensors")).unwrap(), policy, "{what}");
        }
    }
    // A single fault on the way costs nothing at all.
    assert!(survived > steps && resumed_runs > steps, "{survived} survived, {resumed_runs} were resumed");
}

/// A disk that is full for a while: training goes on, and in the end everything is there.
#[test]
fn a_disk_that_is_full_for_a_while_costs_nothing() {
    let (path, whole) = (empty("files-while"), empty("files-whole"));
    attempt(&whole, &Faulty::new(0..0, false, io::ErrorKind::Other)).unwrap();
    // Two iterations long.
    attempt(&path, &Faulty::new(15..19, true, io::ErrorKind::StorageFull)).unwrap();
    let rows = |path: &Path| SavedRun::open(path, hwasp_testing::catalogue()).unwrap().metrics().unwrap().rows;
    let returns = |path| rows(path).iter().map(|row| row.discounted_return.to_bits()).collect::<Vec<_>>();
    assert_eq!(returns(&path), returns(&whole));
    assert_eq!(checkpoints(&path).len(), 3);
}

/// Asked to stop while nothing can be written, the program has to say that it failed; and what was there is there.
#[test]
fn a_checkpoint_that_cannot_be_written_at_the_end_is_an_error() {
    let spec = small("hwasp", &[]);
    let (path, assembly) = (empty("files-stopped"), Assembly::new(&spec).unwrap());
    let files = Faulty::new(30..u64::MAX, true, io::ErrorKind::StorageFull);
    let mut folder = RunFolder::create(&path, &spec, &provenance(&spec), keeping(&files)).unwrap();
    let stop = AtomicBool::new(false);
    let mut stopper = Stopper { inner: &mut folder, stop: &stop, after: 5 };
    let error = train(&assembly, &Serial, &mut stopper, &stop).unwrap_err();
    assert!(matches!(error, TrainError::Interrupted { .. }), "{error}");
    let error = folder.settle().unwrap_err();
    assert!(matches!(&error, RunError::Io { .. }), "{error}");
    assert!(error.to_string().contains("as the test wants it"), "{error}");
    drop(folder);
    let found = RunFolder::resume(&path, &spec, provenance(&spec), Keeping::default()).unwrap().found;
    assert!(found.checkpoint.is_some_and(|c| (1..5).contains(&c.iteration)));
}
