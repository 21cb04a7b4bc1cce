//! Projects for your own mechanism: a folder with a law, a plant, a task, an experiment and tests, ready to be built.

mod name;
mod template;

use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use hwasp_settings::text::printable;
use thiserror::Error;

pub(crate) use self::template::Template;

/// The checkout on this machine that a project is built with.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Checkout(PathBuf);

/// A project to be written.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Project {
    folder: PathBuf,
    name: String,
    template: Template,
    checkout: Checkout,
}

/// Why no project can be written. Nothing has changed then, unless a file could not be written.
#[derive(Debug, Error)]
pub(crate) enum ProjectError {
    /// A folder with something in it.
    #[error("{} is not empty: it has {}", .folder.display(), shown(.found))]
    NotEmpty {
        /// The folder.
        folder: PathBuf,
        /// What is in it.
        found: Vec<String>,
    },
    /// A file where the folder should be.
    #[error("{} is a file, where a project is a folder", .path.display())]
    File {
        /// The file.
        path: PathBuf,
    },
    /// A name that Cargo takes for no package's.
    #[error("`{name}` is no name for a package: {why}")]
    Name {
        /// The name.
        name: String,
        /// What is wrong with it.
        why: &'static str,
    },
    /// A folder that is no checkout.
    #[error("{} is no checkout of hwasp: it has no {MARK} of the package hwasp-training", .path.display())]
    NoCheckout {
        /// The folder.
        path: PathBuf,
    },
    /// A program that was taken out of its checkout.
    #[error("this program does not lie in a checkout of hwasp, and a project is built with hwasp's sources")]
    NoSources,
    /// The file system.
    #[error("cannot {action} {}: {source}", .path.display())]
    Io {
        /// read, write …
        action: &'static str,
        /// The file or folder.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
}

/// By this file a checkout is known.
const MARK: &str = "crates/training/Cargo.toml";

impl Project {
    /// Checks what was asked for. Without a `name` the folder's is taken, in lower case and with hyphens for spaces; without the
    /// path of a `checkout`, the one in which this program lies.
    pub(crate) fn new(
        folder: &Path,
        name: Option<&str>,
        template: Template,
        checkout: Option<&Path>,
    ) -> Result<Self, ProjectError> {
        let found = entries(folder)?;
        if !found.is_empty() {
            return Err(ProjectError::NotEmpty { folder: folder.to_owned(), found });
        }
        let name = name.map_or_else(|| name::of_folder(folder), str::to_owned);
        name::check(&name)?;
        let checkout = checkout.map_or_else(own_checkout, self::checkout)?;
        Ok(Self { folder: folder.to_owned(), name, template, checkout })
    }

    /// Its name as a package.
    pub(crate) fn name(&self) -> &str {
        &self.name
    }

    /// The path of the checkout that it is built with.
    pub(crate) fn checkout(&self) -> &Path {
        &self.checkout.0
    }

    /// Writes it. `Cargo.lock` has the versions that hwasp is tested with, which are on this machine already.
    pub(crate) fn write(&self) -> Result<Lock, ProjectError> {
        for (path, text) in self.template.files(&self.name, &self.checkout)? {
            let path = self.folder.join(path);
            if let Some(parent) = path.parent() {
                fs::create_dir_all(parent).map_err(|source| io_error("create", parent, source))?;
            }
            fs::write(&path, text).map_err(|source| io_error("write", &path, source))?;
        }
        let (from, to) = (self.checkout().join("Cargo.lock"), self.folder.join("Cargo.lock"));
        if from.is_file() {
            fs::copy(&from, &to).map_err(|source| io_error("write", &to, source))?;
        }
        Ok(self.lock())
    }

    /// Lets Cargo take out of the copied `Cargo.lock` what this project does not use, and put the project in. No version changes.
    fn lock(&self) -> Lock {
        let mut cargo = Command::new("cargo");
        cargo.args(["update", "--workspace", "--offline", "--quiet"]).current_dir(&self.folder).stdin(Stdio::null());
        match cargo.output() {
            Ok(output) if output.status.success() => Lock::Fits,
            Ok(_) | Err(_) => Lock::FirstBuild,
        }
    }
}

/// Whose `Cargo.lock` a new project has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Lock {
    /// Its own: it builds with `--locked`.
    Fits,
    /// That of the checkout, because Cargo could not be asked. The first build makes it the project's own.
    FirstBuild,
}

/// The checkout of hwasp at `path`, as an absolute path.
fn checkout(path: &Path) -> Result<Checkout, ProjectError> {
    let no_checkout = || ProjectError::NoCheckout { path: path.to_owned() };
    let absolute = path.canonicalize().map_err(|_| no_checkout())?;
    if is_checkout(&absolute) { Ok(Checkout(absolute)) } else { Err(no_checkout()) }
}

/// The checkout that this program was built in: the one in whose target folder it lies.
fn own_checkout() -> Result<Checkout, ProjectError> {
    let program = std::env::current_exe().unwrap_or_default();
    // `cargo run` says it; its target folder may lie elsewhere.
    let package = std::env::var_os("CARGO_MANIFEST_DIR").map(PathBuf::from).unwrap_or_default();
    let checkout = program.ancestors().chain(package.ancestors()).find(|folder| is_checkout(folder));
    checkout.map(|folder| Checkout(folder.to_owned())).ok_or(ProjectError::NoSources)
}

fn is_checkout(folder: &Path) -> bool {
    fs::read_to_string(folder.join(MARK)).is_ok_and(|manifest| manifest.contains("name = \"hwasp-training\""))
}

/// What is in a folder, in order; nothing where there is no folder. The store of a version control does not count.
fn entries(folder: &Path) -> Result<Vec<String>, ProjectError> {
    let entries = match fs::read_dir(folder) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(Vec::new()),
        Err(_) if folder.is_file() => return Err(ProjectError::File { path: folder.to_owned() }),
        entries => entries.map_err(|source| io_error("create", folder, source))?,
    };
    let mut found = Vec::new();
    for entry in entries {
        let entry = entry.map_err(|source| io_error("read", folder, source))?;
        found.push(printable(&entry.file_name().to_string_lossy()));
    }
    found.retain(|name| name != ".git");
    found.sort();
    Ok(found)
}

/// The first few of some names.
fn shown(names: &[String]) -> String {
    const MOST: usize = 5;
    let first = names.iter().take(MOST).map(String::as_str).collect::<Vec<_>>().join(", ");
    if names.len() > MOST { format!("{first} and {} more", names.len() - MOST) } else { first }
}

fn io_error(action: &'static str, path: &Path, source: io::Error) -> ProjectError {
    ProjectError::Io { action, path: path.to_owned(), source }
}
