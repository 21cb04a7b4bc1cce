//! What experiments may name in this process: what comes with the program, and what was registered from Python.

use std::sync::{LazyLock, Mutex, MutexGuard, PoisonError};

use hwasp_experiment::Catalogue;
use hwasp_problem::Problem;
use pyo3::prelude::*;

use crate::error::Wrong;

static REGISTERED: LazyLock<Mutex<Catalogue>> = LazyLock::new(|| Mutex::new(hwasp_builtin::catalogue()));

fn registered() -> MutexGuard<'static, Catalogue> {
    REGISTERED.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The catalogue as it is now.
pub(crate) fn catalogue() -> Catalogue {
    registered().clone()
}

/// Takes in a problem; one of the same name from Python is replaced, one that comes with the program is not.
pub(crate) fn add(problem: impl Problem) -> Result<(), Wrong> {
    let mut catalogue = registered();
    let name = problem.name().to_owned();
    let own = hwasp_builtin::catalogue().problems().iter().any(|known| known.name() == name);
    let without = if own { catalogue.clone() } else { catalogue.without(&name) };
    let old = std::mem::replace(&mut *catalogue, without.with(problem).map_err(Wrong::input)?);
    // What Python does when its objects go may come here again.
    drop(catalogue);
    drop(old);
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
    let own = hwasp_builtin::catalogue().problems().iter().any(|known| known.name() == name);
    if !own {
        let mut catalogue = registered();
        let without = catalogue.without(name);
        let old = std::mem::replace(&mut *catalogue, without);
        // What Python does when its objects go may come here again.
        drop(catalogue);
        drop(old);
    }
}
