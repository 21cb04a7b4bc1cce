//! What experiments may name in this process: what comes with the program, and what was registered from Python.

use std::sync::{LazyLock, Mutex, MutexGuard, PoisonError};

use hwasp_experiment::Catalogue;
use hwasp_problem::Problem;
use pyo3::prelude::*;

use crate::error::Wrong;

static BUILTIN: LazyLock<Catalogue> = LazyLock::new(hwasp_builtin::catalogue);
static REGISTERED: LazyLock<Mutex<Catalogue>> = LazyLock::new(|| Mutex::new(BUILTIN.clone()));

fn registered() -> MutexGuard<'static, Catalogue> {
    REGISTERED.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The catalogue as it is now.
pub(crate) fn catalogue() -> Catalogue {
    registered().clone()
}

/// Whether a problem comes with the program.
fn is_builtin(name: &str) -> bool {
    BUILTIN.problems().iter().any(|problem| problem.name() == name)
}

/// Puts another catalogue in the place of this one. What Python does when its objects go may come here again, so that they go last.
fn replace(mut registered: MutexGuard<'_, Catalogue>, other: Catalogue) {
    let old = std::mem::replace(&mut *registered, other);
    drop(registered);
    drop(old);
}

/// Takes in a problem; one of the same name from Python is replaced, one that comes with the program is not.
pub(crate) fn add(problem: impl Problem) -> Result<(), Wrong> {
    let catalogue = registered();
    let name = problem.name();
    let without = if is_builtin(name) { catalogue.clone() } else { catalogue.without(name) };
    let with = without.with(problem).map_err(Wrong::input)?;
    replace(catalogue, with);
    Ok(())
}

/// The names of the experiments that come with the package.
#[pyfunction]
pub(crate) fn experiments() -> Vec<String> {
    catalogue().presets().iter().map(|preset| preset.name.to_owned()).collect()
}

/// The names of the problems that experiments may name.
#[pyfunction]
pub(crate) fn problems() -> Vec<String> {
    catalogue().problems().iter().map(|problem| problem.name().to_owned()).collect()
}

/// Takes a problem out that was registered from Python.
#[pyfunction]
pub(crate) fn forget(name: &str) {
    if !is_builtin(name) {
        let catalogue = registered();
        let without = catalogue.without(name);
        replace(catalogue, without);
    }
}
