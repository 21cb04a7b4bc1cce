//! Run folders being written.

use std::error::Error;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

use hwasp_experiment::{EXPERIMENT, Experiment};
use hwasp_training::{Assembly, Checkpoint, Event, FailedIteration, Observer, ObserverError, Trained};

use super::lock::{LOCK, RunLock};
use super::table::Table;
use super::{Provenance, SavedRun};
use crate::checkpoint::experiment_hash;
use crate::error::{RunError, encode, io_error};
use crate::files::{self, Disk, Files, json, read_limited, with_file_above};
use crate::layout::{DESIGN, METRICS, OWN, POLICY, PROVENANCE, SUMMARY};
use crate::metrics::Columns;
use crate::policy_file::write_policy;
use crate::store::{CheckpointStore, Found};
use crate::summary::Summary;

/// The largest `provenance.json` that is read, bytes.
const LARGEST_PROVENANCE: u64 = 1 << 20;

/// How a run is kept.
#[derive(Clone, Debug)]
pub struct Keeping {
    /// The file system.
    pub files: Arc<dyn Files>,
    /// Time between two checkpoints, at least.
    pub checkpoint_every: Duration,
}

impl Default for Keeping {
    /// On the disk, a checkpoint every 30 s.
    fn default() -> Self {
        Self { files: Arc::new(Disk), checkpoint_every: Duration::from_secs(30) }
    }
}

/// A folder being written: an [`Observer`] that keeps learning curve and checkpoints, and a place for the result.
///
/// What cannot be written while training goes on is kept in memory, warned of and tried again; it is an error only
/// at the end.
#[derive(Debug)]
pub struct RunFolder {
    path: PathBuf,
    keeping: Keeping,
    _lock: RunLock,
    /// The files that the experiment names, which lie beside it.
    named: Arc<hwasp_settings::Files>,
    /// `experiment.toml` and `provenance.json`.
    head: [(&'static str, Vec<u8>); 2],
    store: CheckpointStore,
    /// Once training has begun.
    table: Option<Table>,
    /// Iterations of the checkpoint that it goes on from.
    resumed: u64,
    last_checkpoint: Instant,
    /// The last checkpoint, where it could not be written.
    unsaved: Option<Checkpoint>,
    /// Whether rows could not be written.
    rows_wait: bool,
    fault: Option<PathBuf>,
}

/// Files to be put into a run, by name, or why there are none.
pub type ExtraFiles = Result<Vec<(String, Vec<u8>)>, Box<dyn Error + Send + Sync>>;

/// What gives a run further files, pictures of it, before it counts as finished. It sees the run as it is on the disk.
pub type Extras<'a> = &'a dyn Fn(&SavedRun) -> ExtraFiles;

/// For a run without further files.
pub fn no_extras(_: &SavedRun) -> ExtraFiles {
    Ok(Vec::new())
}

/// A training that can go on.
#[derive(Debug)]
pub struct Resumed {
    /// Its folder.
    pub folder: RunFolder,
    /// What to go on from: the newest sound checkpoint, if there was one before it was interrupted.
    pub found: Found,
}

/// A training that begins.
impl From<RunFolder> for Resumed {
    fn from(folder: RunFolder) -> Self {
        Self { folder, found: Found::default() }
    }
}

impl RunFolder {
    /// Whether a run can keep the files that an experiment names beside its own.
    ///
    /// # Errors
    /// [`RunError::Taken`] of a file that would lie where a run has one of its own.
    pub fn check_names(spec: &Experiment) -> Result<(), RunError> {
        let taken = |path: &&String| {
            let first = path.split('/').next().unwrap_or_default().to_lowercase();
            OWN.contains(&first.as_str()) || first.starts_with('.')
        };
        spec.files().keys().find(taken).map_or(Ok(()), |path| Err(RunError::Taken { file: path.clone() }))
    }

    /// Creates the folder and writes what is known before training. A folder that exists is not touched.
    pub fn create(path: &Path, spec: &Experiment, provenance: &Provenance, keeping: Keeping) -> Result<Self, RunError> {
        Self::check_names(spec)?;
        if let Some(parent) = path.parent().filter(|p| !p.as_os_str().is_empty()) {
            fs::create_dir_all(parent).map_err(|source| io_error("create", path, with_file_above(parent, source)))?;
        }
        match fs::create_dir(path) {
            Ok(()) => {}
            // A folder without files holds nothing that could be lost.
            Err(e) if e.kind() == io::ErrorKind::AlreadyExists && is_blank(path) => {}
            Err(e) if e.kind() == io::ErrorKind::AlreadyExists => {
                return Err(RunError::Exists { path: path.to_owned() });
            }
            Err(source) => return Err(io_error("create", path, source)),
        }
        let folder = Self::new(path, spec, provenance, keeping)?;
        // Between the look and the lock, another process may have been here.
        if !is_blank(path) {
            return Err(RunError::Exists { path: path.to_owned() });
        }
        folder.write_head()?;
        Ok(folder)
    }

    /// Takes up a run that did not come to its end. `provenance`: of the process that goes on with it.
    ///
    /// # Errors
    /// [`RunError::Finished`] where nothing is left to do; [`RunError::Checkpoint`] where its checkpoints are of another
    /// experiment or of a newer program, or none of them is sound. Nothing has changed then.
    pub fn resume(
        path: &Path,
        spec: &Experiment,
        provenance: Provenance,
        keeping: Keeping,
    ) -> Result<Resumed, RunError> {
        if path.join(SUMMARY).is_file() {
            return Err(RunError::Finished { path: path.to_owned() });
        }
        let first = read_limited(&path.join(PROVENANCE), LARGEST_PROVENANCE).ok();
        let first: Option<Provenance> = first.and_then(|bytes| serde_json::from_slice(&bytes).ok());
        let provenance = match first {
            Some(mut first) => {
                first.resumed.push(provenance);
                first
            }
            None => provenance,
        };
        let mut folder = Self::new(path, spec, &provenance, keeping)?;
        // Between the look and the lock, another process may have finished it.
        if path.join(SUMMARY).is_file() {
            return Err(RunError::Finished { path: path.to_owned() });
        }
        let found = folder.store.newest()?;
        folder.store.set_aside(&found)?;
        folder.resumed = found.checkpoint.as_ref().map_or(0, |checkpoint| checkpoint.iteration);
        folder.write_head()?;
        Ok(Resumed { folder, found })
    }

    fn new(path: &Path, spec: &Experiment, provenance: &Provenance, keeping: Keeping) -> Result<Self, RunError> {
        let lock = RunLock::take(path)?;
        let experiment = spec.to_toml().map_err(|e| encode(EXPERIMENT, &e))?;
        let about = "# The experiment as it was run, every setting resolved. `hwasp train` on this file repeats it, if it began afresh.\n";
        let head =
            [(EXPERIMENT, format!("{about}{experiment}").into_bytes()), (PROVENANCE, json(PROVENANCE, provenance)?)];
        let store = CheckpointStore::new(path, Arc::clone(&keeping.files), experiment_hash(&experiment));
        Ok(Self {
            path: path.to_owned(),
            keeping,
            _lock: lock,
            named: Arc::clone(spec.files()),
            head,
            store,
            table: None,
            resumed: 0,
            last_checkpoint: Instant::now(),
            unsaved: None,
            rows_wait: false,
            fault: None,
        })
    }

    /// The first free name for a run of `spec` under `root`: `mass-spring-hwasp-seed0`, then `…-2` and so on.
    pub fn free_name(root: &Path, spec: &Experiment) -> PathBuf {
        let name = format!("{}-{}-seed{}", spec.name.replace(['/', '\\'], "-"), spec.method.name(), spec.seed);
        let numbered = (2..).map(|n| root.join(format!("{name}-{n}")));
        let mut names = std::iter::once(root.join(&name)).chain(numbered);
        names.find(|path| !path.exists()).unwrap_or_else(|| root.join(name))
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Where the state before an iteration that failed was written, if one did.
    pub fn fault(&self) -> Option<&Path> {
        self.fault.as_deref()
    }

    /// Writes what is still in memory of a training that was stopped.
    ///
    /// # Errors
    /// Where that is not possible: what was written before is still there.
    pub fn settle(&mut self) -> Result<(), RunError> {
        match self.unsaved.take() {
            Some(checkpoint) => self.keep(&checkpoint),
            None => Ok(()),
        }
    }

    /// Writes what training gave: parameters, design, the `extras`, and last the summary, which marks the run as finished.
    pub fn finish(&mut self, assembly: &Assembly, trained: &Trained, extras: Extras<'_>) -> Result<Summary, RunError> {
        let summary = Summary::new(assembly, trained);
        self.stand()?;
        if let Some(table) = &mut self.table {
            table.sync(&*self.keeping.files)?;
        }
        let policy = write_policy(&assembly.policy, &trained.params)
            .map_err(|source| RunError::Policy { path: self.path.join(POLICY), source })?;
        self.write(POLICY, &policy)?;
        let design = toml::to_string(&summary.design).map_err(|e| encode(DESIGN, &e))?;
        let about = "# The design in SI units. `as_built` is what to build; it differs from `values` only where the law softens an\n\
                     # interface that is rigid in reality.\n\n";
        self.write(DESIGN, format!("{about}{design}").as_bytes())?;
        let saved = SavedRun::open(&self.path, assembly.experiment().catalogue())?;
        for (name, contents) in extras(&saved).map_err(of_extra)? {
            self.write(&name, &contents)?;
        }
        self.write(SUMMARY, &json(SUMMARY, &summary)?)?;
        Ok(summary)
    }

    /// Removes the checkpoints of a run that is finished.
    pub fn remove_checkpoints(&self) -> Result<(), RunError> {
        self.store.remove_all()
    }

    /// Writes a file whole or not at all.
    fn write(&self, name: &str, contents: &[u8]) -> Result<(), RunError> {
        let path = self.path.join(name);
        files::replace(&*self.keeping.files, &path, contents).map_err(|source| io_error("write", &path, source))
    }

    fn write_head(&self) -> Result<(), RunError> {
        for (path, contents) in self.named.iter() {
            if let Some((folder, _)) = path.rsplit_once('/') {
                let folder = self.path.join(folder);
                fs::create_dir_all(&folder).map_err(|e| io_error("create", &folder, e))?;
            }
            self.write(path, contents)?;
        }
        self.head.iter().try_for_each(|(name, contents)| self.write(name, contents))
    }

    /// Puts the folder back where someone has removed it.
    fn stand(&self) -> Result<(), RunError> {
        if self.path.join(EXPERIMENT).exists() {
            return Ok(());
        }
        tracing::warn!("{} was removed by someone else: it is made again", self.path.display());
        self.keeping.files.create_folder(&self.path).map_err(|e| io_error("create", &self.path, e))?;
        self.write_head()
    }

    /// Writes rows; those that cannot be written wait.
    fn write_rows(&mut self) {
        let Some(table) = &mut self.table else { return };
        match table.flush(&*self.keeping.files) {
            Ok(()) if self.rows_wait => {
                self.rows_wait = false;
                tracing::info!("{} is written again", table.path().display());
            }
            Err(error) if !self.rows_wait => {
                self.rows_wait = true;
                tracing::warn!("{error}; training goes on, the rows are kept in memory and tried again");
            }
            Ok(()) | Err(_) => {}
        }
    }

    /// Writes a checkpoint, and before it the rows that belong to it.
    pub fn keep(&mut self, checkpoint: &Checkpoint) -> Result<(), RunError> {
        self.stand()?;
        if let Some(table) = &mut self.table {
            table.sync(&*self.keeping.files)?;
        }
        self.store.write(checkpoint)
    }

    fn keep_or_warn(&mut self, checkpoint: &Checkpoint) {
        let result = self.keep(checkpoint);
        self.last_checkpoint = Instant::now();
        match result {
            Ok(()) => {
                if self.unsaved.take().is_some() {
                    tracing::info!("checkpoints are written again");
                }
                tracing::debug!(iteration = checkpoint.iteration, env_steps = checkpoint.env_steps, "checkpoint");
            }
            Err(error) => {
                let again = self.keeping.checkpoint_every.as_secs_f64();
                tracing::warn!("no checkpoint: {error}; training goes on, and it is tried again in {again} s");
                self.unsaved = Some(checkpoint.clone());
            }
        }
    }

    fn keep_failed(&mut self, failed: &FailedIteration<'_>) {
        self.keep_or_warn(failed.checkpoint);
        match self.store.write_failed(failed) {
            Ok(path) => self.fault = Some(path),
            Err(error) => tracing::warn!("what failed could not be written down: {error}"),
        }
    }

    /// Begins the learning curve, or cuts it back to the checkpoint that training goes on from.
    fn begin(&mut self, columns: Columns<'_>) -> Result<(), RunError> {
        let path = self.path.join(METRICS);
        self.table = Some(Table::resume(&path, &*self.keeping.files, columns, self.resumed)?);
        self.last_checkpoint = Instant::now();
        Ok(())
    }
}

impl Observer for RunFolder {
    fn on(&mut self, event: Event<'_>) -> Result<(), ObserverError> {
        let boxed = |error| ObserverError(Box::new(error));
        match event {
            Event::Started { learner, terms, totals, .. } => {
                self.begin(Columns { learner, terms, totals }).map_err(boxed)?;
            }
            Event::Iteration(row) => {
                if let Some(table) = &mut self.table {
                    table.push(row).map_err(boxed)?;
                }
                self.write_rows();
            }
            Event::Checkpoint(checkpoint) => self.keep_or_warn(checkpoint),
            Event::Failed(failed) => self.keep_failed(failed),
            Event::Evaluating | Event::Evaluated(_) => {}
        }
        Ok(())
    }

    fn due(&self) -> bool {
        self.last_checkpoint.elapsed() >= self.keeping.checkpoint_every
    }
}

/// What went wrong with a further file; of the run itself where it is that.
fn of_extra(error: Box<dyn Error + Send + Sync>) -> RunError {
    match error.downcast() {
        Ok(error) => *error,
        Err(error) => RunError::Extra(error),
    }
}

/// Whether a folder has nothing but what a run that was killed at once leaves: a lock, a file half written.
fn is_blank(path: &Path) -> bool {
    let left = |entry: io::Result<fs::DirEntry>| {
        let name = entry.map(|e| e.file_name().to_string_lossy().into_owned()).unwrap_or_default();
        name == LOCK || (name.starts_with('.') && name.ends_with(".partial"))
    };
    fs::read_dir(path).is_ok_and(|mut entries| entries.all(left))
}
