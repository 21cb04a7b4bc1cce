//! Episodes of a robot.

use std::collections::VecDeque;
use std::sync::Arc;

use hwasp_core::{End, EnvSpec, Environment, MakeEnvironment, Outcome, Step, Stream};
use hwasp_diff::ProgramTape;
use hwasp_expr::Distribution;
use hwasp_mujoco::engine::Spec;
use rand::{RngExt, SeedableRng};
use rand_distr::StandardNormal;

use crate::body::Body;
use crate::columns::Column;
use crate::robot::{Formula, Robot, Target};

/// How often what is remembered is computed at the start: formulas of what was before may be nested so deep.
const MEMORY_PASSES: usize = 4;

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

/// A program that is ready to run, and where its numbers go.
#[derive(Debug)]
struct Ready {
    tape: ProgramTape<f64>,
    out: Vec<f64>,
}

impl Ready {
    fn new(formula: &Formula) -> Self {
        Self { tape: formula.program.tape(1), out: vec![0.0; formula.program.output_names().len()] }
    }

    fn bind(&mut self, formula: &Formula, design: &[f64]) {
        formula.program.bind(design, &mut self.tape);
    }

    fn run(&mut self, formula: &Formula, values: &[f64]) {
        formula.program.forward(values, 1, 1, &mut self.tape, &mut self.out, 1);
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
    terms: Vec<f64>,
    fault: Option<String>,
}

/// Values of the last steps, the newest last.
#[derive(Debug, Default)]
struct Delay {
    steps: usize,
    kept: VecDeque<Vec<f64>>,
}

impl Delay {
    fn begin(&mut self, steps: usize) {
        self.steps = steps;
        self.kept.clear();
    }

    /// Takes a value and gives the one of some steps before; the oldest that there is at the start.
    fn pass(&mut self, value: &mut [f64]) {
        if self.steps == 0 {
            return;
        }
        let mut newest =
            if self.kept.len() > self.steps { self.kept.pop_front().unwrap_or_default() } else { Vec::new() };
        newest.clear();
        newest.extend_from_slice(value);
        self.kept.push_back(newest);
        if let Some(oldest) = self.kept.front() {
            value.copy_from_slice(oldest);
        }
    }
}

impl ModelEnvironment {
    pub(crate) fn new(robot: &Arc<Robot>, horizon: Option<usize>, own_law: bool) -> Self {
        let mut spec = robot.env.clone();
        spec.horizon = horizon.unwrap_or(spec.horizon);
        let ready = |formula: Option<&Formula>| formula.map(Ready::new);
        let design = robot.law.design();
        let mut environment = Self {
            body: Body::new(robot.simulation(), &robot.columns),
            making: None,
            shaped: Vec::new(),
            design: (0..design.len()).map(|i| 0.5 * (design.bounds(i).0 + design.bounds(i).1)).collect(),
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
            terms: vec![0.0; robot.terms.len()],
            fault: None,
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
    fn draw_episode(&mut self) {
        let robot = Arc::clone(&self.robot);
        let (Some((formula, columns)), Some(_)) = (&robot.random, &self.random) else { return };
        self.draw(&formula.draws);
        if let Some(ready) = &mut self.random {
            ready.run(formula, &self.values);
            for (&column, &value) in columns.iter().zip(&ready.out) {
                self.values[column] = value;
            }
        }
    }

    /// Compiles the model anew where design or chance have changed it.
    fn shape(&mut self) -> Result<(), String> {
        let robot = Arc::clone(&self.robot);
        let (Some(shaping), Some(ready)) = (&robot.shaping, &mut self.shaping) else { return Ok(()) };
        ready.run(&shaping.formula, &self.values);
        let same = |a: &[f64], b: &[f64]| a.iter().map(|x| x.to_bits()).eq(b.iter().map(|x| x.to_bits()));
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
        (self.taken, self.success, self.kind) = (0, false, 0);
        self.effort.fill(0.0);
        self.command.fill(0.0);
        self.terms.fill(0.0);
        self.fill_own();
        self.draw_episode();
        self.shape()?;
        self.place()?;
        let robot = Arc::clone(&self.robot);
        let mut delays = [0; 2];
        if let (Some(formula), Some(ready)) = (&robot.delays, &mut self.delays) {
            ready.run(formula, &self.values);
            for (steps, &time) in delays.iter_mut().zip(&ready.out) {
                *steps = (time.max(0.0) / self.spec.time_step).round().min(1000.0) as usize;
            }
        }
        self.seen.begin(delays[0]);
        self.told.begin(delays[1]);
        self.body.read(&mut self.values);
        for _ in 0..MEMORY_PASSES.min(robot.outputs.memory * MEMORY_PASSES) {
            self.step.run(&robot.step, &self.values);
            self.remember();
        }
        self.evaluate();
        let kinds = robot.outputs.kinds_at();
        self.kind = self.step.out[kinds].iter().position(|&holds| holds != 0.0).unwrap_or(robot.outputs.kinds);
        self.remember();
        Ok(())
    }

    /// Observation, reward and ends of the state at hand.
    fn evaluate(&mut self) {
        let robot = Arc::clone(&self.robot);
        self.draw(&robot.step.draws);
        self.step.run(&robot.step, &self.values);
        self.seen.pass(&mut self.step.out[..robot.outputs.observations]);
        for (state, &at) in self.state.iter_mut().zip(&robot.states) {
            *state = self.values[at];
        }
    }

    /// Keeps what the next step calls the step before.
    fn remember(&mut self) {
        let from = self.step.out.len() - self.robot.outputs.memory;
        for (&column, &value) in self.robot.memory.iter().zip(&self.step.out[from..]) {
            self.values[column] = value;
        }
    }

    /// Applies forces, controls and efforts, and lets time pass.
    fn advance(&mut self) -> Result<(), String> {
        let robot = Arc::clone(&self.robot);
        if let (Some((formula, bodies)), true) = (&robot.forces, self.forces.is_some()) {
            self.draw(&formula.draws);
            if let Some(ready) = &mut self.forces {
                ready.run(formula, &self.values);
                self.body.push(bodies, &ready.out);
            }
        }
        for (command, actuator) in self.command.iter().zip(&robot.direct) {
            if let Some(actuator) = actuator {
                self.body.control(*actuator, *command);
            }
        }
        if self.own_law {
            return self.advance_with_law(&robot);
        }
        let tendons = robot.targets.iter().any(|target| matches!(target, Target::Tendon(_)));
        if !tendons {
            self.body.apply(&robot.targets, &self.effort);
            return self.body.step(robot.frame_skip);
        }
        // A tension is held, and the arms at which it pulls change on the way.
        for _ in 0..robot.frame_skip {
            self.body.apply(&robot.targets, &self.effort);
            self.body.step(1)?;
        }
        Ok(())
    }

    /// The law at the rate of the physics: what holding it for a step hides is seen so.
    fn advance_with_law(&mut self, robot: &Robot) -> Result<(), String> {
        let derived = robot.states.iter().any(|&at| matches!(robot.columns[at], Column::Engine(r) if r.is_derived()));
        for _ in 0..robot.frame_skip {
            self.body.refresh(derived)?;
            self.body.read(&mut self.values);
            for (state, &at) in self.state.iter_mut().zip(&robot.states) {
                *state = self.values[at];
            }
            robot.law.effort(&self.design, &self.command, &self.state, &mut self.effort);
            self.body.apply(&robot.targets, &self.effort);
            self.body.step(1)?;
        }
        Ok(())
    }
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
        self.evaluate();
        self.remember();
        let outputs = self.robot.outputs;
        let terms = &self.step.out[outputs.terms_at()];
        let mut reward = 0.0;
        for (sum, &term) in self.terms.iter_mut().zip(terms) {
            *sum += term;
            reward += term;
        }
        let holds = |at: Option<usize>| at.is_some_and(|at| self.step.out[at] != 0.0);
        self.success = holds(outputs.success_at());
        let end = if holds(outputs.ends_at()) {
            Some(End::Terminated)
        } else if self.taken >= self.spec.horizon {
            Some(End::Truncated)
        } else {
            None
        };
        Step { reward, end }
    }

    fn outcome(&self) -> Option<Outcome> {
        let kind = Arc::clone(&self.robot.kinds[self.kind]);
        self.robot.outputs.success.then_some(Outcome { kind, success: self.success })
    }

    fn fault(&self) -> Option<String> {
        self.fault.clone()
    }
}

impl ModelEnvironment {
    /// Effort and command as the motors get them.
    fn delay_told(&mut self) {
        if self.told.steps == 0 {
            return;
        }
        let efforts = self.effort.len();
        let mut both: Vec<f64> = self.effort.iter().chain(&self.command).copied().collect();
        self.told.pass(&mut both);
        self.effort.copy_from_slice(&both[..efforts]);
        self.command.copy_from_slice(&both[efforts..]);
    }
}
