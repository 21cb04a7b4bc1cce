//! The paper's mass-spring problem (section 5 and appendix A): two masses under springs, pulled by a motor.
//!
//! ```text
//!   ─────┬──────────── ceiling, y = 0; positions and forces are positive downwards
//!        ⌇  n springs in parallel, total stiffness K, no natural length
//!      ┌─┴─┐
//!      │m1 │ y1
//!      └─┬─┘
//!        │  bar of length l, n segments
//!      ┌─┴─┐
//!      │m2 │ y2
//!      └─┬─┘
//!   ─ ─ ─│─ ─ ─ ─ ─ ─ goal, y2 = h
//!        ↓  motor, f
//! ```
//!
//! Either the springs are the design ([`Springs`]), or the bar is ([`RigidBar`], and [`SoftBar`] where it has to be
//! differentiated through).
//!
//! # Observation
//! | port | unit | range |
//! |---|---|---|
//! | `y1` | m | [0, 0.5] |
//! | `v1` | m/s | [-2, 2] |
//!
//! # Command
//! | port | unit | range |
//! |---|---|---|
//! | `motor` | N | [-5, 5] |
//!
//! # State and effort, at the interface to the law
//! | | state | effort |
//! |---|---|---|
//! | stiffness | `y1`, `v1`, `y2`, `v2` | `effort`, N: motor less springs, on both masses |
//! | bar, soft | the same | `interface1`, `interface2`, N: on each mass |
//! | bar, rigid | the same | `length`, m |
//!
//! # Reward
//! See [`Reward`]: the nearer and slower the lower mass, and, once it is there, the weaker the motor, the better. At rest
//! at the goal it is -2.689 a step with springs and -0.180 with the bar: the soft switch is never quite off.
//!
//! # Start
//! y1 uniform in [0, 0.5] m, v1 = v2 uniform in [-2, 2] m/s. The lower mass is l below where l is fixed, else half the
//! longest segment below (the authors' guess).
//!
//! # End
//! Truncated after 1000 actions of 10 ms. Never terminated.
//!
//! # Example
//! ```
//! use hwasp_core::{Environment, MakeEnvironment, Purpose, stream};
//! use hwasp_tasks::mass_spring::{MassSpring, MassSpringSettings};
//!
//! let problem = MassSpring::stiffness(MassSpringSettings { count: 50, ..Default::default() })?;
//! let (law, mut env) = (problem.law(), problem.make(None));
//! env.reset(&mut stream(0, Purpose::TrainingReset, 0, 0));
//!
//! let (design, command) = ([problem.optimum() / 50.0; 50], [0.5]); // N/m each, N
//! let (mut state, mut effort) = ([0.0; 4], [0.0]);
//! env.state(&mut state);
//! law.effort(&design, &command, &state, &mut effort);
//! let step = env.step(&effort, &command);
//! assert!(step.reward < 0.0 && step.end.is_none());
//! # Ok::<(), hwasp_tasks::mass_spring::MassSpringError>(())
//! ```

mod bar;
mod look;
mod plant;
mod ports;
mod problem;
mod reward;
mod settings;
mod springs;
mod task;

use hwasp_core::{Environment, Law, MakeEnvironment, Robot};

pub use bar::{RigidBar, SoftBar};
pub use plant::{Coupling, MassSpringPlant};
pub use problem::{BarLength, BarLengthTask, InterfaceKind, MassSpringBase, RewardKind, Stiffness, StiffnessTask};
pub use reward::{Reward, Switch};
pub use settings::{MassSpringError, MassSpringSettings};
pub use springs::Springs;
pub use task::MassSpringTask;

/// How the bar acts on the masses.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Interface {
    /// By the forces of a softened interface: for a design in the policy.
    Soft,
    /// By its length: for a design in the environment, and for what is built.
    Rigid,
}

/// A checked mass-spring problem: a law, and the environments that go with it.
#[derive(Clone, Debug)]
pub struct MassSpring {
    coupling: Coupling,
    law: Law,
    settings: MassSpringSettings,
}

impl MassSpring {
    /// The springs are the design.
    pub fn stiffness(settings: MassSpringSettings) -> Result<Self, MassSpringError> {
        let law = Law::new(Springs::new(&settings)?);
        Ok(Self { coupling: Coupling::FixedBar(settings.bar_length), law, settings })
    }

    /// The bar is the design.
    pub fn bar(settings: MassSpringSettings, interface: Interface) -> Result<Self, MassSpringError> {
        let (law, coupling) = match interface {
            Interface::Soft => (Law::new(SoftBar::new(&settings)?), Coupling::Free),
            Interface::Rigid => (Law::new(RigidBar::new(&settings)?), Coupling::GivenBar),
        };
        Ok(Self { coupling, law, settings })
    }

    /// The mechanism.
    pub fn law(&self) -> Law {
        self.law.clone()
    }

    /// The numbers it was made from.
    pub fn settings(&self) -> &MassSpringSettings {
        &self.settings
    }

    /// What joins the masses.
    pub fn coupling(&self) -> Coupling {
        self.coupling
    }

    /// An environment whose plant can be looked at; `horizon` replaces the task's own.
    pub fn robot(&self, horizon: Option<usize>) -> Robot<MassSpringTask> {
        let plant = MassSpringPlant::new(&self.settings, self.coupling);
        Robot::new(plant, MassSpringTask::new(&self.settings, self.coupling), horizon)
    }

    /// The total over the design (N/m or m) that holds the lower mass at the goal with the motor off, in this plant: see
    /// [`optimal_stiffness`](MassSpringSettings::optimal_stiffness) and
    /// [`optimal_length`](MassSpringSettings::optimal_length).
    pub fn optimum(&self) -> f64 {
        match self.coupling {
            Coupling::FixedBar(_) => self.settings.optimal_stiffness(),
            Coupling::GivenBar => self.settings.optimal_length(),
            Coupling::Free => self.settings.optimal_length() - self.settings.interface_stretch(),
        }
    }
}

impl MakeEnvironment for MassSpring {
    fn make(&self, horizon: Option<usize>) -> Box<dyn Environment> {
        Box::new(self.robot(horizon))
    }
}
