//! Many episodes of one world, stepped in lock step by actions from outside: what is behind the Gymnasium environments.

mod lane;

use std::num::NonZeroUsize;
use std::time::{Duration, Instant};

use hwasp_core::End;
use hwasp_experiment::MOST_STEPS;
use numpy::{PyArray1, PyArray2, PyArrayDyn, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use rayon::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};

use crate::environment::Raised;
use crate::error::{self, Wrong};
use crate::experiment::Experiment;
use crate::training::sound_threads;
use lane::{Interface, Lane};

/// The most environments of one vector.
const MOST_LANES: usize = 65_536;
/// Lanes that one thread steps before another one may take the next.
const CHUNK: usize = 4;
/// A step that takes longer is done sooner by several threads.
const WORTH: Duration = Duration::from_micros(200);
/// Steps in a row after which that is sure.
const SURE: u32 = 4;

/// Episodes in lock step.
#[pyclass(module = "hwasp._hwasp")]
pub(crate) struct Episodes {
    interface: Interface,
    lanes: Vec<Lane>,
    /// None where they are as many as there are cores, and come when a step is worth it.
    threads: Option<usize>,
    /// Steps in a row that were worth it.
    worth: u32,
    pool: Option<Pool>,
    open: bool,
    /// Lanes whose episode ended with the last step; they begin anew with the next one.
    waiting: Vec<bool>,
    /// The actions of the step at hand, `[lanes, A]`.
    actions: Vec<f64>,
    raised: Raised,
}

#[pymethods]
impl Episodes {
    #[new]
    #[pyo3(signature = (experiment, *, lanes, threads, deployment, scale_actions, scale_observations, progress, horizon))]
    #[allow(clippy::too_many_arguments, reason = "the names are Python's keywords")]
    fn new(
        py: Python<'_>,
        experiment: &Experiment,
        lanes: usize,
        threads: Option<usize>,
        deployment: bool,
        scale_actions: bool,
        scale_observations: bool,
        progress: f64,
        horizon: Option<usize>,
    ) -> PyResult<Self> {
        if horizon.is_some_and(|horizon| !(1..=MOST_STEPS).contains(&horizon)) {
            return Err(error::input(format!("horizon is from 1 to {MOST_STEPS}")));
        }
        if !(1..=MOST_LANES).contains(&lanes) {
            return Err(error::input(format!("num_envs = {lanes}; it is from 1 to {MOST_LANES}")));
        }
        threads.map(sound_threads).transpose()?;
        if !(0.0..=1.0).contains(&progress) {
            return Err(error::input(format!("progress = {progress}; it is from 0 to 1")));
        }
        let made = py.detach(|| -> Result<Self, Wrong> {
            let assembly = experiment.assembly()?;
            let raised = Raised::of(assembly.experiment().task.name());
            let (policy, params) = (&assembly.policy, assembly.init());
            let worlds = &assembly.worlds;
            let world = if deployment { &worlds.deployment } else { &worlds.training };
            let mut interface = Interface::new(policy, &params, world, scale_actions, scale_observations, progress);
            interface.env.horizon = horizon.unwrap_or(interface.env.horizon);
            let design = policy.design(&params);
            let lanes = (0..lanes).map(|_| Lane::new(&interface, policy, &design, world.make.make(horizon)));
            let lanes: Vec<Lane> = lanes.collect();
            let waiting = vec![false; lanes.len()];
            Ok(Self {
                interface,
                lanes,
                threads,
                worth: 0,
                pool: None,
                open: true,
                waiting,
                actions: Vec::new(),
                raised,
            })
        });
        let made = made?;
        made.check_raised()?;
        Ok(made)
    }

    /// Starts episodes: in all lanes, or in those of the mask. A lane without a seed goes on with the next episode of the seed
    /// that it has. Returns the observations `[lanes, O]`.
    fn reset<'py>(
        &mut self,
        py: Python<'py>,
        seeds: Vec<Option<u64>>,
        mask: Option<Vec<bool>>,
    ) -> PyResult<Bound<'py, PyArray2<f32>>> {
        self.check_open()?;
        let count = self.lanes.len();
        if seeds.len() != count || mask.as_ref().is_some_and(|mask| mask.len() != count) {
            return Err(error::input(format!("seeds and mask have one entry for each of {count} environments")));
        }
        let (lanes, interface, waiting) = (&mut self.lanes, &self.interface, &mut self.waiting);
        py.detach(|| {
            for (i, (lane, seed)) in lanes.iter_mut().zip(&seeds).enumerate() {
                if mask.as_ref().is_some_and(|mask| !mask[i]) {
                    continue;
                }
                waiting[i] = false;
                match seed {
                    Some(seed) => {
                        (lane.seed, lane.episode) = (*seed, 0);
                        lane.start(interface);
                    }
                    None => lane.next(interface),
                }
            }
        });
        self.check_raised()?;
        self.observations(py)
    }

    /// One step of every lane by `action` `[lanes, A]`. Where an episode ended with the step before and `next_step` is asked for,
    /// the lane starts its next one instead. With `same_step` it starts at once, and the last observation is kept.
    ///
    /// Writes observations, rewards, and whether episodes were terminated and truncated; returns the lanes whose episode ended.
    #[allow(clippy::too_many_arguments, reason = "the arrays that are written")]
    fn step<'py>(
        &mut self,
        py: Python<'py>,
        action: &Bound<'py, PyAny>,
        next_step: bool,
        same_step: bool,
        observation: &Bound<'py, PyArray2<f32>>,
        reward: &Bound<'py, PyArray1<f64>>,
        terminated: &Bound<'py, PyArray1<bool>>,
        truncated: &Bound<'py, PyArray1<bool>>,
    ) -> PyResult<Vec<usize>> {
        self.check_open()?;
        let shape = [self.lanes.len(), self.interface.names.len()];
        take_in(action, shape, &self.interface.names, &mut self.actions)?;
        if let Some(lane) = (0..shape[0]).find(|&i| !self.lanes[i].begun && !self.waiting[i]) {
            let what = if self.lanes[lane].end.is_some() { "is over" } else { "has not begun" };
            return Err(error::input(format!("the episode of environment {lane} {what}: call reset first")));
        }
        self.attend_to_threads()?;
        let (interface, waiting, actions, width) = (&self.interface, &self.waiting, &self.actions[..], shape[1]);
        let work = |(i, lane): (usize, &mut Lane)| {
            if waiting[i] {
                lane.next(interface);
                (lane.reward, lane.end) = (0.0, None);
                return;
            }
            lane.step(interface, |component| actions[i * width + component]);
            if same_step && lane.end.is_some() {
                lane.last.copy_from_slice(&lane.obs);
            }
        };
        let (lanes, pool) = (&mut self.lanes, self.pool.as_ref().and_then(|pool| pool.threads.as_ref()));
        let began = Instant::now();
        py.detach(|| match pool {
            Some(pool) => pool.install(|| {
                lanes.par_iter_mut().with_min_len(CHUNK).enumerate().for_each(work);
            }),
            None => lanes.iter_mut().enumerate().for_each(work),
        });
        if self.pool.is_none() {
            self.worth = if began.elapsed() > WORTH { self.worth + 1 } else { 0 };
        }
        self.check_raised()?;
        let ended: Vec<usize> = (0..shape[0]).filter(|&i| self.lanes[i].end.is_some()).collect();
        self.waiting.fill(false);
        for &i in &ended {
            self.waiting[i] = next_step;
        }
        let (mut reward, mut terminated, mut truncated) =
            (reward.try_readwrite()?, terminated.try_readwrite()?, truncated.try_readwrite()?);
        let (reward, terminated, truncated) =
            (reward.as_slice_mut()?, terminated.as_slice_mut()?, truncated.as_slice_mut()?);
        for (i, lane) in self.lanes.iter().enumerate() {
            reward[i] = lane.reward;
            terminated[i] = lane.end == Some(End::Terminated);
            // An episode whose physics failed came to no end of its own.
            truncated[i] = matches!(lane.end, Some(End::Truncated | End::Faulted));
        }
        if !same_step || ended.is_empty() {
            self.write(observation)?;
        }
        Ok(ended)
    }

    /// What is to be told of a lane whose episode has ended.
    fn ending<'py>(&mut self, py: Python<'py>, lane: usize) -> PyResult<Bound<'py, PyDict>> {
        let terms = self.interface.env.terms.clone();
        let lane = self.lane(lane)?;
        let told = PyDict::new(py);
        if let Some(outcome) = lane.environment().outcome() {
            told.set_item("is_success", outcome.success)?;
            told.set_item("kind", &*outcome.kind)?;
        }
        if let Some(name) = lane.environment().ended_by() {
            told.set_item("ended_by", &*name)?;
        }
        if lane.end == Some(End::Faulted) {
            told.set_item("fault", lane.environment().fault())?;
        }
        if !terms.is_empty() {
            let named = PyDict::new(py);
            for (name, value) in terms.iter().zip(lane.environment().terms()) {
                named.set_item(name, value)?;
            }
            told.set_item("terms", named)?;
        }
        Ok(told)
    }

    /// Begins the next episodes of some lanes at once, after what is to be told of them was told; writes the observations.
    fn go_on(&mut self, py: Python<'_>, ended: Vec<usize>, observation: &Bound<'_, PyArray2<f32>>) -> PyResult<()> {
        let (lanes, interface) = (&mut self.lanes, &self.interface);
        py.detach(|| {
            for i in ended {
                lanes[i].next(interface);
                lanes[i].end = None;
            }
        });
        self.check_raised()?;
        self.write(observation)
    }

    /// The observation with which the last episode of a lane ended.
    fn last<'py>(&mut self, py: Python<'py>, lane: usize) -> PyResult<Bound<'py, PyArray1<f32>>> {
        Ok(PyArray1::from_slice(py, &self.lane(lane)?.last))
    }

    /// Builds the hardware of a lane to another design, SI, from its next start on: one value for each parameter.
    fn build(&mut self, lane: usize, design: Vec<f64>) -> PyResult<()> {
        let lane = self.lane(lane)?;
        let needed = lane.design.len();
        if design.len() != needed || design.iter().any(|value| !value.is_finite()) {
            return Err(error::input(format!("a design has {needed} finite numbers here, one for each parameter")));
        }
        lane.built = design;
        Ok(())
    }

    /// The design of a lane, SI.
    fn design<'py>(&mut self, py: Python<'py>, lane: usize) -> PyResult<Bound<'py, PyArray1<f64>>> {
        Ok(PyArray1::from_slice(py, &self.lane(lane)?.design))
    }

    /// Names, limits and whether in SI: of an action.
    fn actions(&self) -> Vec<(String, Option<(f64, f64)>)> {
        self.interface.names.iter().cloned().zip(self.interface.limits.iter().copied()).collect()
    }

    /// Names and units of an observation.
    fn observation_ports(&self) -> Vec<(String, &'static str)> {
        let ports = self.interface.env.observation.iter();
        ports.map(|port| (port.name.clone(), port.dimension.si())).collect()
    }

    /// What the law reads of a lane, SI, by name.
    fn state<'py>(&mut self, py: Python<'py>, lane: usize) -> PyResult<Bound<'py, PyDict>> {
        let names = self.interface.env.state.clone();
        let mut state = vec![0.0; names.len()];
        self.lane(lane)?.environment().state(&mut state);
        let named = PyDict::new(py);
        for (port, value) in names.iter().zip(state) {
            named.set_item(&port.name, value)?;
        }
        Ok(named)
    }

    #[getter]
    fn horizon(&self) -> usize {
        self.interface.env.horizon
    }

    #[getter]
    fn time_step(&self) -> f64 {
        self.interface.env.time_step
    }

    /// Names of design parameters with their limits, SI.
    fn parameters(&self) -> Vec<(String, f64, f64)> {
        self.interface.parameters.clone()
    }

    /// Tells how much of a training is done, for worlds that begin easier; it counts from the next starts on.
    fn set_progress(&mut self, progress: f64) -> PyResult<()> {
        if !(0.0..=1.0).contains(&progress) {
            return Err(error::input(format!("progress = {progress}; it is from 0 to 1")));
        }
        self.interface.progress = progress;
        Ok(())
    }

    /// Ends all episodes and gives the memory back.
    fn close(&mut self, py: Python<'_>) {
        self.open = false;
        let (lanes, pool) = (std::mem::take(&mut self.lanes), self.pool.take());
        py.detach(|| drop((lanes, pool)));
    }

    #[getter]
    fn is_open(&self) -> bool {
        self.open
    }
}

/// Threads of a process. After a fork they are not here to be ended.
struct Pool {
    process: u32,
    threads: Option<ThreadPool>,
}

impl Drop for Pool {
    fn drop(&mut self) {
        if self.process != std::process::id() {
            std::mem::forget(self.threads.take());
        }
    }
}

impl Episodes {
    fn check_raised(&self) -> PyResult<()> {
        self.raised.take().map_or(Ok(()), Err)
    }

    /// A lane of an environment that is open.
    fn lane(&mut self, lane: usize) -> PyResult<&mut Lane> {
        self.check_open()?;
        let count = self.lanes.len();
        self.lanes
            .get_mut(lane)
            .ok_or_else(|| error::input(format!("there are {count} environments, and no number {lane}")))
    }

    fn check_open(&self) -> PyResult<()> {
        if self.open { Ok(()) } else { Err(error::closed("this environment is closed")) }
    }

    /// Makes the threads where they are wanted and not there: at first, and after a fork.
    fn attend_to_threads(&mut self) -> PyResult<()> {
        let process = std::process::id();
        let threads = match self.threads {
            None if self.worth < SURE => 1,
            None => std::thread::available_parallelism().map_or(1, NonZeroUsize::get),
            Some(threads) => threads,
        };
        if threads == 1 || self.lanes.len() <= CHUNK {
            return Ok(());
        }
        if self.pool.as_ref().is_none_or(|pool| pool.process != process) {
            let threads = ThreadPoolBuilder::new().num_threads(threads).build().map_err(Wrong::failed)?;
            self.pool = Some(Pool { process, threads: Some(threads) });
        }
        Ok(())
    }

    fn observations<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f32>>> {
        let width = self.interface.env.observation.len();
        let values = self.lanes.iter().flat_map(|lane| &lane.obs).copied();
        PyArray1::from_iter(py, values).reshape([self.lanes.len(), width])
    }

    fn write(&self, observation: &Bound<'_, PyArray2<f32>>) -> PyResult<()> {
        let width = self.interface.env.observation.len();
        let mut observation = observation.try_readwrite()?;
        let rows = observation.as_slice_mut()?.chunks_exact_mut(width);
        rows.zip(&self.lanes).for_each(|(row, lane)| row.copy_from_slice(&lane.obs));
        Ok(())
    }
}

/// Takes actions `[lanes, A]` in, of single precision or of double: other threads may write into the array meanwhile.
fn take_in(action: &Bound<'_, PyAny>, shape: [usize; 2], names: &[String], taken: &mut Vec<f64>) -> PyResult<()> {
    taken.clear();
    let found = if let Ok(array) = action.cast::<PyArray2<f32>>() {
        let array = array.try_readonly()?;
        taken.extend(array.as_array().iter().map(|&x| f64::from(x)));
        array.as_array().shape().to_vec()
    } else {
        let array = PyModule::import(action.py(), "numpy")?.call_method1("asarray", (action, "float64"));
        let array = array.map_err(|error| error::input(format!("this is no array of actions: {error}")))?;
        let array = array.cast_into::<PyArrayDyn<f64>>().map_err(PyErr::from)?.try_readonly()?;
        taken.extend(array.as_array().iter());
        array.as_array().shape().to_vec()
    };
    if found != shape {
        return Err(error::input(format!("actions have the shape {found:?}, where {shape:?} is asked for")));
    }
    if let Some(at) = taken.iter().position(|x| !x.is_finite()) {
        let (lane, name) = (at / shape[1], &names[at % shape[1]]);
        return Err(error::input(format!("the action {name} of environment {lane} is no finite number")));
    }
    Ok(())
}
