//! A point on a rail that has to reach a place: the smallest robot with a design, for tests that learn in a second.
//!
//! ```text
//!    -1 m                 goal    1 m
//!     ├─────────●───────────┼──────┤
//!               x  →  v = effort
//! ```
//!
//! The motor drives the point through a gear (a drum of radius r) and loses speed under the load, which grows with r. A
//! small drum is slow for its size, a large one because the motor stalls: v = command·r·(1 - r/`r_stall`), fastest at
//! r* = `r_stall`/2 whatever the controller does. Getting there sooner is worth more, so r* is also the best design, as
//! long as the controller uses the whole command; the weak price of the command makes it the best for all others.
//!
//! # Observation
//! | port | unit | range |
//! |---|---|---|
//! | `x` | m | [-1, 1] |
//!
//! # Command
//! | port | unit | range |
//! |---|---|---|
//! | `speed` | (turns of the motor, scaled) | [-1, 1] |
//!
//! # State and effort, at the interface to the law
//! | state | effort |
//! |---|---|
//! | `x`, m | `velocity`, m/s |
//!
//! # Design
//! | group | unit | range | optimum |
//! |---|---|---|---|
//! | `gear` | 1 | [0.1, 2] | 1 |
//!
//! # Reward
//! -(x - goal)² - 0.01·command², with the goal at 0.25 m; x after the step.
//!
//! # Start
//! x uniform in [-1, 1] m.
//!
//! # End
//! Truncated after 30 steps of 0.1 s. Never terminated.

mod look;
mod problem;

use hwasp_core::{
    CommandPort, DesignError, DesignGroup, DesignSpace, Dimension, EnvSpec, Environment, Hardware, Initial, Law,
    MakeEnvironment, Plant, Port, Ports, Robot, Sight, Stream, Task,
};
use hwasp_diff::Scalar;
use rand::RngExt;
use thiserror::Error;

pub use problem::{ReachProblem, ReachTaskSettings};

/// Where the point goes, and how costly that is.
///
/// | field | default | purpose | must be |
/// |---|---|---|---|
/// | `goal` | 0.25 m | where the point should be | in [-1, 1] |
/// | `time_step` | 0.1 s | length of an action | > 0 |
/// | `horizon` | 30 | actions per episode | ≥ 1 |
/// | `command_cost` | 0.01 | price of the squared command | ≥ 0 |
/// | `initial` | logit in ±1 | where the gear begins | |
#[derive(Clone, Debug, PartialEq)]
pub struct ReachSettings {
    /// Where the point should be, m.
    pub goal: f64,
    /// Length of an action, s.
    pub time_step: f64,
    /// Actions per episode.
    pub horizon: usize,
    /// Price of the squared command, a pure number.
    pub command_cost: f64,
    /// Where the gear begins.
    pub initial: Initial,
}

impl Default for ReachSettings {
    fn default() -> Self {
        Self {
            goal: 0.25,
            time_step: 0.1,
            horizon: 30,
            command_cost: 0.01,
            initial: Initial::Logit { half_width: 1.0 },
        }
    }
}

/// Why settings do not describe a reach problem.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum ReachError {
    /// A quantity outside of its limits.
    #[error("{name} = {value} is outside of [{lo}, {hi}]")]
    Outside {
        /// The field.
        name: &'static str,
        /// What was given.
        value: f64,
        /// The least it may be.
        lo: f64,
        /// The most it may be.
        hi: f64,
    },
    /// No step at all.
    #[error("horizon = 0, but at least 1 is needed")]
    Horizon,
    /// A start of the gear that its limits do not allow.
    #[error(transparent)]
    Design(#[from] DesignError),
}

/// The gear between motor and point; see the [module](self).
#[derive(Clone, Debug)]
pub struct Gear {
    design: DesignSpace,
}

impl Gear {
    /// Smallest gear.
    pub const MIN: f64 = 0.1;
    /// Largest gear; the motor stalls there, `r_stall`.
    pub const MAX: f64 = 2.0;
    /// The gear of the highest speed, `r_stall`/2, and so the best one.
    pub const OPTIMUM: f64 = 1.0;

    /// A gear that begins there.
    pub fn new(initial: Initial) -> Result<Self, DesignError> {
        let group = DesignGroup {
            name: "gear".into(),
            dimension: Dimension::None,
            lo: Self::MIN,
            hi: Self::MAX,
            count: 1,
            initial,
        };
        Ok(Self { design: DesignSpace::new(vec![group])? })
    }
}

impl Hardware for Gear {
    fn design(&self) -> &DesignSpace {
        &self.design
    }

    fn ports(&self) -> Ports {
        Ports { command: vec!["speed".into()], state: vec!["x".into()], effort: vec!["velocity".into()] }
    }

    fn effort<T: Scalar>(&self, design: &[T], command: &[T], _state: &[T], effort: &mut [T]) {
        let gear = design[0];
        let loaded = -(gear / Self::MAX) + 1.0;
        effort[0] = command[0] * gear * loaded;
    }
}

/// A point on a rail from -1 to 1 m that moves at the velocity it is told.
#[derive(Clone, Debug)]
pub struct Rail {
    time_step: f64,
    x: f64,
}

impl Plant for Rail {
    #[inline]
    fn advance(&mut self, effort: &[f64], _command: &[f64]) {
        self.x = (self.x + effort[0] * self.time_step).clamp(-1.0, 1.0);
    }

    #[inline]
    fn state(&self, out: &mut [f64]) {
        out[0] = self.x;
    }
}

/// Be at the goal; see the [module](self).
#[derive(Clone, Debug)]
pub struct ReachTask {
    goal: f64,
    command_cost: f64,
    horizon: usize,
    time_step: f64,
    /// What is built, to be looked at.
    gear: f64,
}

impl Task for ReachTask {
    type Plant = Rail;

    fn spec(&self) -> EnvSpec {
        let port = |name: &str, dimension| Port { name: name.to_owned(), dimension };
        EnvSpec {
            observation: vec![port("x", Dimension::Length)],
            state: vec![port("x", Dimension::Length)],
            context: vec![],
            effort: vec![port("velocity", Dimension::Speed)],
            command: vec![CommandPort {
                name: "speed".to_owned(),
                dimension: Dimension::None,
                lo: -1.0,
                hi: 1.0,
                direct: true,
            }],
            horizon: self.horizon,
            time_step: self.time_step,
            shaped_by: vec![],
            terms: vec![],
        }
    }

    fn set_design(&mut self, design: &[f64]) {
        self.gear = design.first().copied().unwrap_or(self.gear);
    }

    fn reset(&mut self, plant: &mut Rail, rng: &mut Stream) {
        plant.x = rng.random::<f64>() * 2.0 - 1.0;
    }

    #[inline]
    fn observe(&self, plant: &Rail, out: &mut [f64]) {
        out[0] = plant.x;
    }

    #[inline]
    fn reward(&mut self, plant: &Rail, command: &[f64]) -> f64 {
        let (away, command) = (plant.x - self.goal, command[0]);
        -away * away - self.command_cost * command * command
    }

    fn look(&mut self, plant: &Rail) -> Option<Sight> {
        Some(look::sight(plant.x, self.goal, self.gear))
    }
}

/// A checked reach problem: a law, and the environments that go with it.
#[derive(Clone, Debug)]
pub struct Reach {
    settings: ReachSettings,
    law: Law,
}

impl Reach {
    /// The problem that the settings describe.
    pub fn new(settings: ReachSettings) -> Result<Self, ReachError> {
        let limits = [
            ("goal", settings.goal, -1.0, 1.0),
            ("time_step", settings.time_step, f64::MIN_POSITIVE, f64::MAX),
            ("command_cost", settings.command_cost, 0.0, f64::MAX),
        ];
        for (name, value, lo, hi) in limits {
            if !(lo..=hi).contains(&value) {
                return Err(ReachError::Outside { name, value, lo, hi });
            }
        }
        if settings.horizon == 0 {
            return Err(ReachError::Horizon);
        }
        let law = Law::new(Gear::new(settings.initial)?);
        Ok(Self { settings, law })
    }

    /// The mechanism.
    pub fn law(&self) -> Law {
        self.law.clone()
    }

    /// An environment whose plant can be looked at; `horizon` replaces the task's own.
    pub fn robot(&self, horizon: Option<usize>) -> Robot<ReachTask> {
        let &ReachSettings { goal, time_step, horizon: own, command_cost, .. } = &self.settings;
        let task = ReachTask { goal, command_cost, horizon: own, time_step, gear: Gear::OPTIMUM };
        Robot::new(Rail { time_step, x: 0.0 }, task, horizon)
    }

    /// The best gear.
    pub fn optimum(&self) -> f64 {
        Gear::OPTIMUM
    }
}

impl MakeEnvironment for Reach {
    fn make(&self, horizon: Option<usize>) -> Box<dyn Environment> {
        Box::new(self.robot(horizon))
    }
}
