//! The pendulum that has to be swung up: the classic problem, `Pendulum-v1` of Gymnasium, with a gear behind its motor.
//!
//! ```text
//!              │ θ = 0: upright
//!            ● │
//!             \│  θ > 0 counter-clockwise
//!        ──────⊙──────  torque = gear·command
//!              ┆
//!              ┆ θ = ±π: hanging
//! ```
//!
//! A uniform rod of m = 1 kg and l = 1 m turns about one end, g = 10 m/s². The motor is too weak to lift it in one go: at
//! the gear of 1 it gives 2 N·m, and the rod's weight asks for 5 N·m. It has to swing.
//!
//! With the gear at 1 the dynamics, the reward and the starts are those of Gymnasium 1.x (`pendulum.py`; the equations are
//! in its documentation): θ'' = 3g/(2l)·sin θ + 3/(m·l²)·torque, the speed first, limited to ±8 rad/s, then the angle with
//! the new speed. The classic motor has no speed at which it stalls, so that a larger gear costs nothing but the price of
//! its torque; which gear is best is not known.
//!
//! # Observation
//! | port | unit | range |
//! |---|---|---|
//! | `cos` | 1 | [-1, 1] |
//! | `sin` | 1 | [-1, 1] |
//! | `speed` | rad/s | [-8, 8] |
//!
//! # Command
//! | port | unit | range |
//! |---|---|---|
//! | `motor` | N·m | [-2, 2] |
//!
//! # State and effort, at the interface to the law
//! | state | effort |
//! |---|---|
//! | `angle`, rad, not wrapped; `speed`, rad/s | `torque`, N·m, on the rod; the plant takes ±4, what the largest gear gives |
//!
//! # Design
//! | group | unit | range | optimum |
//! |---|---|---|---|
//! | `gear` | 1 | [0.5, 2] | not known; 1 is the classic problem |
//!
//! # Reward
//! -(θ² + 0.1·θ'² + 0.001·torque²) with θ in [-π, π) and θ' from before the step, and the torque as the plant takes it.
//!
//! # Start
//! θ uniform in [-π, π) rad, θ' uniform in [-1, 1) rad/s.
//!
//! # End
//! Truncated after 200 steps of 0.05 s. Never terminated.

mod look;
mod problem;

use std::f64::consts::PI;

use hwasp_core::{
    CommandPort, DesignError, DesignGroup, DesignSpace, Dimension, EnvSpec, Environment, Hardware, Initial, Law,
    MakeEnvironment, Plant, Port, Ports, Robot, Sight, Stream, Task,
};
use hwasp_diff::Scalar;
use rand::RngExt;
use thiserror::Error;

pub use problem::PendulumProblem;

/// Gravity, m/s².
pub const GRAVITY: f64 = 10.0;
/// Mass of the rod, kg.
pub const MASS: f64 = 1.0;
/// Length of the rod, m.
pub const LENGTH: f64 = 1.0;
/// Length of an action, s.
pub const TIME_STEP: f64 = 0.05;
/// The motor's limit of either sign, N·m.
pub const MOTOR_LIMIT: f64 = 2.0;
/// The rod's highest speed of either sign, rad/s.
pub const MAX_SPEED: f64 = 8.0;
/// The largest torque of either sign that the plant takes, N·m: what the motor gives through the largest gear. A law in
/// the policy may ask for more, as its efforts are noisy in training.
pub const MAX_TORQUE: f64 = MOTOR_LIMIT * Transmission::MAX;

/// What of the problem can be chosen; the rest is the classic problem.
///
/// | field | default | purpose | must be |
/// |---|---|---|---|
/// | `horizon` | 200 | actions per episode | ≥ 1 |
/// | `initial` | 1 | where the gear begins | inside (0.5, 2) |
#[derive(Clone, Debug, PartialEq)]
pub struct PendulumSettings {
    /// Actions per episode.
    pub horizon: usize,
    /// Where the gear begins.
    pub initial: Initial,
}

impl Default for PendulumSettings {
    fn default() -> Self {
        Self { horizon: 200, initial: Initial::Value(Transmission::CLASSIC) }
    }
}

/// Why settings do not describe a pendulum.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum PendulumError {
    /// No step at all.
    #[error("horizon = 0, but at least 1 is needed")]
    Horizon,
    /// A start of the gear that its limits do not allow.
    #[error(transparent)]
    Design(#[from] DesignError),
}

/// The gear between motor and rod: torque = gear·command.
#[derive(Clone, Debug)]
pub struct Transmission {
    design: DesignSpace,
}

impl Transmission {
    /// Smallest gear.
    pub const MIN: f64 = 0.5;
    /// Largest gear.
    pub const MAX: f64 = 2.0;
    /// The gear of the classic problem: motor and rod are one.
    pub const CLASSIC: f64 = 1.0;

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

impl Hardware for Transmission {
    fn design(&self) -> &DesignSpace {
        &self.design
    }

    fn ports(&self) -> Ports {
        Ports {
            command: vec!["motor".into()],
            state: vec!["angle".into(), "speed".into()],
            effort: vec!["torque".into()],
        }
    }

    fn effort<T: Scalar>(&self, design: &[T], command: &[T], _state: &[T], effort: &mut [T]) {
        effort[0] = design[0] * command[0];
    }
}

/// A rod that turns about one end, and what its last step cost.
#[derive(Clone, Debug, Default)]
pub struct Rod {
    angle: f64,
    speed: f64,
    cost: f64,
}

impl Rod {
    /// Puts it at `angle`, rad from upright, turning at `speed`, rad/s.
    pub fn place(&mut self, angle: f64, speed: f64) {
        *self = Self { angle, speed, cost: 0.0 };
    }

    /// Angle from upright, rad, not wrapped, and speed, rad/s.
    #[inline]
    pub fn at(&self) -> (f64, f64) {
        (self.angle, self.speed)
    }
}

/// An angle in [-π, π).
fn wrapped(angle: f64) -> f64 {
    (angle + PI).rem_euclid(2.0 * PI) - PI
}

impl Plant for Rod {
    /// The terms stand in the order in which Gymnasium adds them: the numbers shall be the same to the last bit.
    #[inline]
    fn advance(&mut self, effort: &[f64], _command: &[f64]) {
        let torque = effort[0].clamp(-MAX_TORQUE, MAX_TORQUE);
        let (away, speed) = (wrapped(self.angle), self.speed);
        self.cost = away * away + 0.1 * (speed * speed) + 0.001 * (torque * torque);
        let acceleration = 3.0 * GRAVITY / (2.0 * LENGTH) * self.angle.sin() + 3.0 / (MASS * LENGTH * LENGTH) * torque;
        self.speed = (speed + acceleration * TIME_STEP).clamp(-MAX_SPEED, MAX_SPEED);
        self.angle += self.speed * TIME_STEP;
    }

    /// Angle (rad, not wrapped), speed (rad/s).
    #[inline]
    fn state(&self, out: &mut [f64]) {
        out.copy_from_slice(&[self.angle, self.speed]);
    }
}

/// Be upright and at rest; see the [module](self).
#[derive(Clone, Debug)]
pub struct SwingUp {
    horizon: usize,
    /// What is built, to be looked at.
    gear: f64,
}

impl Task for SwingUp {
    type Plant = Rod;

    fn spec(&self) -> EnvSpec {
        let port = |name: &str, dimension| Port { name: name.to_owned(), dimension };
        EnvSpec {
            observation: vec![
                port("cos", Dimension::None),
                port("sin", Dimension::None),
                port("speed", Dimension::AngularSpeed),
            ],
            state: vec![port("angle", Dimension::Angle), port("speed", Dimension::AngularSpeed)],
            context: vec![],
            effort: vec![port("torque", Dimension::Torque)],
            command: vec![CommandPort {
                name: "motor".to_owned(),
                dimension: Dimension::Torque,
                lo: -MOTOR_LIMIT,
                hi: MOTOR_LIMIT,
                direct: true,
            }],
            horizon: self.horizon,
            time_step: TIME_STEP,
            shaped_by: vec![],
            terms: vec![],
        }
    }

    fn set_design(&mut self, design: &[f64]) {
        self.gear = design.first().copied().unwrap_or(self.gear);
    }

    fn reset(&mut self, rod: &mut Rod, rng: &mut Stream) {
        let mut within = |limit: f64| (rng.random::<f64>() * 2.0 - 1.0) * limit;
        let (angle, speed) = (within(PI), within(1.0));
        rod.place(angle, speed);
    }

    #[inline]
    fn observe(&self, rod: &Rod, out: &mut [f64]) {
        out.copy_from_slice(&[rod.angle.cos(), rod.angle.sin(), rod.speed]);
    }

    /// What the classic problem pays for the state that the step began in and for the torque during it.
    #[inline]
    fn reward(&mut self, rod: &Rod, _command: &[f64]) -> f64 {
        -rod.cost
    }

    fn look(&mut self, rod: &Rod) -> Option<Sight> {
        Some(look::sight(rod.angle, self.gear))
    }
}

/// A checked pendulum: a law, and the environments that go with it.
#[derive(Clone, Debug)]
pub struct Pendulum {
    horizon: usize,
    law: Law,
}

impl Pendulum {
    /// The problem that the settings describe.
    pub fn new(settings: &PendulumSettings) -> Result<Self, PendulumError> {
        if settings.horizon == 0 {
            return Err(PendulumError::Horizon);
        }
        Ok(Self { horizon: settings.horizon, law: Law::new(Transmission::new(settings.initial)?) })
    }

    /// The mechanism.
    pub fn law(&self) -> Law {
        self.law.clone()
    }

    /// An environment whose plant can be looked at; `horizon` replaces the task's own.
    pub fn robot(&self, horizon: Option<usize>) -> Robot<SwingUp> {
        Robot::new(Rod::default(), SwingUp { horizon: self.horizon, gear: Transmission::CLASSIC }, horizon)
    }
}

impl MakeEnvironment for Pendulum {
    fn make(&self, horizon: Option<usize>) -> Box<dyn Environment> {
        Box::new(self.robot(horizon))
    }
}
