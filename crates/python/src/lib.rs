//! The native half of the Python package `hwasp`. The other half, in `python/hwasp`, is what people import: it has the docs and
//! whatever is more readable in Python. Here is what has to be fast, or is the program's own.

#![allow(clippy::needless_pass_by_value, reason = "Python's values are handed over")]

mod catalogue;
mod command;
mod compare;
mod environment;
mod episodes;
mod error;
mod experiment;
mod law;
mod log;
mod policy;
mod run;
mod training;
mod value;

use pyo3::prelude::*;

#[pymodule]
mod _hwasp {
    #[pymodule_export]
    use crate::catalogue::{experiments, forget, problems};
    #[pymodule_export]
    use crate::command::main;
    #[pymodule_export]
    use crate::compare::compare;
    #[pymodule_export]
    use crate::environment::register;
    #[pymodule_export]
    use crate::episodes::Episodes;
    #[pymodule_export]
    use crate::experiment::Experiment;
    #[pymodule_export]
    use crate::law::{Law, Number, trace};
    #[pymodule_export]
    use crate::policy::Policy;
    #[pymodule_export]
    use crate::run::Run;

    use super::{PyModule, PyModuleMethods, PyResult};
    use pyo3::Bound;

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }
}
