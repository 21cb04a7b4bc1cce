//! Environments: a plant (physics) with a task (purpose).

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use crate::sight::Sight;
use crate::streams::Stream;
use crate::units::Dimension;

/// How an episode ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum End {
    /// In a state of no future: its value is zero.
    Terminated,
    /// Out of time; the future went on, so its value is estimated.
    Truncated,
    /// The physics failed ([`Environment::fault`] says how): the episode is worth nothing and is thrown away.
    Faulted,
}

/// Whether an episode did what the task is about, for tasks that can be failed.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Outcome {
    /// What kind of episode it was, the object's shape for one: success is told for each kind. A task keeps the names that
    /// it gives, so that telling one copies no text.
    #[serde(with = "shared_text")]
    pub kind: Arc<str>,
    /// Whether it succeeded.
    pub success: bool,
}

/// A shared text, for serde: whoever reads it has one of its own.
pub(crate) mod shared_text {
    use std::sync::Arc;

    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    pub(super) fn serialize<S: Serializer>(text: &Arc<str>, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(text)
    }

    pub(super) fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Arc<str>, D::Error> {
        String::deserialize(deserializer).map(Arc::from)
    }

    /// The same of one that need not be there.
    pub(crate) mod option {
        use super::{Arc, Deserialize, Deserializer, Serialize, Serializer};

        #[allow(clippy::ref_option)] // as serde calls it
        pub(crate) fn serialize<S: Serializer>(text: &Option<Arc<str>>, serializer: S) -> Result<S::Ok, S::Error> {
            text.as_deref().serialize(serializer)
        }

        pub(crate) fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<Arc<str>>, D::Error> {
            Ok(Option::<String>::deserialize(deserializer)?.map(Arc::from))
        }
    }
}

/// What one step gave.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step {
    /// The reward of the step.
    pub reward: f64,
    /// Whether and how the episode ended with it.
    pub end: Option<End>,
}

/// A named quantity.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Port {
    /// Its name, as laws and plots use it.
    pub name: String,
    /// What it measures, in the SI unit of it.
    pub dimension: Dimension,
}

/// A motor: a command with limits.
#[derive(Clone, Debug, PartialEq)]
pub struct CommandPort {
    /// Its name.
    pub name: String,
    /// What it measures.
    pub dimension: Dimension,
    /// The least the motor takes.
    pub lo: f64,
    /// The most it takes.
    pub hi: f64,
    /// Whether plant or task read the command themselves. Where only the law does (`false`), a policy that samples the law's
    /// effort does not sample the command as well.
    pub direct: bool,
}

/// The most terms of a reward that are told apart: each has a column in learning curves.
pub const MOST_TERMS: usize = 32;

/// What an environment is from outside.
#[derive(Clone, Debug, PartialEq)]
pub struct EnvSpec {
    /// What the controller sees.
    pub observation: Vec<Port>,
    /// What only the law sees: the plant's state at the interface.
    pub state: Vec<Port>,
    /// What an episode is about and no sensor tells, such as the mass of an object: for baselines alone.
    pub context: Vec<Port>,
    /// What the mechanism gives the plant.
    pub effort: Vec<Port>,
    /// The motors.
    pub command: Vec<CommandPort>,
    /// Environment steps of an episode, if nothing ends it before.
    pub horizon: usize,
    /// The time that a step takes, s: the controller acts once in it.
    pub time_step: f64,
    /// The groups of design parameters that the world's model is made from ([`Environment::set_design`]); none for most
    /// worlds, which meet the design only through the law. Such parameters stay as they are during an episode.
    pub shaped_by: Vec<String>,
    /// The names of the terms that a reward is the sum of, as [`Environment::terms`] has them, at most [`MOST_TERMS`];
    /// none where it is one number.
    pub terms: Vec<String>,
}

/// Physics, without purpose: what the robot and the world do under an effort.
pub trait Plant: Send {
    /// Told the design (SI, as [`Environment::set_design`] has it) before each start, for physics that depend on it. What
    /// cannot be made of it is a [`fault`](Self::fault) after the next step.
    fn set_design(&mut self, _design: &[f64]) {}

    /// One control step under `effort` (from the law) and `command` (clipped to the motors' limits), both held.
    fn advance(&mut self, effort: &[f64], command: &[f64]);

    /// Writes the privileged state that laws read.
    fn state(&self, out: &mut [f64]);

    /// What went wrong in the last step, where the numbers gave out.
    fn fault(&self) -> Option<String> {
        None
    }
}

/// Purpose: where an episode starts, what is seen of the plant, and what it is worth.
pub trait Task: Send {
    /// The physics it is a task for.
    type Plant: Plant;

    /// Names, units, limits and time step. The horizon in it is the task's own.
    fn spec(&self) -> EnvSpec;

    /// Told before each start how much of training is done, in [0, 1], for tasks that begin easier; 1 in evaluations.
    fn set_progress(&mut self, _progress: f64) {}

    /// Told the design (SI, as [`Environment::set_design`] has it) before each start, after the plant.
    fn set_design(&mut self, _design: &[f64]) {}

    /// Puts the plant into a start state drawn from `rng`.
    fn reset(&mut self, plant: &mut Self::Plant, rng: &mut Stream);

    /// Writes what the controller sees, in SI.
    fn observe(&self, plant: &Self::Plant, out: &mut [f64]);

    /// Writes what the episode is about and no sensor tells, in SI; called once, after the start.
    fn context(&self, _plant: &Self::Plant, _out: &mut [f64]) {}

    /// The reward of having arrived at this state under `command`; called once a step, so that a task may keep count.
    fn reward(&mut self, plant: &Self::Plant, command: &[f64]) -> f64;

    /// What each named term of the reward came to so far in the episode.
    fn terms(&self) -> &[f64] {
        &[]
    }

    /// Whether this state has no future; asked after [`reward`](Self::reward), so that what it has counted is known.
    fn terminated(&self, _plant: &Self::Plant) -> bool {
        false
    }

    /// The name of what [`terminated`](Self::terminated) the episode, for tasks with several ways to end.
    fn ended_by(&self) -> Option<Arc<str>> {
        None
    }

    /// Whether the episode so far is a success, for tasks that know.
    fn outcome(&self) -> Option<Outcome> {
        None
    }

    /// What is to be seen now, for films; none where nobody has said how it looks.
    fn look(&mut self, _plant: &Self::Plant) -> Option<Sight> {
        None
    }
}

/// What a rollout drives. Efforts come from a law, commands from a controller; the environment knows neither.
pub trait Environment: Send {
    /// Names, units, limits, horizon and time step.
    fn spec(&self) -> &EnvSpec;

    /// Told before each start how much of training is done, in [0, 1], for tasks that begin easier; 1 in evaluations.
    fn set_progress(&mut self, _progress: f64) {}

    /// Told before each start the whole design, SI, for worlds whose model depends on it ([`EnvSpec::shaped_by`]): what was
    /// drawn for the episode, within its limits; the policy's own values for what is not; and what was built, which errors of
    /// the workshop may have put outside of the limits.
    fn set_design(&mut self, _design: &[f64]) {}

    /// Starts an episode.
    fn reset(&mut self, rng: &mut Stream);

    /// Writes what the controller sees, in SI.
    fn observe(&self, out: &mut [f64]);

    /// Writes what only the law sees, in SI.
    fn state(&self, out: &mut [f64]);

    /// Writes what the episode is about and no sensor tells, in SI.
    fn context(&self, _out: &mut [f64]) {}

    /// Told what the next step will be, before any environment that goes in lock step with it is stepped: for those that are
    /// computed together. Nobody has to tell it.
    fn announce(&mut self, _effort: &[f64], _command: &[f64]) {}

    /// One control step. Commands are limited to their ports' ranges by the environment itself.
    fn step(&mut self, effort: &[f64], command: &[f64]) -> Step;

    /// What each named term of the reward came to so far in the episode ([`EnvSpec::terms`]): their sum is the return.
    fn terms(&self) -> &[f64] {
        &[]
    }

    /// The name of what ended the episode, after a step that [terminated](End::Terminated) it; none where nobody named it.
    fn ended_by(&self) -> Option<Arc<str>> {
        None
    }

    /// Whether the episode so far is a success, for tasks that know.
    fn outcome(&self) -> Option<Outcome> {
        None
    }

    /// What is to be seen now, for films; none where nobody has said how it looks. The episode goes on with the same bits.
    fn look(&mut self) -> Option<Sight> {
        None
    }

    /// What went wrong, after a step that [faulted](End::Faulted).
    fn fault(&self) -> Option<String> {
        None
    }
}

/// A plant with a task: the one environment there is.
#[derive(Clone, Debug)]
pub struct Robot<T: Task> {
    plant: T::Plant,
    task: T,
    spec: EnvSpec,
    /// Steps taken in this episode.
    taken: usize,
    /// The command within its limits, kept to spare an allocation per step.
    limited: Vec<f64>,
}

impl<T: Task> Robot<T> {
    /// Puts them together. `horizon` replaces the task's own where training episodes should be shorter.
    pub fn new(plant: T::Plant, task: T, horizon: Option<usize>) -> Self {
        let mut spec = task.spec();
        spec.horizon = horizon.unwrap_or(spec.horizon);
        let limited = vec![0.0; spec.command.len()];
        Self { plant, task, spec, taken: 0, limited }
    }

    /// The physics, to look at.
    pub fn plant(&self) -> &T::Plant {
        &self.plant
    }

    /// The physics, to set up a state of one's own.
    pub fn plant_mut(&mut self) -> &mut T::Plant {
        &mut self.plant
    }
}

impl<T: Task> Environment for Robot<T> {
    fn spec(&self) -> &EnvSpec {
        &self.spec
    }

    fn set_progress(&mut self, progress: f64) {
        self.task.set_progress(progress);
    }

    fn set_design(&mut self, design: &[f64]) {
        self.plant.set_design(design);
        self.task.set_design(design);
    }

    fn reset(&mut self, rng: &mut Stream) {
        self.taken = 0;
        self.task.reset(&mut self.plant, rng);
    }

    fn observe(&self, out: &mut [f64]) {
        self.task.observe(&self.plant, out);
    }

    fn state(&self, out: &mut [f64]) {
        self.plant.state(out);
    }

    fn context(&self, out: &mut [f64]) {
        self.task.context(&self.plant, out);
    }

    fn step(&mut self, effort: &[f64], command: &[f64]) -> Step {
        for ((limited, &command), port) in self.limited.iter_mut().zip(command).zip(&self.spec.command) {
            *limited = command.clamp(port.lo, port.hi);
        }
        self.plant.advance(effort, &self.limited);
        self.taken += 1;
        if self.plant.fault().is_some() {
            return Step { reward: 0.0, end: Some(End::Faulted) };
        }
        let reward = self.task.reward(&self.plant, &self.limited);
        let end = if self.task.terminated(&self.plant) {
            Some(End::Terminated)
        } else if self.taken >= self.spec.horizon {
            Some(End::Truncated)
        } else {
            None
        };
        Step { reward, end }
    }

    fn terms(&self) -> &[f64] {
        self.task.terms()
    }

    fn ended_by(&self) -> Option<Arc<str>> {
        self.task.ended_by()
    }

    fn outcome(&self) -> Option<Outcome> {
        self.task.outcome()
    }

    fn look(&mut self) -> Option<Sight> {
        self.task.look(&self.plant)
    }

    fn fault(&self) -> Option<String> {
        self.plant.fault()
    }
}

/// Makes environments of one kind, for as many threads as there are.
pub trait MakeEnvironment: Send + Sync {
    /// A fresh one; `horizon` replaces the task's own.
    fn make(&self, horizon: Option<usize>) -> Box<dyn Environment>;

    /// So many that will go in lock step, on one thread at a time.
    fn make_many(&self, count: usize, horizon: Option<usize>) -> Vec<Box<dyn Environment>> {
        (0..count).map(|_| self.make(horizon)).collect()
    }
}

impl<F: Fn(Option<usize>) -> Box<dyn Environment> + Send + Sync> MakeEnvironment for F {
    fn make(&self, horizon: Option<usize>) -> Box<dyn Environment> {
        self(horizon)
    }
}
