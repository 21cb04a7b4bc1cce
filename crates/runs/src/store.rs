//! The checkpoints of a run folder: the last three and the best, and what is left of iterations that failed.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use hwasp_training::{Checkpoint, FailedIteration};

use crate::checkpoint::{CheckpointError, LARGEST_CHECKPOINT, batch_arrays, decode, encode};
use crate::error::{RunError, io_error};
use crate::files::{self, Files, read_limited};
use crate::layout::{CHECKPOINTS, FAULTS};

/// How many are kept beside the best.
const KEPT: usize = 3;
const BEST: &str = "best.safetensors";

/// The folder `checkpoints` of a run: `iteration-00000120.safetensors` and so on, and `best.safetensors`.
#[derive(Debug)]
pub struct CheckpointStore {
    run: PathBuf,
    folder: PathBuf,
    files: Arc<dyn Files>,
    /// SHA-256 of the resolved experiment.
    experiment: String,
    /// The training return of the best one, if there is one.
    best: Option<f64>,
}

/// What there is to go on from.
#[derive(Debug, Default)]
pub struct Found {
    /// The newest sound checkpoint; none where there never was one.
    pub checkpoint: Option<Checkpoint>,
    /// Newer ones that are of no use.
    pub damaged: Vec<(PathBuf, CheckpointError)>,
}

impl Found {
    /// Warns of those that are of no use.
    pub fn warn(&self) {
        for (path, error) in &self.damaged {
            tracing::warn!("{}: {error}; it is set aside, and training goes on from the one before it", path.display());
        }
    }
}

impl CheckpointStore {
    /// The store of a run folder, which is created with the first checkpoint.
    pub fn new(run: &Path, files: Arc<dyn Files>, experiment: String) -> Self {
        let folder = run.join(CHECKPOINTS);
        // What the best one is worth is in its header. One that cannot be read is replaced by the next.
        let best = read_limited(&folder.join(BEST), LARGEST_CHECKPOINT).ok();
        let best = best.and_then(|bytes| decode(&bytes, &experiment).ok()?.training_return);
        Self { run: run.to_owned(), folder, files, experiment, best }
    }

    /// Writes one, and then removes what is no longer kept.
    ///
    /// # Errors
    /// Where it could not be written: then all that were there are there still.
    pub fn write(&mut self, checkpoint: &Checkpoint) -> Result<(), RunError> {
        let path = self.folder.join(name(checkpoint));
        let bytes = self.put(&path, checkpoint, None)?;
        let best = self.folder.join(BEST);
        if let Some(worth) = checkpoint.training_return
            && (self.best.is_none_or(|best| worth > best) || !best.exists())
        {
            files::replace(&*self.files, &best, &bytes).map_err(|e| io_error("write", &best, e))?;
            self.best = Some(worth);
        }
        for (_, old) in numbered(&self.folder)?.iter().rev().skip(KEPT) {
            self.files.remove(old).map_err(|e| io_error("remove", old, e))?;
        }
        Ok(())
    }

    /// Writes the state before an iteration that failed, and what it learned from, into the folder `faults`; returns where.
    pub fn write_failed(&self, failed: &FailedIteration<'_>) -> Result<PathBuf, RunError> {
        let path = self.run.join(FAULTS).join(name(failed.checkpoint));
        let mut checkpoint = failed.checkpoint.clone();
        if let Some(batch) = failed.batch {
            checkpoint.archive.extend(batch_arrays(batch));
        }
        self.put(&path, &checkpoint, Some(failed.what))?;
        Ok(path)
    }

    /// Writes a file whole or not at all, in a folder that is created where it is missing.
    fn put(&self, path: &Path, checkpoint: &Checkpoint, fault: Option<&str>) -> Result<Vec<u8>, RunError> {
        let error = |source| RunError::Checkpoint { path: path.to_owned(), source };
        let bytes = encode(checkpoint, &self.experiment, fault).map_err(error)?;
        let folder = path.parent().unwrap_or(&self.folder);
        self.files.create_folder(folder).map_err(|e| io_error("create", folder, e))?;
        files::replace(&*self.files, path, &bytes).map_err(|e| io_error("write", path, e))?;
        Ok(bytes)
    }

    /// Gives those that are of no use another name, so that they do not count among the last three.
    pub fn set_aside(&self, found: &Found) -> Result<(), RunError> {
        for (path, _) in &found.damaged {
            let aside = path.with_extension("damaged");
            self.files.rename(path, &aside).map_err(|e| io_error("rename", path, e))?;
        }
        Ok(())
    }

    /// Removes all of them.
    pub fn remove_all(&self) -> Result<(), RunError> {
        let numbered = numbered(&self.folder)?.into_iter().map(|(_, path)| path);
        for path in numbered.chain([self.folder.join(BEST)]).filter(|path| path.exists()) {
            self.files.remove(&path).map_err(|e| io_error("remove", &path, e))?;
        }
        Ok(())
    }

    /// Looks for the newest sound one; where none of the last three is, for the best.
    ///
    /// # Errors
    /// [`RunError::Checkpoint`] where the newest one belongs to another experiment or to a newer program: that is nothing
    /// that an older one could mend. [`RunError::Unsound`] where there are some, but none is sound.
    pub fn newest(&self) -> Result<Found, RunError> {
        let mut found = Found::default();
        let numbered = numbered(&self.folder)?.into_iter().rev().map(|(_, path)| path);
        for path in numbered.chain(Some(self.folder.join(BEST)).filter(|best| best.exists())) {
            let bytes = read_limited(&path, LARGEST_CHECKPOINT)?;
            match decode(&bytes, &self.experiment) {
                Ok(checkpoint) => {
                    found.checkpoint = Some(checkpoint);
                    return Ok(found);
                }
                Err(source @ (CheckpointError::Experiment { .. } | CheckpointError::Version { .. })) => {
                    return Err(RunError::Checkpoint { path, source });
                }
                Err(error) => found.damaged.push((path, error)),
            }
        }
        if found.damaged.is_empty() {
            return Ok(found);
        }
        Err(RunError::Unsound { folder: self.folder.clone(), damaged: found.damaged })
    }
}

fn name(checkpoint: &Checkpoint) -> String {
    format!("iteration-{:08}.safetensors", checkpoint.iteration)
}

/// The numbered checkpoints of a folder, the oldest first.
fn numbered(folder: &Path) -> Result<Vec<(u64, PathBuf)>, RunError> {
    if !folder.exists() {
        return Ok(Vec::new());
    }
    let mut numbered = Vec::new();
    for entry in fs::read_dir(folder).map_err(|e| io_error("read", folder, e))? {
        let path = entry.map_err(|e| io_error("read", folder, e))?.path();
        let name = path.file_name().and_then(|name| name.to_str()).unwrap_or_default();
        let number = name.strip_prefix("iteration-").and_then(|rest| rest.strip_suffix(".safetensors"));
        if let Some(number) = number.and_then(|digits| digits.parse().ok()) {
            numbered.push((number, path));
        }
    }
    numbered.sort();
    Ok(numbered)
}

#[cfg(test)]
mod tests;
