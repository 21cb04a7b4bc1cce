//! Why the program ends without a result, and the exit status that tells a script.

use std::error::Error;
use std::fmt::Write;
use std::path::Path;
use std::process::ExitCode;

use hwasp_lab::RunError;
use hwasp_lab::plot::PlotError;

/// An error, and whether it was there before any work began.
#[derive(Debug)]
pub(crate) struct Failure {
    error: Box<dyn Error>,
    code: u8,
    hint: Option<String>,
}

impl Failure {
    /// What was asked for is wrong, arguments, experiments and folders that were named among it: nothing was begun.
    /// Exit status 2, as for an unknown argument.
    pub(crate) fn input(error: impl Into<Box<dyn Error>>) -> Self {
        Self { error: error.into(), code: 2, hint: None }
    }

    /// Someone asked the program to stop. Exit status 130, as shells have it for Ctrl-C.
    pub(crate) fn interrupted(error: impl Into<Box<dyn Error>>) -> Self {
        Self { error: error.into(), code: 130, hint: None }
    }

    /// Says the way on.
    pub(crate) fn hint(self, hint: &str) -> Self {
        Self { hint: Some(hint.to_owned()), ..self }
    }

    /// The exit status.
    pub(crate) fn exit_code(&self) -> ExitCode {
        ExitCode::from(self.code)
    }

    /// The error with those of its causes that it does not tell itself.
    pub(crate) fn text(&self) -> String {
        let mut text = self.error.to_string();
        // The faults of an experiment begin with the word themselves, each of them.
        if !text.starts_with("error: ") {
            text.insert_str(0, "error: ");
        }
        let mut cause = self.error.source();
        while let Some(error) = cause {
            let told = error.to_string();
            if !text.contains(&told) {
                let _ = write!(text, "\n  because: {told}");
            }
            cause = error.source();
        }
        if let Some(hint) = self.hint.clone().or_else(|| self.error.downcast_ref().and_then(way_out)) {
            let _ = write!(text, "\n  = hint: {hint}");
        }
        text
    }
}

/// What to do about a folder that is not what it should be.
fn way_out(error: &RunError) -> Option<String> {
    let again = |folder: &Path| {
        let experiment = folder.join("experiment.toml");
        format!("`hwasp train {} --out FOLDER` repeats the training", experiment.display())
    };
    match error {
        RunError::NotARun { .. } => Some("name a folder that `hwasp train` has written".into()),
        RunError::Unfinished { path, .. } => Some(again(path)),
        RunError::Policy { path, .. } | RunError::Metrics { path, .. } | RunError::Decode { path, .. } => {
            let folder = path.parent().unwrap_or(Path::new(""));
            Some(format!("the file was changed or damaged, or belongs to another run; {}", again(folder)))
        }
        RunError::Io { action: "read", path, .. } => Some(again(path.parent().unwrap_or(Path::new("")))),
        RunError::Io { action: "create", .. } | RunError::Plot(PlotError::Write { .. }) => {
            Some("name another folder with --out".into())
        }
        _ => None,
    }
}

/// What goes wrong on the way: exit status 1.
impl<E: Error + 'static> From<E> for Failure {
    fn from(error: E) -> Self {
        Self { error: Box::new(error), code: 1, hint: None }
    }
}
