//! The trait that every problem implements, and the same with its settings' type erased.

use hwasp_settings::{AnySettings, Folder, Settings};

use crate::built::Built;
use crate::error::AnyError;

/// An experiment that comes with a problem.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Preset {
    /// What it is called: `mass-spring`, `paper/mass-spring`.
    pub name: &'static str,
    /// The experiment file.
    pub text: &'static str,
    /// The files that it names, by their paths from its folder.
    pub files: &'static [(&'static str, &'static str)],
}

impl Preset {
    /// An experiment by itself.
    pub const fn new(name: &'static str, text: &'static str) -> Self {
        Self { name, text, files: &[] }
    }

    /// The same with the files that it names.
    #[must_use]
    pub const fn with_files(self, files: &'static [(&'static str, &'static str)]) -> Self {
        Self { files, ..self }
    }
}

/// A problem: a mechanism, the world that it works in, and what it is for.
pub trait Problem: Send + Sync + 'static {
    /// What experiments may set in `[task]` beside `problem` and `horizon`.
    type Settings: Settings + Clone + std::fmt::Debug + PartialEq + Send + Sync + 'static;

    /// What experiments call it in `task.problem`: lower-case letters, digits and hyphens.
    fn name(&self) -> &str;

    /// The settings where an experiment says nothing.
    fn defaults(&self) -> Self::Settings;

    /// The problem with these settings, which are within their limits. The same settings give the same. Checking an experiment
    /// builds its problem, so that physics that take time to set up belong into [`World::later`](crate::World::later).
    ///
    /// # Errors
    /// Where the settings do not go together; the text is shown with the line of `task.problem`.
    fn build(&self, settings: &Self::Settings) -> Result<Built, AnyError>;

    /// Experiments that come with it, the first of them its default.
    fn presets(&self) -> Vec<Preset> {
        Vec::new()
    }

    /// An experiment to begin with for a file of one's own, such as a robot's model: the text of one called `name` that trains
    /// as it is. None where the problem is not about files.
    ///
    /// # Errors
    /// Where the file is none that it could be about, with a way out.
    fn begin(&self, _folder: &Folder, _file: &str, _name: &str) -> Option<Result<String, AnyError>> {
        None
    }
}

/// A [`Problem`] as a catalogue keeps it.
pub trait AnyProblem: Send + Sync {
    /// See [`Problem::name`].
    fn name(&self) -> &str;
    /// See [`Problem::defaults`].
    fn defaults(&self) -> Box<dyn AnySettings>;
    /// See [`Problem::build`].
    ///
    /// # Panics
    /// If the settings are those of another problem.
    fn build(&self, settings: &dyn AnySettings) -> Result<Built, AnyError>;
    /// See [`Problem::presets`].
    fn presets(&self) -> Vec<Preset>;
    /// See [`Problem::begin`].
    fn begin(&self, folder: &Folder, file: &str, name: &str) -> Option<Result<String, AnyError>>;
}

impl<P: Problem> AnyProblem for P {
    fn name(&self) -> &str {
        Problem::name(self)
    }

    fn defaults(&self) -> Box<dyn AnySettings> {
        Box::new(Problem::defaults(self))
    }

    fn build(&self, settings: &dyn AnySettings) -> Result<Built, AnyError> {
        let own = settings.as_any().downcast_ref::<P::Settings>();
        Problem::build(self, own.expect("settings are handed back to the problem that they came from"))
    }

    fn presets(&self) -> Vec<Preset> {
        Problem::presets(self)
    }

    fn begin(&self, folder: &Folder, file: &str, name: &str) -> Option<Result<String, AnyError>> {
        Problem::begin(self, folder, file, name)
    }
}
