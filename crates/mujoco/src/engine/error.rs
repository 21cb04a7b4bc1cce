//! Why no model or no simulation could be built.

use std::fmt::Write;

use super::FileError;

/// Why no simulation could be built.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum BuildError {
    /// The engine does not take the MJCF text.
    #[error("MuJoCo does not take the model: {0}")]
    Mjcf(String),
    /// There is no memory for the state.
    #[error("MuJoCo cannot allocate the simulation: {0}")]
    Allocation(String),
    /// A model does not hold together.
    #[error("{}: {message}", place(.file, *.line))]
    Model {
        /// The file that it is about: the one that was asked for, or one that it includes.
        file: String,
        /// The line in it, from 1, where the engine says it.
        line: Option<usize>,
        /// What is wrong, in the engine's words or ours.
        message: String,
    },
    /// There is no such file.
    #[error("there is no file `{path}` among those of the model{}", listed(.files))]
    NoFile {
        /// The file that was asked for.
        path: String,
        /// Those that there are.
        files: Vec<String>,
    },
    /// Something moves that has no mass.
    #[error(
        "{}: {} moves and has no mass or no inertia; give the link an `<inertial>` with mass and inertia (URDF), or \
         the body a geom with mass (MJCF)",
        place(.file, *.line),
        named(.body)
    )]
    NoInertia {
        /// The file of the model.
        file: String,
        /// The line in it, from 1, where the engine says it.
        line: Option<usize>,
        /// The name of the body or link; empty if it has none.
        body: String,
    },
    /// The lower end of a range was set above its upper end.
    #[error("the range `{path}` runs from {low} to {high}; its first number has to be below its second")]
    Range {
        /// The field, without an index.
        path: String,
        /// Its first number.
        low: String,
        /// Its second number.
        high: String,
    },
    /// The files are none that a model may read.
    #[error(transparent)]
    File(#[from] FileError),
    /// The model cannot be written.
    #[error("MuJoCo does not write the model: {0}")]
    Write(String),
}

fn place(file: &str, line: Option<usize>) -> String {
    let mut text = file.to_owned();
    if let Some(line) = line {
        let _ = write!(text, ", line {line}");
    }
    text
}

fn named(body: &str) -> String {
    if body.is_empty() { "a body without a name".to_owned() } else { format!("the body `{body}`") }
}

fn listed(files: &[String]) -> String {
    const MOST: usize = 10;
    match files.len() {
        0 => "; it has none".to_owned(),
        count if count > MOST => format!("; it has {} and {} others", files[..MOST].join(", "), count - MOST),
        _ => format!("; it has: {}", files.join(", ")),
    }
}
