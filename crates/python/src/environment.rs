//! Environments in Python (Gymnasium's and whatever has their interface) as problems of this program: a law and a design in
//! front of them, this program's learners, placements and ledger behind.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use hwasp_core::{
    CommandPort, Dimension, End, EnvSpec, Environment, Law as CoreLaw, MakeEnvironment, Port, Step, Stream,
};
use hwasp_problem::{AnyError, Built, Problem, Words, World};
use numpy::{PyArray1, PyArrayDyn, PyArrayMethods, PyReadonlyArrayDyn};
use pyo3::intern;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};
use rand::Rng;

use crate::catalogue::add;
use crate::error;
use crate::law::Law;

/// Of the range of an action: how widely an effort is explored unless an experiment says otherwise.
const EXPLORED: f64 = 0.15;

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

    fn first(&self) -> MutexGuard<'_, Option<PyErr>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Keeps one, unless an earlier one waits.
    fn keep(&self, error: PyErr) {
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
struct Known {
    name: String,
    about: String,
    law: CoreLaw,
    spec: EnvSpec,
    /// Standard deviations of efforts.
    effort_std: Vec<Option<f64>>,
    /// Makes one.
    make: Py<PyAny>,
    /// Of an environment and an observation: the state that the law reads. None where it is part of the observation.
    state: Option<Py<PyAny>>,
    /// Where the state is in the observation.
    places: Vec<usize>,
    /// Told the environment and the design (SI) before each start.
    build: Option<Py<PyAny>>,
    /// Of an action.
    shape: Vec<usize>,
    single: bool,
    limits: Vec<(f64, f64)>,
    /// Whether efforts act; else commands do.
    acts_by_effort: bool,
    raised: Raised,
}

/// A problem whose world is written in Python.
struct PythonProblem(Arc<Known>);

impl Problem for PythonProblem {
    type Settings = ();

    fn name(&self) -> &str {
        &self.0.name
    }

    fn defaults(&self) {}

    fn build(&self, (): &()) -> Result<Built, AnyError> {
        let known = &self.0;
        let world = World::described(known.law.clone(), known.spec.clone(), Arc::new(Maker(Arc::clone(known))));
        let built = Built::of(world.clone(), world);
        Ok(Built { effort_std: known.effort_std.clone(), words: Words::about(known.about.clone()), ..built })
    }
}

struct Maker(Arc<Known>);

impl MakeEnvironment for Maker {
    fn make(&self, horizon: Option<usize>) -> Box<dyn Environment> {
        let mut spec = self.0.spec.clone();
        spec.horizon = horizon.unwrap_or(spec.horizon);
        let made = Python::attach(|py| -> PyResult<Methods> {
            let env = self.0.make.bind(py).call0()?;
            let (step, reset) = (env.getattr("step")?.unbind(), env.getattr("reset")?.unbind());
            Ok(Methods { step, reset, env: env.unbind() })
        });
        let fault = made.as_ref().err().map(ToString::to_string);
        let methods = made.map_err(|error| self.0.raised.keep(error)).ok();
        Box::new(PythonEnvironment {
            seen: vec![0.0; spec.observation.len()],
            state: vec![0.0; spec.state.len()],
            known: Arc::clone(&self.0),
            methods,
            spec,
            taken: 0,
            fault,
        })
    }
}

/// An environment with its methods looked up.
struct Methods {
    env: Py<PyAny>,
    step: Py<PyAny>,
    reset: Py<PyAny>,
}

struct PythonEnvironment {
    known: Arc<Known>,
    /// None where it could not be made.
    methods: Option<Methods>,
    spec: EnvSpec,
    seen: Vec<f64>,
    state: Vec<f64>,
    taken: usize,
    fault: Option<String>,
}

impl Drop for PythonEnvironment {
    /// Closes it, as whoever makes an environment of Gymnasium's has to. Where the interpreter is about to end, it closes them.
    fn drop(&mut self) {
        if let Some(methods) = self.methods.take() {
            Python::try_attach(|py| drop(methods.env.call_method0(py, intern!(py, "close"))));
        }
    }
}

impl PythonEnvironment {
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
        read(py, observation, &mut self.seen, "the observation")?;
        if let (Some(state), Some(methods)) = (&self.known.state, &self.methods) {
            let state = state.bind(py).call1((&methods.env, observation))?;
            read(py, &state, &mut self.state, "the state that the law reads")?;
        } else {
            for (state, &place) in self.state.iter_mut().zip(&self.known.places) {
                *state = self.seen[place];
            }
        }
        Ok(())
    }

    fn action<'py>(&self, py: Python<'py>, values: &[f64]) -> PyResult<Bound<'py, PyAny>> {
        let limited = values.iter().zip(&self.known.limits).map(|(x, (lo, hi))| x.clamp(*lo, *hi));
        let flat = self.known.shape.len() == 1;
        if self.known.single {
            let action = PyArray1::from_iter(py, limited.map(|x| x as f32));
            return if flat { Ok(action.into_any()) } else { Ok(action.reshape(&self.known.shape[..])?.into_any()) };
        }
        let action = PyArray1::from_iter(py, limited);
        if flat { Ok(action.into_any()) } else { Ok(action.reshape(&self.known.shape[..])?.into_any()) }
    }
}

/// Reads an array of numbers of a known length.
fn read(py: Python<'_>, value: &Bound<'_, PyAny>, out: &mut [f64], what: &str) -> PyResult<()> {
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
        let array = PyModule::import(py, "numpy")?.call_method1("asarray", (value, "float64"))?;
        return read(py, &array, out, what);
    }
    Ok(())
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
            let action = this.action(py, if this.known.acts_by_effort { effort } else { command })?;
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

/// What Python tells of an environment.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Told {
    name: String,
    about: String,
    make: Py<PyAny>,
    law: Option<Py<Law>>,
    /// Names and units.
    observation: Vec<(String, String)>,
    state: Option<Py<PyAny>>,
    places: Vec<usize>,
    /// Name, lower and upper limit.
    command: Vec<(String, f64, f64)>,
    build: Option<Py<PyAny>>,
    shaped_by: Vec<String>,
    shape: Vec<usize>,
    single: bool,
    limits: Vec<(f64, f64)>,
    horizon: usize,
    time_step: f64,
}

/// Registers a problem whose world is an environment in Python.
#[pyfunction]
pub(crate) fn register(py: Python<'_>, told: Told) -> PyResult<()> {
    let port = |(name, unit): (String, String)| Ok(Port { name, dimension: crate::law::dimension(&unit)? });
    let plain = |name: &String| Port { name: name.clone(), dimension: Dimension::None };
    let observation = told.observation.into_iter().map(port).collect::<PyResult<Vec<_>>>()?;
    let acts_by_effort = told.law.is_some();
    let law = match &told.law {
        Some(law) => law.get().traced.clone(),
        None => empty_law()?,
    };
    let ports = law.ports().clone();
    let command = |(name, lo, hi)| CommandPort { name, dimension: Dimension::None, lo, hi, direct: !acts_by_effort };
    let half = |(lo, hi): &(f64, f64)| (hi - lo).is_finite().then_some(EXPLORED * (hi - lo));
    let spec = EnvSpec {
        observation,
        state: ports.state.iter().map(plain).collect(),
        context: Vec::new(),
        effort: ports.effort.iter().map(plain).collect(),
        command: told.command.into_iter().map(command).collect(),
        horizon: told.horizon,
        time_step: told.time_step,
        shaped_by: told.shaped_by,
        terms: Vec::new(),
    };
    let effort_std = ports.effort.iter().zip(&told.limits).map(|(_, limits)| half(limits)).collect();
    let raised = Raised::default();
    RAISED.lock().unwrap_or_else(PoisonError::into_inner).insert(told.name.clone(), raised.clone());
    let problem = PythonProblem(Arc::new(Known {
        raised,
        name: told.name,
        about: told.about,
        law,
        spec,
        effort_std,
        make: told.make,
        state: told.state,
        places: told.places,
        build: told.build,
        shape: told.shape,
        single: told.single,
        limits: told.limits,
        acts_by_effort,
    }));
    py.detach(|| add(problem))?;
    Ok(())
}

/// A law of nothing: commands act by themselves.
fn empty_law() -> PyResult<CoreLaw> {
    let space = hwasp_core::DesignSpace::new(Vec::new()).map_err(crate::error::Wrong::input)?;
    let program = hwasp_diff::Program::trace(&[""; 0], &[""; 0], |_, _| Vec::new());
    let ports = hwasp_core::Ports::default();
    Ok(CoreLaw::from_program(program, space, ports).map_err(crate::error::Wrong::input)?)
}
