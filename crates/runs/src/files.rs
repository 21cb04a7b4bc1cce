//! What a run folder asks of a file system, so that tests can let every single step of it fail.

use std::ffi::OsString;
use std::fmt::Debug;
use std::fs::{self, File, OpenOptions};
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use serde::Serialize;

use crate::error::{RunError, encode, io_error};

/// Steps of writing. Each is done, or fails and may have been done in part.
pub trait Files: Debug + Send + Sync {
    /// Creates a folder and those around it; one that is there already is no error.
    fn create_folder(&self, path: &Path) -> io::Result<()>;
    /// Creates a file, or empties the one that is there, writes to it and waits until it is on the disk.
    fn write(&self, path: &Path, contents: &[u8]) -> io::Result<()>;
    /// Cuts a file, created where it is missing, to `length` and writes behind that.
    fn append(&self, path: &Path, length: u64, contents: &[u8]) -> io::Result<()>;
    /// Waits until a file is on the disk.
    fn sync(&self, path: &Path) -> io::Result<()>;
    /// Puts a file in another's place, in one piece, and waits until the folder is on the disk.
    fn rename(&self, from: &Path, to: &Path) -> io::Result<()>;
    /// Removes a file.
    fn remove(&self, path: &Path) -> io::Result<()>;
}

/// The file system.
#[derive(Clone, Copy, Debug, Default)]
pub struct Disk;

impl Files for Disk {
    fn create_folder(&self, path: &Path) -> io::Result<()> {
        fs::create_dir_all(path)
    }

    fn write(&self, path: &Path, contents: &[u8]) -> io::Result<()> {
        let mut file = File::create(path)?;
        file.write_all(contents)?;
        file.sync_all()
    }

    fn append(&self, path: &Path, length: u64, contents: &[u8]) -> io::Result<()> {
        let mut file = OpenOptions::new().write(true).create(true).truncate(false).open(path)?;
        if file.metadata()?.len() < length {
            let message = format!("the file is shorter than the {length} bytes that were written to it");
            return Err(io::Error::new(io::ErrorKind::UnexpectedEof, message));
        }
        file.set_len(length)?;
        file.seek(SeekFrom::Start(length))?;
        file.write_all(contents)
    }

    fn sync(&self, path: &Path) -> io::Result<()> {
        File::open(path)?.sync_all()
    }

    fn rename(&self, from: &Path, to: &Path) -> io::Result<()> {
        fs::rename(from, to)?;
        // Where folders cannot be opened the system keeps the order of its own accord.
        match to.parent().map(File::open) {
            Some(Ok(folder)) => folder.sync_all(),
            _ => Ok(()),
        }
    }

    fn remove(&self, path: &Path) -> io::Result<()> {
        fs::remove_file(path)
    }
}

/// Writes a file whole or not at all: beside its place first, `.NAME.partial`.
pub fn replace(files: &dyn Files, path: &Path, contents: &[u8]) -> io::Result<()> {
    let beside = partial(path);
    files.write(&beside, contents)?;
    files.rename(&beside, path)
}

/// Where a file is written before it takes its place.
pub(crate) fn partial(path: &Path) -> PathBuf {
    let mut name = OsString::from(".");
    name.push(path.file_name().unwrap_or_default());
    name.push(".partial");
    path.with_file_name(name)
}

/// A value as the text of a JSON file.
pub fn json(file: &'static str, value: &impl Serialize) -> Result<Vec<u8>, RunError> {
    let mut text = serde_json::to_vec_pretty(value).map_err(|e| encode(file, &e))?;
    text.push(b'\n');
    Ok(text)
}

/// Reads a file that a stranger may have sent.
pub fn read_limited(path: &Path, limit: u64) -> Result<Vec<u8>, RunError> {
    let error = |source| io_error("read", path, source);
    let file = File::open(path).map_err(error)?;
    let mut bytes = Vec::new();
    file.take(limit + 1).read_to_end(&mut bytes).map_err(error)?;
    if bytes.len() as u64 > limit {
        let source = io::Error::new(io::ErrorKind::FileTooLarge, format!("it is larger than {limit} bytes"));
        return Err(error(source));
    }
    Ok(bytes)
}

/// Why a folder cannot be created; where a file stands in the place of a folder above it, that file.
pub fn with_file_above(folder: &Path, error: io::Error) -> io::Error {
    let file = folder.ancestors().find(|above| above.is_file());
    file.map_or(error, |file| io::Error::new(io::ErrorKind::NotADirectory, format!("{} is a file", file.display())))
}
