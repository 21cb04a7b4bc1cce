//! What tells one state of a file from another.

use std::fs;
use std::path::Path;
use std::time::{SystemTime, UNIX_EPOCH};

/// Time and length of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct Stamp {
    modified: Option<SystemTime>,
    length: u64,
}

impl Stamp {
    /// Of a file; none where there is none. A link is none: it may lead out of the run folder.
    pub(crate) fn of(path: &Path) -> Option<Self> {
        let file = fs::symlink_metadata(path).ok().filter(fs::Metadata::is_file)?;
        Some(Self { modified: file.modified().ok(), length: file.len() })
    }

    /// Seconds since 1970, UTC.
    pub(crate) fn unix_s(self) -> Option<f64> {
        Some(self.modified?.duration_since(UNIX_EPOCH).ok()?.as_secs_f64())
    }
}
