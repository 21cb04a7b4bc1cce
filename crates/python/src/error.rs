//! Errors as exceptions: the small family of `hwasp.errors`, with the texts of the program.

use std::error::Error;

use hwasp_session::Failure;
use pyo3::exceptions::PyKeyboardInterrupt;
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::PyType;

/// What went wrong, with nothing in it that could not change threads.
#[derive(Debug)]
pub(crate) struct Wrong {
    code: u8,
    text: String,
}

impl From<Failure> for Wrong {
    fn from(failure: Failure) -> Self {
        let text = failure.text();
        // An exception says already that it is one.
        let text = text.strip_prefix("error: ").map_or_else(|| text.clone(), str::to_owned);
        Self { code: failure.exit_code(), text }
    }
}

impl Wrong {
    /// What was asked for is wrong, and nothing was begun.
    pub(crate) fn input(error: impl Into<Box<dyn Error>>) -> Self {
        Failure::input(error).into()
    }

    /// Something failed on the way.
    pub(crate) fn failed<E: Error + 'static>(error: E) -> Self {
        Failure::from(error).into()
    }
}

impl From<Wrong> for PyErr {
    fn from(Wrong { code, text }: Wrong) -> Self {
        Python::attach(|py| match code {
            130 => PyKeyboardInterrupt::new_err(text),
            2 => raised(py, "InputError", text),
            _ => raised(py, "RunError", text),
        })
    }
}

/// What was asked for is wrong.
pub(crate) fn input(text: impl Into<String>) -> PyErr {
    Wrong { code: 2, text: text.into() }.into()
}

/// Something that was closed is asked for something.
pub(crate) fn closed(text: impl Into<String>) -> PyErr {
    Python::attach(|py| raised(py, "ClosedError", text.into()))
}

/// An exception of the family, which is written in Python: there a class may have two bases.
fn raised(py: Python<'_>, name: &str, text: String) -> PyErr {
    static MODULE: PyOnceLock<Py<PyModule>> = PyOnceLock::new();
    let class = MODULE
        .get_or_try_init(py, || PyModule::import(py, "hwasp.errors").map(Bound::unbind))
        .and_then(|module| Ok(module.bind(py).getattr(name)?.cast_into::<PyType>()?));
    match class {
        Ok(class) => PyErr::from_type(class, text),
        Err(error) => error,
    }
}
