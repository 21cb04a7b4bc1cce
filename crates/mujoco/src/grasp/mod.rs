//! Grasping with the underactuated hand (paper, section 6 and appendix B): from above, wind, lift, hold.
//!
//! # Observation
//! | port | unit | |
//! |---|---|---|
//! | `palm_x`, `palm_y`, `palm_z` | m | noisy |
//! | `object_x`, `object_y`, `object_z` | m | its centre, noisy; relative to the palm where [`Viewpoint`] says so |
//! | `size_x`, `size_y`, `size_z` | m | its bounding box as it lies at the start |
//! | `motor_travel` | m | tendon wound, as commanded, noisy |
//! | `motor_torque` | N·m | of the last step |
//!
//! # Command
//! | port | unit | range |
//! |---|---|---|
//! | `palm_z`, or `palm_x`, `palm_y`, `palm_z` | m per step | ±2 mm |
//! | `motor` | m per step | ±0.2 mm |
//!
//! # State, effort and design
//! Those of the hand's law, [`TendonHand`]: motor travel and joint angles; joint torques and the motor's torque; twelve
//! parameters of the transmission. The controller never sees the joint angles: the real hand has no sensors for them.
//!
//! # Reward
//! -2·|palm - object|/m + 0.1·(distal links touching) + 0, 0.5, 1, 2 or 4 by the height of the object's lowest point.
//!
//! # Success
//! Over the last 100 steps the object stays 100 mm above the floor and within 10 mm of where it was in the hand, and thumb
//! and a finger touch it in at least 90 of them.
//!
//! # End
//! Truncated after 500 steps of 10 ms. An episode whose physics fail is discarded.

mod carried_hand;
mod film;
mod hold;
mod object;
mod plant;
mod problem;
mod script;
mod settings;
mod task;

use std::sync::Arc;

use hwasp_core::{Environment, Law, MakeEnvironment, Robot};
use thiserror::Error;

pub use carried_hand::CarriedHand;
pub use film::{Film, Filmed, Stage, Still};
pub use hold::Hold;
pub use object::Object;
pub use plant::{GraspPlant, yielding};
pub use problem::{engine, settings_of};
pub use script::Script;
pub use settings::{GraspReward, GraspSettings, Inertia, Ramp, ShapeKind, Viewpoint};
pub use task::{GraspTask, HOLD_DRIFT, HOLD_HEIGHT, HOLD_STEPS, HOLD_TOUCH};

use crate::engine::{BuildError, Simulation, UnknownName};
use hwasp_tasks::hand::{self, DESIGN_LEN, HandError, MjcfOptions, TendonHand, TendonHandSettings, mjcf, names};

/// Why settings make no grasping task.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum GraspError {
    /// The hand cannot be.
    #[error(transparent)]
    Hand(#[from] HandError),
    /// A range that is none, or beyond what there can be.
    #[error("{name} = {value} is not {limits}")]
    Setting {
        /// The field.
        name: &'static str,
        /// What was given.
        value: String,
        /// What can be.
        limits: &'static str,
    },
    /// The engine does not take the model.
    #[error(transparent)]
    Build(#[from] BuildError),
    /// Model and code do not fit.
    #[error(transparent)]
    Name(#[from] UnknownName),
}

/// A grasping task, ready to make environments: each has a copy of the compiled model.
#[derive(Clone, Debug)]
pub struct Grasp {
    settings: GraspSettings,
    law: Law,
    /// Compiled once.
    plant: GraspPlant,
}

impl Grasp {
    /// The plant in which one learns: the law's torques act on independent joints.
    pub fn new(settings: GraspSettings) -> Result<Self, GraspError> {
        let model = mjcf(&settings.hand, &MjcfOptions::default())?;
        Self::build(settings, &model, |_| Ok(plant::Drive::Torques))
    }

    /// The same task on the hand with MuJoCo's own tendons, springs and pulleys of `design`, at the simulation's rate, in
    /// which the law has no say: what a controller has to master as it would the built hand.
    pub fn native(settings: GraspSettings, design: &[f64; DESIGN_LEN]) -> Result<Self, GraspError> {
        let drive = hand::Drive::NativeTendon { design: *design };
        let model = mjcf(&settings.hand, &MjcfOptions { drive, ..MjcfOptions::default() })?;
        Self::native_from(settings, &model)
    }

    /// The same, of a model that was written to a file: the text of [`mjcf`] with native tendons, or one with the same names.
    pub fn native_from(settings: GraspSettings, model: &str) -> Result<Self, GraspError> {
        let [a, b, c] = names::TENDONS;
        Self::build(settings, model, |sim| Ok(plant::Drive::Tendons([sim.tendon(a)?, sim.tendon(b)?, sim.tendon(c)?])))
    }

    fn build(
        settings: GraspSettings,
        model: &str,
        drive: impl FnOnce(&Simulation) -> Result<plant::Drive, UnknownName>,
    ) -> Result<Self, GraspError> {
        settings.check()?;
        let law = TendonHandSettings { palm: settings.palm, range: settings.range, initial: settings.initial };
        let law = Law::new(TendonHand::new(&settings.hand.transmission, &law)?);
        let sim = Simulation::from_mjcf(model)?;
        let drive = drive(&sim)?;
        let plant = GraspPlant::new(&settings, sim, drive)?;
        Ok(Self { settings, law, plant })
    }

    /// What it was made of.
    pub fn settings(&self) -> &GraspSettings {
        &self.settings
    }

    /// The mechanism.
    pub fn law(&self) -> Law {
        self.law.clone()
    }

    /// An environment whose plant can be looked at; `horizon` replaces the task's own.
    pub fn robot(&self, horizon: Option<usize>) -> Robot<GraspTask> {
        Robot::new(self.plant.clone(), GraspTask::new(self.settings.clone()), horizon)
    }

    /// To share between threads.
    pub fn shared(self) -> Arc<dyn MakeEnvironment> {
        Arc::new(self)
    }
}

impl MakeEnvironment for Grasp {
    fn make(&self, horizon: Option<usize>) -> Box<dyn Environment> {
        Box::new(self.robot(horizon))
    }
}
