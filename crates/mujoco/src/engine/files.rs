//! The files of a model, in memory.

use std::collections::BTreeMap;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::sync::Arc;

/// The longest path, bytes. Longer ones may be cut by the engine.
const LONGEST: usize = 512;

/// The files that a model may read: MJCF or URDF texts, meshes, textures, height fields. The engine sees these and no
/// file of the disk. Clones share the bytes.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Files {
    files: BTreeMap<String, Arc<[u8]>>,
}

/// A file that cannot be in a set.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum FileError {
    /// Not a relative path of plain parts.
    #[error(
        "the path `{path}` {reason}; paths are relative to the folder of the model, such as `assets/leg.stl`, with at most \
         512 bytes"
    )]
    Path {
        /// The path.
        path: String,
        /// What is wrong with it.
        reason: &'static str,
    },
    /// The engine counts bytes in 31 bits.
    #[error("the file `{path}` has {bytes} bytes; a file of a model has fewer than 2^31")]
    Large {
        /// The path.
        path: String,
        /// Its length.
        bytes: usize,
    },
    /// Two files of one path.
    #[error("the file `{0}` is given twice")]
    Twice(String),
}

impl Files {
    /// A set of files by their paths, which are relative and have `/` between their parts.
    pub fn new<P: Into<String>, B: Into<Arc<[u8]>>>(
        files: impl IntoIterator<Item = (P, B)>,
    ) -> Result<Self, FileError> {
        let mut set = Self::default();
        for (path, bytes) in files {
            set.insert(path, bytes)?;
        }
        Ok(set)
    }

    /// Adds a file.
    pub fn insert(&mut self, path: impl Into<String>, bytes: impl Into<Arc<[u8]>>) -> Result<(), FileError> {
        let (path, bytes) = (path.into(), bytes.into());
        if let Some(reason) = fault(&path) {
            return Err(FileError::Path { path, reason });
        }
        if i32::try_from(bytes.len()).is_err() {
            return Err(FileError::Large { path, bytes: bytes.len() });
        }
        if self.files.contains_key(&path) {
            return Err(FileError::Twice(path));
        }
        self.files.insert(path, bytes);
        Ok(())
    }

    /// The bytes of a file.
    pub fn get(&self, path: &str) -> Option<&Arc<[u8]>> {
        self.files.get(path)
    }

    /// Paths and bytes, by path.
    pub fn iter(&self) -> impl Iterator<Item = (&str, &Arc<[u8]>)> {
        self.files.iter().map(|(path, bytes)| (path.as_str(), bytes))
    }

    /// The paths, in order.
    pub fn paths(&self) -> impl Iterator<Item = &str> {
        self.files.keys().map(String::as_str)
    }

    /// A number that tells sets apart while the program runs.
    pub(super) fn fingerprint(&self) -> u64 {
        let mut hasher = DefaultHasher::new();
        self.files.hash(&mut hasher);
        hasher.finish()
    }
}

/// Why the engine could read another file than the one of this path.
fn fault(path: &str) -> Option<&'static str> {
    if path.is_empty() || path.len() > LONGEST {
        Some("is empty or too long")
    } else if path.contains(['\\', ':', '\0']) {
        Some("has a backslash, a colon or a NUL")
    } else if path.split('/').any(|part| matches!(part, "" | "." | "..")) {
        Some("is absolute or has a part that is empty, `.` or `..`")
    } else {
        None
    }
}
