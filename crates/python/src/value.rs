//! Values of Python and of files.

use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict, PyFloat, PyInt, PyString};
use serde::Serialize;
use toml::{Table, Value};

use crate::error;

/// The deepest that tables and lists may lie in each other.
const DEEPEST: usize = 16;

/// A value for an experiment, as TOML has it.
pub(crate) fn toml_value(value: &Bound<'_, PyAny>) -> PyResult<Value> {
    nested(value, 0)
}

fn nested(value: &Bound<'_, PyAny>, depth: usize) -> PyResult<Value> {
    if depth > DEEPEST {
        return Err(error::input(format!("an experiment has tables in tables {DEEPEST} deep, at most")));
    }
    if let Ok(text) = value.cast::<PyString>() {
        return Ok(Value::String(text.to_str()?.to_owned()));
    }
    // A bool is an integer, too.
    if let Ok(flag) = value.cast::<PyBool>() {
        return Ok(Value::Boolean(flag.is_true()));
    }
    if let Ok(integer) = value.cast::<PyInt>() {
        let fits = integer.extract::<i64>();
        return fits.map(Value::Integer).map_err(|_| error::input(format!("{integer} is beyond 64 bits")));
    }
    if let Ok(float) = value.cast::<PyFloat>() {
        return Ok(Value::Float(float.value()));
    }
    if let Ok(table) = value.cast::<PyDict>() {
        let mut values = Table::new();
        for (key, value) in table {
            values.insert(text(&key, "a key")?, nested(&value, depth + 1)?);
        }
        return Ok(Value::Table(values));
    }
    // Scalars and arrays of numpy become plain values.
    if let Ok(plain) = value.call_method0("tolist") {
        return nested(&plain, depth + 1);
    }
    let items = value
        .try_iter()
        .map_err(|_| PyTypeError::new_err(format!("{} is none of str, bool, int, float, list, dict", kind(value))))?;
    items.map(|item| nested(&item?, depth + 1)).collect::<PyResult<Vec<_>>>().map(Value::Array)
}

/// A text, or an error that says what should be one.
pub(crate) fn text(value: &Bound<'_, PyAny>, what: &str) -> PyResult<String> {
    let text = value.cast::<PyString>();
    let text = text.map_err(|_| PyTypeError::new_err(format!("{what} is a str, not {}", kind(value))))?;
    Ok(text.to_str()?.to_owned())
}

/// What a value is, for messages.
pub(crate) fn kind(value: &Bound<'_, PyAny>) -> String {
    value.get_type().name().map_or_else(|_| "something else".to_owned(), |name| name.to_string())
}

/// Anything that can be written as JSON, as Python's own dicts, lists and numbers.
pub(crate) fn plain<'py>(py: Python<'py>, value: &impl Serialize) -> PyResult<Bound<'py, PyAny>> {
    let text = serde_json::to_string(value).map_err(|error| error::input(error.to_string()))?;
    PyModule::import(py, "json")?.call_method1("loads", (text,))
}
