//! Episodes of a robot.

mod advance;

use std::sync::Arc;

use hwasp_core::{End, EnvSpec, Environment, MakeEnvironment, Outcome, Sight, Step, Stream};
use hwasp_expr::Distribution;
use hwasp_mujoco::engine::{Spec, View};
use rand::{RngExt, SeedableRng};
use rand_distr::StandardNormal;

use crate::body::Body;
use crate::columns::Column;
use crate::delay::{DELAYS, Delay};
use crate::ready::Ready;
use crate::robot::{Formula, Robot};

/// Makes environments of a robot.
#[derive(Clone, Debug)]
pub(crate) struct ModelEnvironments {
    pub(crate) robot: Arc<Robot>,
    /// Whether the law runs at the rate of the physics, and the efforts that come from outside are not heeded.
    pub(crate) own_law: bool,
}

impl MakeEnvironment for ModelEnvironments {
    fn make(&self, horizon: Option<usize>) -> Box<dyn Environment> {
        Box::new(ModelEnvironment::new(&self.robot, horizon, self.own_law))
    }
}

/// One robot in one world.
#[derive(Debug)]
pub(crate) struct ModelEnvironment {
    robot: Arc<Robot>,
    spec: EnvSpec,
    body: Body,
    /// The model in the making; none where nothing of it follows the design or chance.
    making: Option<Spec>,
    /// The numbers of the shaped fields that the simulation was compiled with.
    shaped: Vec<f64>,
    design: Vec<f64>,
    values: Vec<f64>,
    random: Option<Ready>,
    shaping: Option<Ready>,
    start: Option<Ready>,
    step: Ready,
    forces: Option<Ready>,
    delays: Option<Ready>,
    own_law: bool,
    effort: Vec<f64>,
    command: Vec<f64>,
    /// What the law reads, of the moment when it was read: later the memory has moved on.
    state: Vec<f64>,
    progress: f64,
    taken: usize,
    /// What the draws of an episode come from.
    chance: Stream,
    seen: Delay,
    told: Delay,
    kind: usize,
    success: bool,
    /// Which of the robot's ends has come.
    ended: Option<usize>,
    /// What each term of the reward came to so far.
    terms: Vec<f64>,
    fault: Option<String>,
    /// What is seen of the model with the numbers of the shaped fields that it was compiled with.
    view: Option<(Vec<f64>, View)>,
}

impl ModelEnvironment {
    pub(crate) fn new(robot: &Arc<Robot>, horizon: Option<usize>, own_law: bool) -> Self {
        let mut spec = robot.env.clone();
        spec.horizon = horizon.unwrap_or(spec.horizon);
        let ready = |formula: Option<&Formula>| formula.map(Ready::new);
        let mut environment = Self {
            body: Body::new(robot.simulation(), &robot.columns),
            making: None,
            shaped: Vec::new(),
            design: robot.law.design().middle(),
            values: vec![0.0; robot.columns.len()],
            random: ready(robot.random.as_ref().map(|(formula, _)| formula)),
            shaping: ready(robot.shaping.as_ref().map(|shaping| &shaping.formula)),
            start: ready(robot.start.as_ref().map(|(formula, _)| formula)),
            step: Ready::new(&robot.step),
            forces: ready(robot.forces.as_ref().map(|(formula, _)| formula)),
            delays: ready(robot.delays.as_ref()),
            own_law,
            effort: vec![0.0; spec.effort.len()],
            command: vec![0.0; spec.command.len()],
            state: vec![0.0; robot.states.len()],
            progress: 1.0,
            taken: 0,
            chance: Stream::seed_from_u64(0),
            seen: Delay::default(),
            told: Delay::default(),
            kind: 0,
            success: false,
            ended: None,
            terms: vec![0.0; spec.terms.len()],
            fault: None,
            view: None,
            robot: Arc::clone(robot),
            spec,
        };
        environment.bind();
        environment
    }

    /// Gives every program the design.
    fn bind(&mut self) {
        let robot = &*self.robot;
        let pairs = [
            (&mut self.random, robot.random.as_ref().map(|(formula, _)| formula)),
            (&mut self.shaping, robot.shaping.as_ref().map(|shaping| &shaping.formula)),
            (&mut self.start, robot.start.as_ref().map(|(formula, _)| formula)),
            (&mut self.forces, robot.forces.as_ref().map(|(formula, _)| formula)),
            (&mut self.delays, robot.delays.as_ref()),
        ];
        for (ready, formula) in pairs {
            if let (Some(ready), Some(formula)) = (ready, formula) {
                ready.bind(formula, &self.design);
            }
        }
        self.step.bind(&robot.step, &self.design);
    }

    /// Draws what a formula draws.
    fn draw(&mut self, draws: &[(Distribution, usize)]) {
        for &(from, column) in draws {
            self.values[column] = match from {
                Distribution::Uniform => self.chance.random::<f64>(),
                Distribution::Normal => self.chance.sample::<f64, _>(StandardNormal),
            };
        }
    }

    /// Columns that are no readings of the engine.
    fn fill_own(&mut self) {
        let time = self.taken as f64 * self.spec.time_step;
        for (value, column) in self.values.iter_mut().zip(&self.robot.columns) {
            match *column {
                Column::Command(i) => *value = self.command[i],
                Column::Effort(i) => *value = self.effort[i],
                Column::Time => *value = time,
                Column::Count => *value = self.taken as f64,
                Column::Progress => *value = self.progress,
                Column::Engine(_) | Column::Memory(_) | Column::Random(_) | Column::Draw(..) => {}
            }
        }
    }

    /// The quantities of the episode.
    fn draw_episode(&mut self) -> Result<(), String> {
        let robot = Arc::clone(&self.robot);
        let (Some((formula, columns)), Some(_)) = (&robot.random, &self.random) else { return Ok(()) };
        self.draw(&formula.draws);
        if let Some(ready) = &mut self.random {
            ready.run(formula, &self.values);
            for (i, (&column, &value)) in columns.iter().zip(&ready.out).enumerate() {
                if !value.is_finite() {
                    let name = &formula.program.output_names()[i];
                    return Err(format!(
                        "`{name}` of [task.random] is {value}: see the limits that it is drawn between"
                    ));
                }
                self.values[column] = value;
            }
        }
        Ok(())
    }

    /// Compiles the model anew where design or chance have changed it.
    fn shape(&mut self) -> Result<(), String> {
        let robot = Arc::clone(&self.robot);
        let (Some(shaping), Some(ready)) = (&robot.shaping, &mut self.shaping) else { return Ok(()) };
        ready.run(&shaping.formula, &self.values);
        if same(&ready.out, &self.shaped) {
            return Ok(());
        }
        let making = match &mut self.making {
            Some(making) => making,
            None => self.making.insert(robot.making().map_err(|error| error.to_string())?),
        };
        self.shaped.clear();
        for (field, &value) in shaping.fields.iter().zip(&ready.out) {
            making.set(field, value).map_err(|error| error.to_string())?;
        }
        let simulation = making.compile().map_err(|error| error.to_string())?;
        self.body.exchange(simulation);
        self.shaped.extend_from_slice(&ready.out);
        Ok(())
    }

    /// Puts the state where episodes start.
    fn place(&mut self) -> Result<(), String> {
        let robot = Arc::clone(&self.robot);
        self.body.reset(robot.keyframe.as_deref())?;
        if let (Some((formula, targets)), true) = (&robot.start, self.start.is_some()) {
            self.body.refresh(robot.fresh)?;
            self.body.read(&mut self.values);
            self.draw(&formula.draws);
            if let Some(ready) = &mut self.start {
                ready.run(formula, &self.values);
                self.body.write(targets, &ready.out)?;
            }
        }
        // What is derived of the state has to be that of the start, whatever it is after a step.
        self.body.refresh(true)
    }

    fn begin(&mut self, rng: &mut Stream) -> Result<(), String> {
        self.chance = Stream::seed_from_u64(rng.random());
        (self.taken, self.success, self.kind, self.ended) = (0, false, 0, None);
        self.effort.fill(0.0);
        self.command.fill(0.0);
        self.terms.fill(0.0);
        // Nothing of the episode before: what comes may follow on any other.
        for (value, column) in self.values.iter_mut().zip(&self.robot.columns) {
            if matches!(column, Column::Memory(_) | Column::Draw(..)) {
                *value = 0.0;
            }
        }
        self.fill_own();
        self.draw_episode()?;
        self.shape()?;
        self.place()?;
        let robot = Arc::clone(&self.robot);
        let mut delays = [0; 2];
        if let (Some(formula), Some(ready)) = (&robot.delays, &mut self.delays) {
            ready.run(formula, &self.values);
            for ((steps, &time), key) in delays.iter_mut().zip(&ready.out).zip(DELAYS) {
                let told = |fault| format!("`{key}` of [task]: {fault}");
                *steps = Delay::steps(time, self.spec.time_step).map_err(told)?;
            }
        }
        self.seen.begin(delays[0]);
        self.told.begin(delays[1]);
        self.body.read(&mut self.values);
        // Before the first step all was as at the start: each pass settles one more of what was before that.
        if robot.outputs.memory > 0 {
            self.draw(&robot.step.draws);
        }
        for _ in 0..robot.outputs.memory {
            self.step.run(&robot.step, &self.values);
            if !self.remember() {
                break;
            }
        }
        self.evaluate()?;
        let kinds = robot.outputs.kinds_at();
        self.kind = self.step.out[kinds].iter().position(|&holds| holds != 0.0).unwrap_or(robot.outputs.kinds);
        self.remember();
        Ok(())
    }

    /// Observation, reward and ends of the state at hand.
    fn evaluate(&mut self) -> Result<(), String> {
        let robot = Arc::clone(&self.robot);
        self.draw(&robot.step.draws);
        self.step.run(&robot.step, &self.values);
        let told = &self.step.out[..self.step.out.len() - robot.outputs.memory];
        // Observations are read in single precision.
        let sound = |(i, value): (usize, &f64)| {
            if i < robot.outputs.observations { (*value as f32).is_finite() } else { value.is_finite() }
        };
        if let Some((i, value)) = told.iter().enumerate().find(|&at| !sound(at)) {
            return Err(format!("{} is {value} after {} steps", robot.output_name(i), self.taken));
        }
        self.seen.pass(&mut self.step.out[..robot.outputs.observations]);
        for (state, &at) in self.state.iter_mut().zip(&robot.states) {
            *state = self.values[at];
        }
        Ok(())
    }

    /// Keeps what the next step calls the step before. Whether that is something new.
    fn remember(&mut self) -> bool {
        let from = self.step.out.len() - self.robot.outputs.memory;
        let mut new = false;
        for (&column, &value) in self.robot.memory.iter().zip(&self.step.out[from..]) {
            new |= self.values[column].to_bits() != value.to_bits();
            self.values[column] = value;
        }
        new
    }
}

/// Whether all have the same bits.
fn same(a: &[f64], b: &[f64]) -> bool {
    a.iter().map(|x| x.to_bits()).eq(b.iter().map(|x| x.to_bits()))
}

impl Environment for ModelEnvironment {
    fn spec(&self) -> &EnvSpec {
        &self.spec
    }

    fn set_progress(&mut self, progress: f64) {
        self.progress = progress;
    }

    fn set_design(&mut self, design: &[f64]) {
        if self.design != design {
            self.design.copy_from_slice(design);
            self.bind();
        }
    }

    fn reset(&mut self, rng: &mut Stream) {
        self.fault = self.begin(rng).err();
    }

    fn observe(&self, out: &mut [f64]) {
        out.copy_from_slice(&self.step.out[..out.len()]);
    }

    fn state(&self, out: &mut [f64]) {
        out.copy_from_slice(&self.state);
    }

    fn step(&mut self, effort: &[f64], command: &[f64]) -> Step {
        let faulted = Step { reward: 0.0, end: Some(End::Faulted) };
        if self.fault.is_some() {
            return faulted;
        }
        for ((own, &command), port) in self.command.iter_mut().zip(command).zip(&self.spec.command) {
            *own = command.clamp(port.lo, port.hi);
        }
        self.effort.copy_from_slice(effort);
        self.delay_told();
        let advanced = self.advance().and_then(|()| self.body.refresh(self.robot.fresh));
        self.taken += 1;
        if let Err(error) = advanced {
            self.fault = Some(error);
            return faulted;
        }
        self.body.read(&mut self.values);
        self.fill_own();
        if let Err(error) = self.evaluate() {
            self.fault = Some(error);
            return faulted;
        }
        self.remember();
        let outputs = self.robot.outputs;
        let mut reward = 0.0;
        for (sum, term) in self.terms.iter_mut().zip(&self.step.out[outputs.terms_at()]) {
            *sum += term;
            reward += term;
        }
        let holds = |at: usize| self.step.out[at] != 0.0;
        self.success = outputs.success_at().is_some_and(holds);
        self.ended = outputs.ends_at().position(holds);
        let end = if self.ended.is_some() {
            Some(End::Terminated)
        } else if self.taken >= self.spec.horizon {
            Some(End::Truncated)
        } else {
            None
        };
        Step { reward, end }
    }

    fn terms(&self) -> &[f64] {
        &self.terms
    }

    fn ended_by(&self) -> Option<Arc<str>> {
        let name = &self.robot.ends[self.ended?];
        (!name.is_empty()).then(|| Arc::clone(name))
    }

    fn outcome(&self) -> Option<Outcome> {
        let kind = Arc::clone(&self.robot.kinds[self.kind]);
        self.robot.outputs.success.then_some(Outcome { kind, success: self.success })
    }

    fn look(&mut self) -> Option<Sight> {
        if !self.view.as_ref().is_some_and(|(shaped, _)| same(shaped, &self.shaped)) {
            self.view = Some((self.shaped.clone(), self.robot.view(&self.shaped)?));
        }
        let (_, view) = self.view.as_mut()?;
        Some(view.sight(self.body.positions()))
    }

    fn fault(&self) -> Option<String> {
        self.fault.clone()
    }
}
