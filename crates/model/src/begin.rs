//! An experiment for a model of one's own, as a text that trains at once: what `hwasp init` writes.

mod close;
mod facts;
mod listing;
mod purpose;
mod write;

use std::fmt::Display;

use hwasp_mujoco::engine::Files;
use hwasp_problem::AnyError;
use hwasp_settings::{Folder, FolderError, inside};

use crate::source::gather;
use facts::Facts;
use purpose::Purpose;

/// The experiment for a model in a folder, by the model's path there.
///
/// # Errors
/// Where the model cannot be read or compiled, or nothing in it moves; with a way out.
pub(crate) fn begin(folder: &Folder, model: &str, name: &str) -> Result<String, AnyError> {
    let main = inside(model).ok_or_else(|| FolderError::Outside { path: model.to_owned() });
    let main = main.map_err(|error| told(&error, &error.hint()))?;
    let found = gather(folder, &main).map_err(|fault| told(&fault.message, &fault.hint))?;
    let files = Files::new(found.iter().map(|(path, bytes)| (path.clone(), bytes.clone())))?;
    let facts = Facts::read(&main, &files)?;
    let purpose = Purpose::of(&facts);
    Ok(write::experiment(&facts, &purpose, &main, name))
}

fn told(message: &dyn Display, hint: &str) -> AnyError {
    format!("{message}\n  = hint: {hint}").into()
}
