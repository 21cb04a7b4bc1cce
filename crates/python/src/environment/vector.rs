//! Environments of a vector environment: they are stepped together.
//!
//! Each is a lane of a company. Lanes that go in lock step announce what they will do; the first of them that is stepped steps all.
//! A lane whose episode is over, or that nobody has begun, idles: it is started anew where it has to be, and gets an action of zeros.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use hwasp_core::{End, EnvSpec, Environment, Step, Stream};
use numpy::PyArray1;
use pyo3::intern;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};
use rand::Rng;

use super::known::{Known, Methods, read, split};
use crate::error;

/// Lanes of one vector environment.
pub(super) struct Company {
    known: Arc<Known>,
    /// None where it could not be made.
    methods: Option<Methods>,
    lanes: usize,
    /// `[lanes, A]`.
    actions: Vec<f64>,
    announced: Vec<bool>,
    /// Lanes whose step was computed and not fetched.
    done: Vec<bool>,
    /// Lanes whose episode is over.
    over: Vec<bool>,
    begun: bool,
    /// `[lanes, O]`.
    seen: Vec<f64>,
    /// `[lanes, S]`.
    state: Vec<f64>,
    reward: Vec<f64>,
    terminated: Vec<f64>,
    truncated: Vec<f64>,
    fault: Option<String>,
}

impl Company {
    /// So many lanes, of as many companies as it takes.
    pub(super) fn lanes(known: &Arc<Known>, count: usize, horizon: Option<usize>) -> Vec<Box<dyn Environment>> {
        let mut made: Vec<Box<dyn Environment>> = Vec::with_capacity(count);
        while made.len() < count {
            let company = Self::new(known);
            let lanes = company.lanes.min(count - made.len());
            let company = Arc::new(Mutex::new(company));
            for lane in 0..lanes {
                let mut spec = known.spec.clone();
                spec.horizon = horizon.unwrap_or(spec.horizon);
                made.push(Box::new(Lane { company: Arc::clone(&company), place: lane, spec, taken: 0 }));
            }
        }
        made
    }

    fn new(known: &Arc<Known>) -> Self {
        let (methods, fault) = split(known.made());
        let (lanes, spec) = (known.lanes.unwrap_or(1), &known.spec);
        Self {
            actions: vec![0.0; lanes * known.limits.len()],
            announced: vec![false; lanes],
            done: vec![false; lanes],
            over: vec![false; lanes],
            begun: false,
            seen: vec![0.0; lanes * spec.observation.len()],
            state: vec![0.0; lanes * spec.state.len()],
            reward: vec![0.0; lanes],
            terminated: vec![0.0; lanes],
            truncated: vec![0.0; lanes],
            methods,
            known: Arc::clone(known),
            lanes,
            fault,
        }
    }

    /// Does what may raise an exception, which then waits for the main thread.
    fn attempt(&mut self, work: impl FnOnce(&mut Self, Python<'_>) -> PyResult<()>) {
        if self.fault.is_some() {
            return;
        }
        Python::attach(|py| {
            if let Err(error) = work(self, py) {
                self.fault = Some(error.to_string());
                self.known.raised.keep(error);
            }
        });
    }

    fn announce(&mut self, lane: usize, effort: &[f64], command: &[f64]) {
        let values = if self.known.acts_by_effort { effort } else { command };
        let width = values.len();
        self.actions[lane * width..][..width].copy_from_slice(values);
        self.announced[lane] = true;
    }

    /// Steps all lanes.
    fn step(&mut self, py: Python<'_>) -> PyResult<()> {
        // None of those that are announced: an episode that is over is begun before it is stepped.
        let idle: Vec<bool> =
            self.over.iter().zip(&self.announced).map(|(over, announced)| *over && !announced).collect();
        if idle.contains(&true) {
            self.start(py, &idle, 0)?;
        }
        let Some(methods) = &self.methods else { return Ok(()) };
        let action = self.known.action(py, &self.actions, Some(self.lanes))?;
        let result = methods.step.bind(py).call1((action,))?;
        let result = result.cast::<PyTuple>().ok().filter(|result| result.len() == 5).ok_or_else(|| {
            error::input("step gives (observations, rewards, terminated, truncated, info), as Gymnasium's vector environments do")
        })?;
        read(&result.get_item(1)?, &mut self.reward, "the rewards")?;
        read(&result.get_item(2)?, &mut self.terminated, "what was terminated")?;
        read(&result.get_item(3)?, &mut self.truncated, "what was truncated")?;
        let all = vec![true; self.lanes];
        self.see(&result.get_item(0)?, &all)?;
        for i in 0..self.lanes {
            self.over[i] = self.terminated[i] != 0.0 || self.truncated[i] != 0.0;
            self.done[i] = self.announced[i];
            self.announced[i] = false;
        }
        self.actions.fill(0.0);
        Ok(())
    }

    /// Starts episodes of the lanes of a mask.
    fn start(&mut self, py: Python<'_>, mask: &[bool], seed: u32) -> PyResult<()> {
        let Some(methods) = &self.methods else { return Ok(()) };
        let (options, chosen) = (PyDict::new(py), PyDict::new(py));
        let seeds: Vec<Option<u32>> = mask.iter().map(|&chosen| chosen.then_some(seed)).collect();
        if self.begun {
            chosen.set_item(intern!(py, "reset_mask"), PyArray1::from_slice(py, mask))?;
            options.set_item(intern!(py, "options"), chosen)?;
            options.set_item(intern!(py, "seed"), seeds)?;
        } else {
            // No mask starts what never began.
            options.set_item(intern!(py, "seed"), vec![seed; self.lanes])?;
            self.begun = true;
        }
        let started = methods.reset.bind(py).call((), Some(&options))?;
        let observation = started.get_item(0)?;
        for (over, &started) in self.over.iter_mut().zip(mask) {
            *over &= !started;
        }
        self.see(&observation, mask)
    }

    /// Takes the observations of some lanes in.
    fn see(&mut self, observation: &Bound<'_, PyAny>, mask: &[bool]) -> PyResult<()> {
        let mut all = vec![0.0; self.seen.len()];
        read(observation, &mut all, "the observations")?;
        let Some(methods) = &self.methods else { return Ok(()) };
        let (width, states) = (self.known.spec.observation.len(), self.known.spec.state.len());
        for lane in (0..self.lanes).filter(|&lane| mask[lane]) {
            let seen = &all[lane * width..][..width];
            self.seen[lane * width..][..width].copy_from_slice(seen);
            let row = observation.get_item(lane)?;
            let state = &mut self.state[lane * states..][..states];
            self.known.read_state(methods.env.bind(observation.py()), &row, seen, state)?;
        }
        Ok(())
    }
}

/// One environment of a company.
struct Lane {
    company: Arc<Mutex<Company>>,
    place: usize,
    spec: EnvSpec,
    taken: usize,
}

impl Lane {
    fn company(&self) -> MutexGuard<'_, Company> {
        self.company.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Environment for Lane {
    fn spec(&self) -> &EnvSpec {
        &self.spec
    }

    fn reset(&mut self, rng: &mut Stream) {
        self.taken = 0;
        let (lane, seed) = (self.place, rng.next_u32());
        let mut company = self.company();
        let mask: Vec<bool> = (0..company.lanes).map(|other| other == lane).collect();
        (company.announced[lane], company.done[lane]) = (false, false);
        company.attempt(|company, py| company.start(py, &mask, seed));
    }

    fn observe(&self, out: &mut [f64]) {
        out.copy_from_slice(&self.company().seen[self.place * out.len()..][..out.len()]);
    }

    fn state(&self, out: &mut [f64]) {
        out.copy_from_slice(&self.company().state[self.place * out.len()..][..out.len()]);
    }

    fn announce(&mut self, effort: &[f64], command: &[f64]) {
        let lane = self.place;
        self.company().announce(lane, effort, command);
    }

    fn step(&mut self, effort: &[f64], command: &[f64]) -> Step {
        self.taken += 1;
        let (lane, spent) = (self.place, self.taken >= self.spec.horizon);
        let mut company = self.company();
        if !company.done[lane] {
            company.announce(lane, effort, command);
            company.attempt(Company::step);
        }
        company.done[lane] = false;
        if company.fault.is_some() {
            return Step { reward: 0.0, end: Some(End::Faulted) };
        }
        let end = match (company.terminated[lane] != 0.0, company.truncated[lane] != 0.0 || spent) {
            (true, _) => Some(End::Terminated),
            (false, true) => Some(End::Truncated),
            (false, false) => None,
        };
        Step { reward: company.reward[lane], end }
    }

    fn fault(&self) -> Option<String> {
        self.company().fault.clone()
    }
}
