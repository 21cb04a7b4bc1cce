//! The files that an experiment names: beside it on the disk, or sent along with it.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{self, Read};
use std::path::{Component, Path, PathBuf};
use std::sync::Arc;

use thiserror::Error;

use crate::suggest::nearest;
use crate::text::shorten;

/// The contents of files by their paths relative to a folder, with `/` between the parts.
pub type Files = BTreeMap<String, Arc<[u8]>>;

/// Where the files that an experiment names are.
#[derive(Clone, Debug, Default)]
pub enum Folder {
    /// Nowhere: the experiment is a text by itself.
    #[default]
    Nowhere,
    /// On the disk, below this folder.
    Disk(PathBuf),
    /// With the experiment.
    Sent(Arc<Files>),
}

/// Why a file is not read.
#[derive(Debug, Error)]
pub enum FolderError {
    /// There is no folder.
    #[error("`{path}` cannot be found: this experiment has no folder")]
    Nowhere {
        /// The path as written.
        path: String,
    },
    /// A path that leads out of the folder.
    #[error("`{path}` is not inside of the experiment's folder")]
    Outside {
        /// The path as written.
        path: String,
    },
    /// No such file.
    #[error("there is no file `{path}`")]
    Missing {
        /// The path, from the experiment's folder.
        path: String,
        /// What is there instead and has nearly this name.
        near: Option<String>,
    },
    /// A file that is too large.
    #[error("`{path}` has more than {most} bytes")]
    Large {
        /// The path, from the experiment's folder.
        path: String,
        /// The most that is read.
        most: u64,
    },
    /// A file that cannot be read.
    #[error("`{path}` cannot be read: {source}")]
    Unreadable {
        /// The path, from the experiment's folder.
        path: String,
        /// Why.
        source: io::Error,
    },
}

impl FolderError {
    /// A way out.
    pub fn hint(&self) -> String {
        match self {
            Self::Nowhere { .. } => "write the experiment into a file; paths are relative to its folder".to_owned(),
            Self::Outside { .. } => {
                "put the file into the folder of the experiment, or below it; paths are relative to it".to_owned()
            }
            Self::Missing { near: Some(near), .. } => format!("did you mean `{near}`?"),
            Self::Missing { near: None, .. } => "paths are relative to the folder of the experiment".to_owned(),
            Self::Large { .. } => "is this the right file?".to_owned(),
            Self::Unreadable { .. } => "see that you may read it".to_owned(),
        }
    }
}

/// The path of a file in a folder in its one form, with `/` and without `.` and `..`; none where it leads out of the folder.
pub fn inside(path: &str) -> Option<String> {
    if path.is_empty() || path.contains(['\0', '\\']) {
        return None;
    }
    let mut parts: Vec<&str> = Vec::new();
    for component in Path::new(path).components() {
        match component {
            Component::Normal(part) => parts.push(part.to_str()?),
            Component::CurDir => {}
            Component::ParentDir => _ = parts.pop()?,
            Component::RootDir | Component::Prefix(_) => return None,
        }
    }
    (!parts.is_empty()).then(|| parts.join("/"))
}

impl Folder {
    /// Reads a file of at most `most` bytes. Nothing outside of the folder is read, by whatever path or link.
    ///
    /// # Errors
    /// Where there is no such file, or it is not to be read.
    pub fn read(&self, path: &str, most: u64) -> Result<Arc<[u8]>, FolderError> {
        let shown = || shorten(path, 120);
        let Some(inside) = inside(path) else { return Err(FolderError::Outside { path: shown() }) };
        let missing = |names: Vec<String>| FolderError::Missing {
            path: shown(),
            near: nearest(&inside, names.iter().map(String::as_str)).map(str::to_owned),
        };
        match self {
            Self::Nowhere => Err(FolderError::Nowhere { path: shown() }),
            Self::Sent(files) => match files.get(&inside) {
                Some(bytes) if bytes.len() as u64 > most => Err(FolderError::Large { path: shown(), most }),
                Some(bytes) => Ok(Arc::clone(bytes)),
                None => Err(missing(files.keys().cloned().collect())),
            },
            Self::Disk(folder) => {
                let unreadable = |source| FolderError::Unreadable { path: shown(), source };
                let file = folder.join(&inside);
                if !file.exists() {
                    return Err(missing(beside(folder, &inside)));
                }
                // A link may lead anywhere.
                let (root, real) =
                    (folder.canonicalize().map_err(unreadable)?, file.canonicalize().map_err(unreadable)?);
                if !real.starts_with(&root) {
                    return Err(FolderError::Outside { path: shown() });
                }
                if !real.is_file() {
                    return Err(unreadable(io::Error::other("it is no file")));
                }
                let mut bytes = Vec::new();
                let opened = File::open(&real).map_err(unreadable)?;
                opened.take(most.saturating_add(1)).read_to_end(&mut bytes).map_err(unreadable)?;
                if bytes.len() as u64 > most {
                    return Err(FolderError::Large { path: shown(), most });
                }
                Ok(bytes.into())
            }
        }
    }
}

/// What is in the folder of a file that is missing.
fn beside(folder: &Path, file: &str) -> Vec<String> {
    let (before, _) = file.rsplit_once('/').unwrap_or(("", file));
    let entries = std::fs::read_dir(folder.join(before)).into_iter().flatten().flatten().take(1000);
    let name = |entry: std::fs::DirEntry| {
        let name = entry.file_name().to_str()?.to_owned();
        Some(if before.is_empty() { name } else { format!("{before}/{name}") })
    };
    entries.filter_map(name).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_have_one_form_and_stay_inside() {
        for (path, wanted) in [
            ("a.xml", Some("a.xml")),
            ("./m/../a.xml", Some("a.xml")),
            ("m//b.stl", Some("m/b.stl")),
            ("../a.xml", None),
            ("m/../../a.xml", None),
            ("/etc/passwd", None),
            ("c:\\a.xml", None),
            ("", None),
            (".", None),
        ] {
            assert_eq!(inside(path).as_deref(), wanted, "{path}");
        }
    }

    #[test]
    fn what_is_sent_is_read_as_what_lies_on_the_disk() {
        let folder = std::env::temp_dir().join(format!("hwasp-folder-{}", std::process::id()));
        std::fs::create_dir_all(folder.join("m")).unwrap();
        std::fs::write(folder.join("m/robot.xml"), b"<mujoco/>").unwrap();
        let sent = Files::from([("m/robot.xml".to_owned(), Arc::from(&b"<mujoco/>"[..]))]);
        for folder in [Folder::Disk(folder.clone()), Folder::Sent(Arc::new(sent))] {
            assert_eq!(&*folder.read("m/robot.xml", 9).unwrap(), b"<mujoco/>");
            let said = |path: &str, most| {
                let error = folder.read(path, most).unwrap_err();
                format!("{error}; {}", error.hint())
            };
            assert_eq!(said("m/robot.xml", 8), "`m/robot.xml` has more than 8 bytes; is this the right file?");
            assert_eq!(said("m/robto.xml", 9), "there is no file `m/robto.xml`; did you mean `m/robot.xml`?");
            assert!(said("../m/robot.xml", 9).starts_with("`../m/robot.xml` is not inside of the experiment's folder"));
        }
        #[cfg(unix)]
        {
            std::os::unix::fs::symlink("/etc/hostname", folder.join("out")).unwrap();
            let error = Folder::Disk(folder.clone()).read("out", 1000).unwrap_err();
            assert!(matches!(error, FolderError::Outside { .. }) || !Path::new("/etc/hostname").exists(), "{error}");
        }
        std::fs::remove_dir_all(folder).unwrap();
    }
}
