//! What is known of environments in Python, and what is read of them.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use hwasp_core::{EnvSpec, Law};
use numpy::{PyArray1, PyArrayDyn, PyArrayMethods, PyReadonlyArrayDyn};
use pyo3::intern;
use pyo3::prelude::*;

use crate::error;

/// The first exception of the environments of a problem, for whoever put it to work. Two trainings of one problem at the same time
/// share it.
#[derive(Clone, Default)]
pub(crate) struct Raised(Arc<Mutex<Option<PyErr>>>);

/// Those of the problems that were registered.
static RAISED: Mutex<BTreeMap<String, Raised>> = Mutex::new(BTreeMap::new());

impl Raised {
    /// That of a problem; of one that is not written in Python nothing ever comes. What an earlier use left is forgotten.
    pub(crate) fn of(problem: &str) -> Self {
        let raised = RAISED.lock().unwrap_or_else(PoisonError::into_inner).get(problem).cloned().unwrap_or_default();
        drop(raised.take());
        raised
    }

    /// That of a problem which is registered now.
    pub(super) fn begin(problem: &str) -> Self {
        let raised = Self::default();
        RAISED.lock().unwrap_or_else(PoisonError::into_inner).insert(problem.to_owned(), raised.clone());
        raised
    }

    fn first(&self) -> MutexGuard<'_, Option<PyErr>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Keeps one, unless an earlier one waits.
    pub(super) fn keep(&self, error: PyErr) {
        self.first().get_or_insert(error);
    }

    /// Whether one waits.
    pub(crate) fn waits(&self) -> bool {
        self.first().is_some()
    }

    /// The first one; none waits afterwards.
    pub(crate) fn take(&self) -> Option<PyErr> {
        self.first().take()
    }
}

/// What is known of the environments of a problem.
pub(super) struct Known {
    pub(super) name: String,
    pub(super) about: String,
    pub(super) law: Law,
    pub(super) spec: EnvSpec,
    /// Standard deviations of efforts.
    pub(super) effort_std: Vec<Option<f64>>,
    /// Makes one.
    pub(super) make: Py<PyAny>,
    /// Of an environment and an observation: the state that the law reads. None where it is part of the observation.
    pub(super) state: Option<Py<PyAny>>,
    /// Where the state is in the observation.
    pub(super) places: Vec<usize>,
    /// Told the environment and the design (SI) before each start.
    pub(super) build: Option<Py<PyAny>>,
    /// Of an action.
    pub(super) shape: Vec<usize>,
    pub(super) single: bool,
    pub(super) limits: Vec<(f64, f64)>,
    /// Whether efforts act; else commands do.
    pub(super) acts_by_effort: bool,
    /// Of a vector environment: how many it has.
    pub(super) lanes: Option<usize>,
    pub(super) raised: Raised,
}

/// An environment with its methods looked up. It is closed, as whoever makes one of Gymnasium's has to.
pub(super) struct Methods {
    pub(super) env: Py<PyAny>,
    pub(super) step: Py<PyAny>,
    pub(super) reset: Py<PyAny>,
}

impl Drop for Methods {
    /// Where the interpreter is about to end, it closes them.
    fn drop(&mut self) {
        Python::try_attach(|py| drop(self.env.call_method0(py, intern!(py, "close"))));
    }
}

impl Known {
    /// Makes an environment. Where that fails, the exception waits, and the text is the fault of the environment.
    pub(super) fn made(&self) -> Result<Methods, String> {
        let made = Python::attach(|py| -> PyResult<Methods> {
            let env = self.make.bind(py).call0()?;
            let (step, reset) = (env.getattr("step")?.unbind(), env.getattr("reset")?.unbind());
            Ok(Methods { step, reset, env: env.unbind() })
        });
        made.map_err(|error| {
            let fault = error.to_string();
            self.raised.keep(error);
            fault
        })
    }

    /// Actions as an environment takes them, within their limits: of one environment, or of so many in a row.
    pub(super) fn action<'py>(
        &self,
        py: Python<'py>,
        values: &[f64],
        rows: Option<usize>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let limits = self.limits.iter().cycle();
        let limited = values.iter().zip(limits).map(|(x, (lo, hi))| x.clamp(*lo, *hi));
        let shape: Vec<usize> = rows.into_iter().chain(self.shape.iter().copied()).collect();
        if self.single {
            let action = PyArray1::from_iter(py, limited.map(|x| x as f32));
            return if shape.len() == 1 { Ok(action.into_any()) } else { Ok(action.reshape(shape)?.into_any()) };
        }
        let action = PyArray1::from_iter(py, limited);
        if shape.len() == 1 { Ok(action.into_any()) } else { Ok(action.reshape(shape)?.into_any()) }
    }

    /// What the law reads: of an environment in Python and an observation, or of its places in one that was read.
    pub(super) fn read_state(
        &self,
        env: &Bound<'_, PyAny>,
        observation: &Bound<'_, PyAny>,
        seen: &[f64],
        out: &mut [f64],
    ) -> PyResult<()> {
        if let Some(state) = &self.state {
            let state = state.bind(env.py()).call1((env, observation))?;
            return read(&state, out, "the state that the law reads");
        }
        for (state, &place) in out.iter_mut().zip(&self.places) {
            *state = seen[place];
        }
        Ok(())
    }
}

/// What was made, or the fault where nothing was.
pub(super) fn split(made: Result<Methods, String>) -> (Option<Methods>, Option<String>) {
    match made {
        Ok(methods) => (Some(methods), None),
        Err(fault) => (None, Some(fault)),
    }
}

/// Reads an array of numbers of a known length.
pub(super) fn read(value: &Bound<'_, PyAny>, out: &mut [f64], what: &str) -> PyResult<()> {
    let fits = |count: usize| {
        let needed = out.len();
        let message = || error::input(format!("{what} has {count} numbers, and {needed} were there at first"));
        if count == needed { Ok(()) } else { Err(message()) }
    };
    if let Ok(array) = value.cast::<PyArrayDyn<f64>>() {
        let array: PyReadonlyArrayDyn<'_, f64> = array.try_readonly()?;
        fits(array.as_array().len())?;
        out.iter_mut().zip(array.as_array()).for_each(|(out, &x)| *out = x);
    } else if let Ok(array) = value.cast::<PyArrayDyn<f32>>() {
        let array: PyReadonlyArrayDyn<'_, f32> = array.try_readonly()?;
        fits(array.as_array().len())?;
        out.iter_mut().zip(array.as_array()).for_each(|(out, &x)| *out = f64::from(x));
    } else {
        let array = PyModule::import(value.py(), "numpy")?.call_method1("asarray", (value, "float64"))?;
        return read(&array, out, what);
    }
    Ok(())
}
