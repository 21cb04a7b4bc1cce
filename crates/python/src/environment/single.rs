//! One environment in Python.

use std::sync::Arc;

use hwasp_core::{End, EnvSpec, Environment, Step, Stream};
use numpy::PyArray1;
use pyo3::intern;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};
use rand::Rng;

use super::known::{Known, Methods, read, split};
use crate::error;

pub(super) struct PythonEnvironment {
    known: Arc<Known>,
    /// None where it could not be made.
    methods: Option<Methods>,
    spec: EnvSpec,
    seen: Vec<f64>,
    state: Vec<f64>,
    taken: usize,
    fault: Option<String>,
}

impl PythonEnvironment {
    /// Makes one. Where that fails, the exception waits, and the environment has a fault from the beginning.
    pub(super) fn new(known: &Arc<Known>, horizon: Option<usize>) -> Self {
        let mut spec = known.spec.clone();
        spec.horizon = horizon.unwrap_or(spec.horizon);
        let (methods, fault) = split(known.made());
        Self {
            seen: vec![0.0; spec.observation.len()],
            state: vec![0.0; spec.state.len()],
            known: Arc::clone(known),
            methods,
            spec,
            taken: 0,
            fault,
        }
    }

    /// Does what may raise an exception, which then waits for the main thread.
    fn attempt<T>(&mut self, work: impl FnOnce(&mut Self, Python<'_>) -> PyResult<T>) -> Option<T> {
        Python::attach(|py| match work(self, py) {
            Ok(value) => Some(value),
            Err(error) => {
                self.fault = Some(error.to_string());
                self.known.raised.keep(error);
                None
            }
        })
    }

    /// Takes an observation in, and what the law reads of it.
    fn see(&mut self, py: Python<'_>, observation: &Bound<'_, PyAny>) -> PyResult<()> {
        read(observation, &mut self.seen, "the observation")?;
        let Some(methods) = &self.methods else { return Ok(()) };
        self.known.read_state(methods.env.bind(py), observation, &self.seen, &mut self.state)
    }
}

impl Environment for PythonEnvironment {
    fn spec(&self) -> &EnvSpec {
        &self.spec
    }

    fn set_design(&mut self, design: &[f64]) {
        if self.known.build.is_none() {
            return;
        }
        self.attempt(|this, py| {
            let (Some(build), Some(methods)) = (&this.known.build, &this.methods) else { return Ok(()) };
            build.bind(py).call1((&methods.env, PyArray1::from_slice(py, design)))?;
            Ok(())
        });
    }

    fn reset(&mut self, rng: &mut Stream) {
        self.taken = 0;
        if self.methods.is_none() {
            return;
        }
        self.fault = None;
        // Gymnasium's seeds are whole numbers of 32 bits.
        let seed = rng.next_u32();
        self.attempt(|this, py| {
            let Some(methods) = &this.methods else { return Ok(()) };
            let options = PyDict::new(py);
            options.set_item(intern!(py, "seed"), seed)?;
            let started = methods.reset.bind(py).call((), Some(&options))?;
            let observation = started.cast::<PyTuple>().ok().filter(|pair| pair.len() == 2).ok_or_else(|| {
                error::input(
                    "reset gives (observation, info), as Gymnasium's environments do; this one gives something else",
                )
            })?;
            let observation = observation.get_item(0)?;
            this.see(py, &observation)
        });
    }

    fn observe(&self, out: &mut [f64]) {
        out.copy_from_slice(&self.seen);
    }

    fn state(&self, out: &mut [f64]) {
        out.copy_from_slice(&self.state);
    }

    fn step(&mut self, effort: &[f64], command: &[f64]) -> Step {
        let faulted = Step { reward: 0.0, end: Some(End::Faulted) };
        if self.fault.is_some() {
            return faulted;
        }
        self.taken += 1;
        let stepped = self.attempt(|this, py| {
            let action = this.known.action(py, if this.known.acts_by_effort { effort } else { command }, None)?;
            let Some(methods) = &this.methods else { return Ok((0.0, false, false)) };
            let result = methods.step.bind(py).call1((action,))?;
            let result = result.cast::<PyTuple>().ok().filter(|result| result.len() == 5).ok_or_else(|| {
                error::input(
                    "step gives (observation, reward, terminated, truncated, info), as Gymnasium's environments do; this one gives \
                     something else",
                )
            })?;
            this.see(py, &result.get_item(0)?)?;
            let flag = |i: usize| result.get_item(i)?.is_truthy();
            Ok((result.get_item(1)?.extract::<f64>()?, flag(2)?, flag(3)?))
        });
        match stepped {
            None => faulted,
            Some((reward, terminated, truncated)) => {
                let over = truncated || self.taken >= self.spec.horizon;
                let end = if terminated { Some(End::Terminated) } else { over.then_some(End::Truncated) };
                Step { reward, end }
            }
        }
    }

    fn fault(&self) -> Option<String> {
        self.fault.clone()
    }
}
