//! The folder of an export: nothing in it is replaced but what an export of the same run wrote.

use std::collections::BTreeSet;
use std::path::Path;

use hwasp_experiment::Experiment;
use hwasp_runs::files::{Disk, Files, json, read_limited, replace, with_file_above};
use hwasp_runs::io_error;
use serde::{Deserialize, Serialize};

use crate::error::ExportError;
use crate::file::ExportFile;

/// What an export says of itself, in the folder.
const MANIFEST: &str = "export.json";
/// The largest that is read, bytes.
const LARGEST_MANIFEST: u64 = 1 << 20;
const FORMAT: &str = "hwasp-export-1";

/// Whose export a folder has, and which files belong to it.
#[derive(Debug, Serialize, Deserialize)]
struct Manifest {
    format: String,
    hwasp_version: String,
    experiment: String,
    method: String,
    seed: u64,
    files: BTreeSet<String>,
}

impl Manifest {
    fn new(spec: &Experiment) -> Self {
        Self {
            format: FORMAT.to_owned(),
            hwasp_version: env!("CARGO_PKG_VERSION").to_owned(),
            experiment: spec.name.clone(),
            method: spec.method.name().to_owned(),
            seed: spec.seed,
            files: BTreeSet::new(),
        }
    }

    /// The run, in words.
    fn run(&self) -> String {
        format!("{} ({}, seed {})", self.experiment, self.method, self.seed)
    }
}

/// Writes files of a run into a folder, which is created where it is missing.
pub(super) fn write(folder: &Path, spec: &Experiment, files: &[ExportFile]) -> Result<(), ExportError> {
    let mut manifest = Manifest::new(spec);
    if let Some(before) = read(folder)? {
        if before.run() != manifest.run() {
            let (path, there, this) = (folder.to_owned(), before.run(), manifest.run());
            return Err(ExportError::OtherRun { path, there, this });
        }
        manifest.files = before.files;
    }
    for file in files {
        let path = folder.join(&file.name);
        // Whatever is there counts, a link to nowhere too.
        if path.symlink_metadata().is_ok() && !manifest.files.contains(&file.name) {
            return Err(ExportError::Foreign { path });
        }
    }
    // The manifest first: a file that it names and that is missing does no harm, one that it does not name is foreign.
    manifest.files.extend(files.iter().map(|file| file.name.clone()));
    put(folder, MANIFEST, &json(MANIFEST, &manifest)?)?;
    for file in files {
        put(folder, &file.name, &file.contents)?;
    }
    Ok(())
}

/// Writes a file whole or not at all.
fn put(folder: &Path, name: &str, contents: &[u8]) -> Result<(), ExportError> {
    let path = folder.join(name);
    let around = path.parent().unwrap_or(folder);
    let error = |action, path, source| ExportError::Write(io_error(action, path, source));
    Disk.create_folder(around).map_err(|source| error("create", around, with_file_above(around, source)))?;
    replace(&Disk, &path, contents).map_err(|source| error("write", &path, source))
}

/// The manifest of an earlier export, if there is one.
fn read(folder: &Path) -> Result<Option<Manifest>, ExportError> {
    let path = folder.join(MANIFEST);
    if path.symlink_metadata().is_err() {
        return Ok(None);
    }
    let bytes = read_limited(&path, LARGEST_MANIFEST)?;
    match serde_json::from_slice::<Manifest>(&bytes) {
        Ok(manifest) if manifest.format == FORMAT => Ok(Some(manifest)),
        _ => Err(ExportError::Foreign { path }),
    }
}
