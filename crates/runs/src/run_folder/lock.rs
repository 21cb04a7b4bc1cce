//! One program at a time writes to a run folder.

use std::collections::HashSet;
use std::fs::{self, File, OpenOptions, TryLockError};
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

/// The run folders that some program writes to at this moment. To ask takes no lock, so that nobody who begins to write is in the
/// way of somebody who looks.
#[derive(Debug, Default)]
pub struct Writers {
    /// The files that are locked, by their numbers in the file system.
    locked: HashSet<u64>,
}

impl Writers {
    /// Those of this moment. Where the system does not tell (it is not Linux, or the writer is on another machine), there are none.
    pub fn now() -> Self {
        // `1: FLOCK  ADVISORY  WRITE 13883 fe:00:10117228 0 EOF`: the last part of the sixth word is the number of the file.
        let text = fs::read_to_string("/proc/locks").unwrap_or_default();
        let number = |line: &str| line.split_whitespace().nth(5)?.rsplit(':').next()?.parse().ok();
        Self { locked: text.lines().filter(|line| line.contains("WRITE")).filter_map(number).collect() }
    }

    /// Whether one writes to this folder.
    #[cfg(unix)]
    pub fn write_to(&self, folder: &Path) -> bool {
        use std::os::unix::fs::MetadataExt;
        fs::metadata(folder.join(LOCK)).is_ok_and(|file| self.locked.contains(&file.ino()))
    }

    /// Whether one writes to this folder: not known here.
    #[cfg(not(unix))]
    pub fn write_to(&self, _: &Path) -> bool {
        false
    }
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use super::*;

    #[test]
    fn a_folder_has_a_writer_as_long_as_it_is_locked() {
        let folder = std::env::temp_dir().join(format!("hwasp-writers-{}", std::process::id()));
        fs::create_dir_all(&folder).unwrap();
        assert!(!Writers::now().write_to(&folder));
        let lock = RunLock::take(&folder).unwrap();
        assert!(Writers::now().write_to(&folder));
        drop(lock);
        assert!(!Writers::now().write_to(&folder));
        fs::remove_dir_all(&folder).unwrap();
    }
}
