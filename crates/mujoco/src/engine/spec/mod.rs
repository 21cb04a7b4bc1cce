//! Models that are changed before they are compiled: [`Spec`].

mod add;
mod check;
mod error;
mod fields;
mod find;
mod message;
mod mount;
mod numbers;
mod path;
mod scan;
mod unused;
mod urdf;
mod value;
mod visual;
mod write;

use mujoco_rs::prelude::{MjEditError, MjModel, MjSpec};

use super::{BuildError, Files, Simulation, log};
use mount::Mount;

pub use error::SpecError;
pub use fields::{SettableField, settable_fields};
pub use path::{Element, FieldPath};

/// A model in the making, from MJCF or URDF, whose numbers are set by name before it is compiled.
///
/// [`Simulation::edit`] changes some numbers of a compiled model. A length changes more: masses, frames and the places of
/// children follow from it, and that is the compiler's work. So a design that is a robot of its own is set here, and compiled
/// when an episode begins.
#[derive(Debug)]
pub struct Spec {
    /// Dropped first: meshes and textures of the set may still be open.
    inner: MjSpec,
    mount: Mount,
    main: String,
    /// What the engine warned of, each once.
    warnings: Vec<String>,
    /// Ranges that were set, which are checked when all is set: the path of their first number.
    ranges: Vec<FieldPath>,
}

#[expect(unsafe_code, reason = "the wrapper cannot know what a specification shares")]
// SAFETY: a specification may be used by one thread at a time. It shares data with others after it was copied or attached;
// here every copy is dropped before the function that made it returns, and there is no way to get at one. It has no user
// values. The reference counts of the mount have no other owner.
unsafe impl Send for Spec {}

impl Spec {
    /// Reads the model at `main`, MJCF or URDF, with all that it includes. The engine reads what is in `files` and nothing
    /// else; paths inside of texts are relative to the text's folder.
    ///
    /// Of a URDF model every link stays a body of its own, so that it can be named, and the engine's defaults hold:
    /// `<visual>` is passed over unless the text says `<mujoco><compiler discardvisual="false"/></mujoco>`. A mesh may be
    /// named by package or by an absolute path; the one file of the set whose path ends most like it is taken.
    ///
    /// # Errors
    ///
    /// The engine's, with file and line where it says them.
    pub fn parse(main: &str, files: &Files) -> Result<Self, BuildError> {
        log::install();
        let (mount, root) = Mount::new(main, files)?;
        let (parsed, warnings) = log::warnings_of(|| MjSpec::from_xml_vfs(mount.path(main), mount.vfs()));
        let mut spec = parsed.map_err(|_| message::error(&mount, main, &message::parsing(&mount, main)))?;
        if root.eq_ignore_ascii_case("robot") {
            urdf::adapt(&mut spec, main, files)?;
        }
        let mut spec = Self { inner: spec, mount, main: main.to_owned(), warnings: Vec::new(), ranges: Vec::new() };
        spec.check_names()?;
        spec.check_sizes()?;
        spec.check_values()?;
        spec.note(warnings);
        Ok(spec)
    }

    /// Compiles the model as it is now, as often as wanted.
    ///
    /// # Errors
    ///
    /// The compiler's. The model can be changed and compiled again afterwards.
    pub fn compile(&mut self) -> Result<Simulation, BuildError> {
        let (model, _) = self.model()?;
        Simulation::new(model)
    }

    /// What the engine warned of while it read and compiled the model, each once: attributes that will go away, inertias
    /// that are nearly singular.
    pub fn warnings(&self) -> &[String] {
        &self.warnings
    }

    /// The files that the model may read.
    pub fn files(&self) -> &Files {
        self.mount.files()
    }

    fn note(&mut self, warnings: Vec<String>) {
        let kept = (0..self.inner.num_warnings()).filter_map(|index| self.inner.warning(index).map(str::to_owned));
        let all: Vec<String> = warnings.into_iter().chain(kept).map(|warning| self.mount.plain(&warning)).collect();
        for warning in all {
            if !self.warnings.contains(&warning) {
                self.warnings.push(warning);
            }
        }
    }

    /// The compiled model, and the copy that was compiled if it is not the specification itself: the compiler takes out of it
    /// what it fuses or discards, and later changes would not find that.
    fn model(&mut self) -> Result<(MjModel, Option<MjSpec>), BuildError> {
        self.check_ranges()?;
        self.check_quaternions()?;
        let compiler = self.inner.compiler();
        let mut copy = if compiler.fusestatic() || compiler.discardvisual() { Some(self.copy()?) } else { None };
        let spec = copy.as_mut().unwrap_or(&mut self.inner);
        let (compiled, warnings) = log::warnings_of(|| spec.compile_with_vfs(self.mount.vfs()));
        self.note(warnings);
        let model = compiled.map_err(|error| message::error(&self.mount, &self.main, &plain(error)))?;
        Ok((model, copy))
    }

    fn copy(&self) -> Result<MjSpec, BuildError> {
        self.inner.try_clone().map_err(|error| BuildError::Allocation(error.to_string()))
    }
}

/// The engine's words, without the wrapper's.
fn plain(error: MjEditError) -> String {
    match error {
        MjEditError::CompileFailed(said) | MjEditError::OperationFailed(said) => said,
        other => other.to_string(),
    }
}
