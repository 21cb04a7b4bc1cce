//! Traced numbers.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use hwasp_expr::{Formulas, NameError, Part, Path, Quantity, Scope, Symbol};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

use crate::error;
use crate::value::kind;

/// What a law comes to while it is traced.
pub(super) type Tracing = Arc<Mutex<Formulas>>;

pub(super) fn lock(tracing: &Tracing) -> MutexGuard<'_, Formulas> {
    tracing.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A number of a law that is traced.
#[pyclass(frozen, module = "hwasp._hwasp")]
#[derive(Clone)]
pub(crate) struct Number {
    pub(super) tracing: Tracing,
    pub(super) part: Part,
}

/// The operands of a formula, `a0`, `a1` and so on.
struct Operands(Vec<Part>);

impl Scope for Operands {
    fn name(&mut self, _: &mut Formulas, path: &Path) -> Result<Symbol, NameError> {
        let place = path.first().strip_prefix('a').and_then(|number| number.parse::<usize>().ok());
        let part = place.and_then(|place| self.0.get(place)).ok_or_else(|| NameError::unknown([""; 0]))?;
        Ok(Symbol::new(vec![*part], Quantity::Unknown, 1))
    }
}

/// Computes a formula of operands that are traced numbers or plain ones; of plain ones alone it is a float.
fn compute<'py>(py: Python<'py>, formula: &str, operands: &[Bound<'py, PyAny>]) -> PyResult<Bound<'py, PyAny>> {
    let traced = operands.iter().find_map(|operand| operand.cast::<Number>().ok());
    let tracing = traced.map_or_else(Tracing::default, |number| Arc::clone(&number.get().tracing));
    let mut parts = Vec::with_capacity(operands.len());
    for operand in operands {
        parts.push(match operand.cast::<Number>() {
            Ok(number) if Arc::ptr_eq(&number.get().tracing, &tracing) => number.get().part,
            Ok(_) => return Err(PyValueError::new_err("numbers of two laws must not be mixed")),
            Err(_) => {
                let value: f64 = operand.extract().map_err(|_| {
                    PyTypeError::new_err(format!("a law computes with numbers, and this is {}", kind(operand)))
                })?;
                lock(&tracing).constant(value)
            }
        });
    }
    let mut formulas = lock(&tracing);
    let read = formulas.read(formula, &mut Operands(parts));
    let value = read.map_err(|fault| {
        let hint = fault.hint.map_or_else(String::new, |hint| format!("; {hint}"));
        error::input(format!("{}{hint}", fault.message))
    })?;
    let [part] = value.parts[..] else {
        return Err(error::input(format!("`{formula}` is a vector, and a law computes with numbers")));
    };
    if let (None, Some(value)) = (traced, formulas.known(part)) {
        return Ok(value.into_pyobject(py)?.into_any());
    }
    drop(formulas);
    Ok(Bound::new(py, Number { tracing, part })?.into_any())
}

type Operated<'py> = PyResult<Bound<'py, PyAny>>;

/// What numpy, not this class, sees to: arrays.
fn foreign(other: &Bound<'_, PyAny>) -> bool {
    other.cast::<Number>().is_err() && other.extract::<f64>().is_err()
}

/// An operator.
fn operated<'py>(number: &Bound<'py, Number>, other: &Bound<'py, PyAny>, formula: &str) -> Operated<'py> {
    let py = number.py();
    if foreign(other) {
        return Ok(py.NotImplemented().into_bound(py));
    }
    compute(py, formula, &[number.clone().into_any(), other.clone()])
}

#[pymethods]
impl Number {
    fn __add__<'py>(slf: &Bound<'py, Self>, other: &Bound<'py, PyAny>) -> Operated<'py> {
        operated(slf, other, "a0 + a1")
    }

    fn __radd__<'py>(slf: &Bound<'py, Self>, other: &Bound<'py, PyAny>) -> Operated<'py> {
        operated(slf, other, "a1 + a0")
    }

    fn __sub__<'py>(slf: &Bound<'py, Self>, other: &Bound<'py, PyAny>) -> Operated<'py> {
        operated(slf, other, "a0 - a1")
    }

    fn __rsub__<'py>(slf: &Bound<'py, Self>, other: &Bound<'py, PyAny>) -> Operated<'py> {
        operated(slf, other, "a1 - a0")
    }

    fn __mul__<'py>(slf: &Bound<'py, Self>, other: &Bound<'py, PyAny>) -> Operated<'py> {
        operated(slf, other, "a0 * a1")
    }

    fn __rmul__<'py>(slf: &Bound<'py, Self>, other: &Bound<'py, PyAny>) -> Operated<'py> {
        operated(slf, other, "a1 * a0")
    }

    fn __truediv__<'py>(slf: &Bound<'py, Self>, other: &Bound<'py, PyAny>) -> Operated<'py> {
        operated(slf, other, "a0 / a1")
    }

    fn __rtruediv__<'py>(slf: &Bound<'py, Self>, other: &Bound<'py, PyAny>) -> Operated<'py> {
        operated(slf, other, "a1 / a0")
    }

    fn __pow__<'py>(slf: &Bound<'py, Self>, other: &Bound<'py, PyAny>, modulo: &Bound<'py, PyAny>) -> Operated<'py> {
        power(slf.as_any(), other, other, modulo)
    }

    fn __rpow__<'py>(slf: &Bound<'py, Self>, other: &Bound<'py, PyAny>, modulo: &Bound<'py, PyAny>) -> Operated<'py> {
        power(other, slf.as_any(), other, modulo)
    }

    /// numpy asks the elements of an array for functions by name.
    fn __getattr__<'py>(slf: &Bound<'py, Self>, name: &str) -> PyResult<Bound<'py, PyAny>> {
        let laws = PyModule::import(slf.py(), "hwasp.laws")?;
        laws.call_method1("_method", (slf, name))
    }

    fn __neg__<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        compute(slf.py(), "-a0", &[slf.clone().into_any()])
    }

    fn __pos__<'py>(slf: &Bound<'py, Self>) -> Bound<'py, Self> {
        slf.clone()
    }

    fn __abs__<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        compute(slf.py(), "abs(a0)", &[slf.clone().into_any()])
    }

    fn __lt__<'py>(slf: &Bound<'py, Self>, other: &Bound<'py, PyAny>) -> Operated<'py> {
        operated(slf, other, "a0 < a1")
    }

    fn __le__<'py>(slf: &Bound<'py, Self>, other: &Bound<'py, PyAny>) -> Operated<'py> {
        operated(slf, other, "a0 <= a1")
    }

    fn __gt__<'py>(slf: &Bound<'py, Self>, other: &Bound<'py, PyAny>) -> Operated<'py> {
        operated(slf, other, "a0 > a1")
    }

    fn __ge__<'py>(slf: &Bound<'py, Self>, other: &Bound<'py, PyAny>) -> Operated<'py> {
        operated(slf, other, "a0 >= a1")
    }

    fn __eq__<'py>(slf: &Bound<'py, Self>, other: &Bound<'py, PyAny>) -> Operated<'py> {
        operated(slf, other, "a0 == a1")
    }

    fn __ne__<'py>(slf: &Bound<'py, Self>, other: &Bound<'py, PyAny>) -> Operated<'py> {
        operated(slf, other, "a0 != a1")
    }

    #[allow(clippy::unused_self, reason = "Python calls it on a number")]
    fn __bool__(&self) -> PyResult<bool> {
        Err(PyTypeError::new_err(
            "a law is traced once and does not branch on values: write hwasp.where(condition, yes, no), hwasp.minimum, \
             hwasp.maximum or hwasp.clip",
        ))
    }

    #[allow(clippy::unused_self, reason = "Python calls it on a number")]
    fn __float__(&self) -> PyResult<f64> {
        Err(PyTypeError::new_err(
            "a law is traced once, and its numbers have no values then: use hwasp.sin and the like, or numpy's, in place of \
             math's",
        ))
    }

    #[pyo3(signature = (ufunc, method, *inputs, **options))]
    fn __array_ufunc__<'py>(
        slf: &Bound<'py, Self>,
        ufunc: &Bound<'py, PyAny>,
        method: &str,
        inputs: &Bound<'py, PyTuple>,
        options: Option<&Bound<'py, PyDict>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let laws = PyModule::import(slf.py(), "hwasp.laws")?;
        laws.call_method1("_ufunc", (ufunc, method, inputs, options))
    }

    /// Called by `numpy.clip`, which names an array to write into, too.
    #[pyo3(signature = (low, high, out = None))]
    fn clip<'py>(
        slf: &Bound<'py, Self>,
        low: &Bound<'py, PyAny>,
        high: &Bound<'py, PyAny>,
        out: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        if out.is_some() {
            return Err(PyTypeError::new_err("a law's numbers are written into no array"));
        }
        compute(slf.py(), "clip(a0, a1, a2)", &[slf.clone().into_any(), low.clone(), high.clone()])
    }

    fn __repr__(&self) -> String {
        match lock(&self.tracing).known(self.part) {
            Some(value) => format!("Number({value})"),
            None => "Number(traced)".to_owned(),
        }
    }

    /// A formula over `a0`, `a1` and so on, in the language of experiments.
    #[staticmethod]
    #[pyo3(signature = (formula, *operands))]
    fn compute<'py>(py: Python<'py>, formula: &str, operands: &Bound<'py, PyTuple>) -> PyResult<Bound<'py, PyAny>> {
        compute(py, formula, &operands.iter().collect::<Vec<_>>())
    }
}

/// A power whose exponent is a plain number, or any of a positive base. `other` is the operand that may be none of ours.
fn power<'py>(
    base: &Bound<'py, PyAny>,
    exponent: &Bound<'py, PyAny>,
    other: &Bound<'py, PyAny>,
    modulo: &Bound<'py, PyAny>,
) -> Operated<'py> {
    let py = base.py();
    if !modulo.is_none() {
        return Err(PyTypeError::new_err("a power of a law's number has no modulus"));
    }
    if foreign(other) {
        return Ok(py.NotImplemented().into_bound(py));
    }
    match exponent.extract::<f64>() {
        Ok(exponent) if !exponent.is_finite() => Err(error::input(format!("{exponent} is no exponent of a law"))),
        Ok(exponent) => compute(py, &format!("a0^({exponent:?})"), std::slice::from_ref(base)),
        Err(_) => compute(py, "exp(a1 * log(a0))", &[base.clone(), exponent.clone()]),
    }
}
