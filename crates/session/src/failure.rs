//! Why the program ends without a result, and the exit status that tells a script.

use std::error::Error;
use std::fmt::Write;
use std::path::Path;

use hwasp_plot::PlotError;
use hwasp_runs::checkpoint::CheckpointError;
use hwasp_runs::{PolicyFileError, ReplayError, RunError};
use hwasp_study::CompareError;
use hwasp_workshop::WorkshopError;

use crate::words::shell;

/// The file of a run folder that makes it one.
const EXPERIMENT: &str = "experiment.toml";
/// The way out where a picture cannot be written.
pub const OTHER_FILE: &str = "name a file in a folder that is there and may be written, with --out";

/// The way out where a folder cannot be written.
const OTHER_FOLDER: &str = "name another folder with --out";

/// An error, and whether it was there before any work began.
#[derive(Debug)]
pub struct Failure {
    error: Box<dyn Error>,
    code: u8,
    hint: Option<String>,
}

impl Failure {
    /// What was asked for is wrong, arguments, experiments and folders that were named among it: nothing was begun.
    /// Exit status 2, as for an unknown argument.
    pub fn input(error: impl Into<Box<dyn Error>>) -> Self {
        Self { error: error.into(), code: 2, hint: None }
    }

    /// Someone asked the program to stop. Exit status 130, as shells have it for Ctrl-C.
    pub fn interrupted(error: impl Into<Box<dyn Error>>) -> Self {
        Self { error: error.into(), code: 130, hint: None }
    }

    /// Something went wrong on the way. Exit status 1.
    pub fn failed(error: impl Into<Box<dyn Error>>) -> Self {
        Self { error: error.into(), code: 1, hint: None }
    }

    /// Says the way on.
    pub fn hint(self, hint: &str) -> Self {
        Self { hint: Some(hint.to_owned()), ..self }
    }

    /// The exit status.
    pub fn exit_code(&self) -> u8 {
        self.code
    }

    /// The error with those of its causes that it does not tell itself.
    pub fn text(&self) -> String {
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
        if let Some(hint) = self.hint.clone().or_else(|| way_out(&*self.error)) {
            let _ = write!(text, "\n  = hint: {hint}");
        }
        text
    }
}

/// What to do about a file or a folder that is not what it should be.
fn way_out(error: &(dyn Error + 'static)) -> Option<String> {
    if let Some(PlotError::Write { .. }) = error.downcast_ref() {
        return Some(OTHER_FILE.into());
    }
    if let Some(CompareError::Run(error)) = error.downcast_ref() {
        return of_cell(error);
    }
    match error.downcast_ref() {
        Some(WorkshopError::Run(error)) => return of_run(error),
        Some(WorkshopError::Plot(PlotError::Write { .. })) => return Some(OTHER_FOLDER.into()),
        _ => {}
    }
    match error.downcast_ref() {
        Some(ReplayError::Run(error)) => of_run(error),
        _ => of_run(error.downcast_ref()?),
    }
}

/// The same for a run folder.
fn of_run(error: &RunError) -> Option<String> {
    let again = |run: &Path| {
        let experiment = run.join(EXPERIMENT);
        format!("`hwasp train {} --out FOLDER` repeats the training", shell(&experiment))
    };
    let parent = |file: &Path| file.parent().unwrap_or(Path::new("")).to_owned();
    Some(match error {
        RunError::Nothing { .. } => "name a folder that `hwasp train` or `hwasp compare` has written to the end".into(),
        RunError::NotARun { .. } => "name a folder that `hwasp train` has written".into(),
        RunError::Unfinished { path, .. } if !path.join("summary.json").exists() => {
            format!("`hwasp train --resume {}` goes on with it", shell(path))
        }
        RunError::Unfinished { path, .. } => again(path),
        RunError::Finished { path } => {
            let run = shell(path);
            format!("`hwasp eval {run}` evaluates it; for more steps train anew, with a larger --env-steps")
        }
        RunError::OtherMachine { path, .. } => {
            let experiment = path.join(EXPERIMENT);
            let train = format!("`hwasp train {} --set KEY=VALUE --out FOLDER` trains one", shell(&experiment));
            format!(
                "set what belongs to its world: objects, starts, disturbances, rewards; for another machine {train}"
            )
        }
        RunError::Policy { path, source: PolicyFileError::Tensor { .. } } => {
            let how = "it belongs to another run, or experiment.toml or --set ask for another policy";
            format!("{how}; {}", again(&parent(path)))
        }
        RunError::Policy { path, .. } | RunError::Metrics { path, .. } | RunError::Decode { path, .. } => {
            if let Some(hint) = of_other(path) {
                return Some(hint);
            }
            format!("the file was changed or damaged, or belongs to another run; {}", again(&parent(path)))
        }
        RunError::Unsound { folder, .. } => again(&parent(folder)),
        RunError::Checkpoint {
            source: CheckpointError::Experiment { .. } | CheckpointError::Version { .. }, ..
        } => {
            return None;
        }
        RunError::Checkpoint { .. } => "the file was changed or damaged; another checkpoint may be sound".into(),
        RunError::Io { action: "read", path, .. } => match path.ancestors().skip(1).take(2).find(|run| is_run(run)) {
            Some(run) if !path.ends_with(EXPERIMENT) => {
                format!("see that it is a file and may be read; {}", again(run))
            }
            _ => "see that it is the file that `hwasp train` wrote, and may be read".into(),
        },
        RunError::Io { action: "write", .. } => "make room there, or see that it may be written, and try again".into(),
        RunError::Io { action: "lock", .. } => "see that it is a file and may be written, or remove it".into(),
        RunError::Io { action: "create", .. } => OTHER_FOLDER.into(),
        _ => return None,
    })
}

/// The same for a file that no training writes, or that is not needed.
fn of_other(file: &Path) -> Option<String> {
    let run = file.parent().and_then(Path::parent).unwrap_or(Path::new(""));
    Some(match file.file_name()?.to_str()? {
        "parts.json" => format!("the file was changed or damaged; `hwasp parts {}` makes it anew", shell(run)),
        "tolerances.json" => {
            format!("the file was changed or damaged; `hwasp tolerances {}` makes it anew", shell(run))
        }
        "provenance.json" => "the file was changed or damaged; a run is read without it, too".into(),
        "comparison.json" => "the same `hwasp compare` command makes it anew".into(),
        _ => return None,
    })
}

/// The same for a comparison, a cell of which can be trained again.
fn of_cell(error: &RunError) -> Option<String> {
    let (RunError::Policy { path, .. }
    | RunError::Metrics { path, .. }
    | RunError::Decode { path, .. }
    | RunError::Io { action: "read", path, .. }) = error
    else {
        return of_run(error);
    };
    let cell = path.ancestors().find(|folder| is_run(folder))?;
    Some(format!("remove the folder {}: the same command trains it anew", cell.display()))
}

fn is_run(folder: &Path) -> bool {
    folder.join(EXPERIMENT).is_file()
}

/// What goes wrong on the way: exit status 1.
impl<E: Error + 'static> From<E> for Failure {
    fn from(error: E) -> Self {
        Self { error: Box::new(error), code: 1, hint: None }
    }
}
