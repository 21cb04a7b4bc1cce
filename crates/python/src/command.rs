//! The program, as a Python package brings it along.

use std::ffi::OsString;

use hwasp_cli::{Caller, run_for};
use pyo3::prelude::*;

use crate::catalogue::catalogue;

/// Runs the command line `words`, the program first, and returns its exit status. `itself` starts the program again.
#[pyfunction]
pub(crate) fn main(py: Python<'_>, words: Vec<OsString>, itself: Vec<OsString>) -> u8 {
    py.detach(|| run_for(Caller { words, itself }, &catalogue()))
}

/// What started this process, for the provenance of runs: `sys.argv`.
pub(crate) fn line(py: Python<'_>) -> Vec<String> {
    let words = PyModule::import(py, "sys").and_then(|sys| sys.getattr("argv")?.extract());
    words.unwrap_or_else(|_| vec!["python".to_owned()])
}
