//! What arguments name, as what it stands for: run folders and threads.

use std::num::NonZeroUsize;
use std::path::Path;

use hwasp_core::{Executor, Serial, Threads};
use hwasp_experiment::Catalogue;
use hwasp_runs::SavedRun;

use crate::failure::Failure;

/// The run that was written to a folder.
pub fn saved_run(path: &Path, set: &[String], catalogue: &Catalogue) -> Result<SavedRun, Failure> {
    SavedRun::open_with(run_folder(path)?, set, catalogue).map_err(Failure::input)
}

/// The folder of a run, if there is a folder at all.
pub fn run_folder(path: &Path) -> Result<&Path, Failure> {
    if path.is_dir() {
        return Ok(path);
    }
    let what = if path.exists() { "is not a folder" } else { "does not exist" };
    let hint = "name a run folder; `hwasp train` says where it writes one, under runs/ unless --out names another";
    Err(Failure::input(format!("{} {what}\n  = hint: {hint}", path.display())))
}

/// So many threads.
pub fn executor(threads: NonZeroUsize) -> Result<Box<dyn Executor>, Failure> {
    if threads.get() == 1 { Ok(Box::new(Serial)) } else { Ok(Box::new(Threads::new(threads.get())?)) }
}
