//! The engine's view of a set of files: those, and nothing of the disk.
//!
//! The engine asks its virtual file system for each file. That looks for a mount at the path or at a folder above it,
//! then for a mount whose own name is the last part of the path, and then on the disk. So the set is mounted at a folder
//! in which the model lies. What leaves that folder (absolute paths, `..`) meets a second mount, which has no file: one
//! for each name that the texts ask for.
//!
//! The folder's name depends on the set, because the engine keeps meshes and textures for later models by their path and
//! compares contents carelessly.

use std::ffi::{CStr, CString, c_char, c_int, c_void};
use std::fmt;
use std::ptr;
use std::rc::Rc;

use mujoco_rs::mujoco_c::{mj_mountVFS, mjResource, mjfOpenResource, mjpResourceProvider};
use mujoco_rs::wrappers::MjVfs;

use super::super::{BuildError, FileError, Files};
use super::scan::{self, Unreadable};

/// A set of files where the engine finds it. The engine holds pointers into the providers and through them into the set,
/// so both are behind an `Rc` that nobody else has, and are dropped after the file system.
pub(super) struct Mount {
    vfs: MjVfs,
    /// One that opens the files of the set, one that opens none.
    providers: Rc<[mjpResourceProvider; 2]>,
    set: Rc<Set>,
}

/// Files, and the folder at which the engine finds them.
struct Set {
    files: Files,
    folder: String,
}

impl fmt::Debug for Mount {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Mount").field("folder", &self.set.folder).finish_non_exhaustive()
    }
}

impl Mount {
    /// Mounts the files, after reading the texts among them. Returns the name of the outermost element of the text at `main`
    /// too.
    pub(super) fn new(main: &str, files: &Files) -> Result<(Self, String), BuildError> {
        let Some(text) = files.get(main) else {
            let known = files.paths().map(str::to_owned).collect();
            return Err(BuildError::NoFile { path: main.to_owned(), files: known });
        };
        let fault = |file: &str, Unreadable { line, message }| BuildError::Model {
            file: file.to_owned(),
            line: Some(line),
            message,
        };
        if !scan::is_xml(text) {
            let message = "the file is no XML text; a model is MJCF (`<mujoco>`) or URDF (`<robot>`)".to_owned();
            return Err(BuildError::Model { file: main.to_owned(), line: None, message });
        }
        let mut found = scan::scan(text).map_err(|unreadable| fault(main, unreadable))?;
        for (path, bytes) in files.iter().filter(|(path, _)| *path != main) {
            found.parts.append(&mut scan::scan(bytes).map_err(|unreadable| fault(path, unreadable))?.parts);
        }
        let folder = format!("model-{:016x}", files.fingerprint());
        let set = Rc::new(Set { files: files.clone(), folder: folder.clone() });
        let providers = Rc::new([provider(&set, Some(open)), provider(&set, Some(refuse))]);
        let mut mount = Self { vfs: MjVfs::new(), providers, set };
        mount.add(folder.as_bytes(), 0)?;
        for part in &found.parts {
            mount.add(part, 1)?;
        }
        Ok((mount, found.root))
    }

    /// The virtual file system, for the engine.
    pub(super) fn vfs(&self) -> &MjVfs {
        &self.vfs
    }

    /// The path at which the engine finds a file of the set.
    pub(super) fn path(&self, file: &str) -> String {
        format!("{}/{file}", self.set.folder)
    }

    /// The engine's words without the folder.
    pub(super) fn plain(&self, message: &str) -> String {
        message.replace(&format!("{}/", self.set.folder), "")
    }

    /// The set of files.
    pub(super) fn files(&self) -> &Files {
        &self.set.files
    }

    #[expect(unsafe_code, reason = "the wrapper mounts copies of single files only, and then the disk is still open")]
    fn add(&mut self, name: &[u8], provider: usize) -> Result<(), BuildError> {
        let refused = |reason| FileError::Path { path: String::from_utf8_lossy(name).into_owned(), reason };
        let path = CString::new(name).map_err(|_| refused("has a NUL"))?;
        let provider: *const mjpResourceProvider = &raw const self.providers[provider];
        // SAFETY: the file system is live. The provider outlives it (fields are dropped in their order), has all functions
        // that the engine calls without a check, and is not written any more. The reference that `ffi_mut` gives is used
        // for this call alone.
        let status = unsafe { mj_mountVFS(self.vfs.ffi_mut(), path.as_ptr(), provider) };
        // 2 says that something is mounted there already: the engine shortens paths.
        if matches!(status, 0 | 2) { Ok(()) } else { Err(refused("is none that MuJoCo can mount").into()) }
    }
}

fn provider(set: &Rc<Set>, open: mjfOpenResource) -> mjpResourceProvider {
    mjpResourceProvider {
        prefix: ptr::null(),
        open,
        read: Some(read),
        close: Some(close),
        mount: Some(nothing),
        unmount: Some(nothing),
        modified: Some(unchanged),
        write: None,
        data: Rc::as_ptr(set).cast_mut().cast(),
    }
}

/// The bytes of the file that a resource stands for.
///
/// # Safety
///
/// The resource is one that the engine made for a provider of a live [`Mount`].
#[expect(unsafe_code, reason = "the engine hands over pointers")]
unsafe fn bytes<'a>(resource: *const mjResource) -> Option<&'a [u8]> {
    // SAFETY: the engine fills in name and provider of a resource before it calls a provider, and both live as long as the
    // resource does. `data` of our providers points to the `Set` of the same mount, which nobody writes.
    let (set, path) = unsafe {
        ((*(*resource).provider).data.cast_const().cast::<Set>().as_ref()?, CStr::from_ptr((*resource).name))
    };
    let path = path.to_str().ok()?.strip_prefix(set.folder.as_str())?.strip_prefix('/')?;
    set.files.get(path).map(AsRef::as_ref)
}

#[expect(unsafe_code, reason = "the engine calls it")]
unsafe extern "C" fn open(resource: *mut mjResource) -> c_int {
    // SAFETY: only the engine calls it, with a resource of the mount.
    c_int::from(unsafe { bytes(resource) }.is_some())
}

#[expect(unsafe_code, reason = "the engine calls it")]
unsafe extern "C" fn refuse(_: *mut mjResource) -> c_int {
    0
}

#[expect(unsafe_code, reason = "the engine calls it")]
unsafe extern "C" fn read(resource: *mut mjResource, buffer: *mut *const c_void) -> c_int {
    // SAFETY: only the engine calls it, for a resource that was opened, and `buffer` is to be written. The bytes live as
    // long as the mount.
    unsafe {
        let Some(bytes) = bytes(resource) else { return -1 };
        *buffer = bytes.as_ptr().cast();
        c_int::try_from(bytes.len()).unwrap_or(-1)
    }
}

#[expect(unsafe_code, reason = "the engine calls it")]
unsafe extern "C" fn close(_: *mut mjResource) {}

#[expect(unsafe_code, reason = "the engine calls it")]
unsafe extern "C" fn nothing(_: *mut mjResource) -> c_int {
    0
}

/// A path has one content, as the folder's name depends on all contents.
#[expect(unsafe_code, reason = "the engine calls it")]
unsafe extern "C" fn unchanged(_: *const mjResource, _: *const c_char) -> c_int {
    0
}
