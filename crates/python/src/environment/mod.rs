//! Environments in Python (Gymnasium's and whatever has their interface) as problems of this program: a law and a design in
//! front of them, this program's learners, placements and ledger behind.

mod known;
mod single;
mod vector;

use std::sync::Arc;

use hwasp_core::{CommandPort, Dimension, EnvSpec, Environment, Law as CoreLaw, MakeEnvironment, Port};
use hwasp_problem::{AnyError, Built, Problem, Words, World};
use pyo3::prelude::*;

use crate::catalogue::add;
use crate::law::Law;
use known::Known;
pub(crate) use known::Raised;
use single::PythonEnvironment;
use vector::Company;

/// Of the range of an action: how widely an effort is explored unless an experiment says otherwise.
const EXPLORED: f64 = 0.15;

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
        if self.0.lanes.is_some() {
            return Company::lanes(&self.0, 1, horizon).remove(0);
        }
        Box::new(PythonEnvironment::new(&self.0, horizon))
    }

    fn make_many(&self, count: usize, horizon: Option<usize>) -> Vec<Box<dyn Environment>> {
        if self.0.lanes.is_some() {
            return Company::lanes(&self.0, count, horizon);
        }
        (0..count).map(|_| self.make(horizon)).collect()
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
    lanes: Option<usize>,
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
    let std = |(lo, hi): &(f64, f64)| (hi - lo).is_finite().then_some(EXPLORED * (hi - lo));
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
    let effort_std = ports.effort.iter().zip(&told.limits).map(|(_, limits)| std(limits)).collect();
    let problem = PythonProblem(Arc::new(Known {
        raised: Raised::begin(&told.name),
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
        lanes: told.lanes,
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
