//! One program at a time writes to a run folder.

use std::fs::{File, OpenOptions, TryLockError};
use std::io::{ErrorKind, Read, Seek, Write};
use std::path::Path;

use crate::error::{RunError, io_error};

/// The file that is locked. It stays: to remove it would let two others lock two files of this name.
pub(super) const LOCK: &str = ".lock";

/// Holds a run folder; the system gives it back however the process ends, so that a dead owner holds nothing.
#[derive(Debug)]
pub(super) struct RunLock {
    _file: File,
}

impl RunLock {
    /// Takes a folder, which is there.
    ///
    /// # Errors
    /// [`RunError::InUse`] where another process has it.
    pub(super) fn take(folder: &Path) -> Result<Self, RunError> {
        let path = folder.join(LOCK);
        let error = |source| io_error("lock", &path, source);
        let open = OpenOptions::new().read(true).write(true).create(true).truncate(false).open(&path);
        let mut file = open.map_err(error)?;
        match file.try_lock() {
            Ok(()) => {
                let written = file.set_len(0).and_then(|()| writeln!(file, "{}", std::process::id()));
                written.map_err(error)?;
            }
            Err(TryLockError::WouldBlock) => {
                let mut owner = String::new();
                let _ = file.rewind();
                // Nobody but the owner's curiosity depends on it.
                let _ = (&file).take(20).read_to_string(&mut owner);
                let owner = owner.trim();
                let owner = if owner.is_empty() { "unknown" } else { owner }.to_owned();
                return Err(RunError::InUse { path: folder.to_owned(), owner });
            }
            // Some network file systems have no locks.
            Err(TryLockError::Error(e)) if e.kind() == ErrorKind::Unsupported => {
                tracing::warn!(
                    "{} cannot be locked ({e}): see to it that nothing else trains into it",
                    folder.display()
                );
            }
            Err(TryLockError::Error(e)) => return Err(error(e)),
        }
        Ok(Self { _file: file })
    }
}
