//! Folders that lists are written into.

use std::path::Path;

use hwasp_runs::files::{Disk, Files, with_file_above};
use hwasp_runs::{RunError, io_error};

/// Whether files can be written into a folder, which is created where it is missing: to be asked before work that takes long.
pub fn writable(folder: &Path) -> Result<(), RunError> {
    Disk.create_folder(folder).map_err(|source| io_error("create", folder, with_file_above(folder, source)))?;
    let trial = folder.join(".hwasp.partial");
    let error = |source| io_error("write into", folder, source);
    Disk.write(&trial, b"").map_err(error)?;
    Disk.remove(&trial).map_err(error)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Lists were simulated for half a minute, and only then it was found that they could not be written.
    #[test]
    fn a_folder_is_tried_before_the_work() {
        let folder = std::env::temp_dir().join(format!("hwasp-writable-{}", std::process::id()));
        writable(&folder.join("deep")).unwrap();
        assert_eq!(std::fs::read_dir(folder.join("deep")).unwrap().count(), 0);
        std::fs::write(folder.join("file"), "").unwrap();
        let error = writable(&folder.join("file")).unwrap_err().to_string();
        assert!(error.contains("file") && error.contains("create"), "{error}");
        // A folder in the place of the trial file stands for one that may not be written.
        std::fs::create_dir(folder.join("deep/.hwasp.partial")).unwrap();
        let error = writable(&folder.join("deep")).unwrap_err().to_string();
        assert!(error.contains("write into") && error.contains("deep"), "{error}");
        std::fs::remove_dir_all(&folder).unwrap();
    }
}
