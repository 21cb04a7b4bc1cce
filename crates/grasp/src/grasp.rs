//! The whole of a grasping task: model, law, plant and purpose.

use std::sync::Arc;

use hwasp_core::{Environment, Law, MakeEnvironment, Robot};
use hwasp_mujoco::engine::{Simulation, UnknownName};
use hwasp_tasks::hand::{self, DESIGN_LEN, MjcfOptions, TendonHand, TendonHandSettings, mjcf, names};

use crate::error::GraspError;
use crate::places::Drive;
use crate::plant::GraspPlant;
use crate::settings::GraspSettings;
use crate::task::GraspTask;

/// A grasping task, ready to make environments: each has a copy of the compiled model.
#[derive(Clone, Debug)]
pub struct Grasp {
    settings: GraspSettings,
    law: Law,
    /// Compiled once.
    pub(crate) plant: GraspPlant,
}

impl Grasp {
    /// The plant in which one learns: the law's torques act on independent joints.
    pub fn new(settings: GraspSettings) -> Result<Self, GraspError> {
        let model = mjcf(&settings.hand, &MjcfOptions::default())?;
        Self::build(settings, &model, |_| Ok(Drive::Torques))
    }

    /// The same task on the hand with MuJoCo's own tendons, springs and pulleys of `design`, at the simulation's rate, in
    /// which the law has no say: what a controller has to master as it would the built hand.
    pub fn native(settings: GraspSettings, design: &[f64; DESIGN_LEN]) -> Result<Self, GraspError> {
        let mut built = *design;
        built.copy_from_slice(&law(&settings)?.as_built(design));
        let drive = hand::Drive::NativeTendon { design: built };
        let model = mjcf(&settings.hand, &MjcfOptions { drive, ..MjcfOptions::default() })?;
        Self::native_from(settings, &model)
    }

    /// The same, of a model that was written to a file: the text of [`mjcf`] with native tendons, or one with the same names.
    pub fn native_from(settings: GraspSettings, model: &str) -> Result<Self, GraspError> {
        let [a, b, c] = names::TENDONS;
        Self::build(settings, model, |sim| Ok(Drive::Tendons([sim.tendon(a)?, sim.tendon(b)?, sim.tendon(c)?])))
    }

    fn build(
        settings: GraspSettings,
        model: &str,
        drive: impl FnOnce(&Simulation) -> Result<Drive, UnknownName>,
    ) -> Result<Self, GraspError> {
        settings.check()?;
        let law = law(&settings)?;
        let sim = Simulation::from_mjcf(model)?;
        let drive = drive(&sim)?;
        let plant = GraspPlant::new(&settings, law.clone(), sim, drive)?;
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

/// The mechanism that settings ask for.
fn law(settings: &GraspSettings) -> Result<Law, GraspError> {
    let GraspSettings { palm, range, initial, opening, .. } = *settings;
    Ok(Law::new(TendonHand::new(&settings.hand.transmission, &TendonHandSettings { palm, range, initial, opening })?))
}

impl MakeEnvironment for Grasp {
    fn make(&self, horizon: Option<usize>) -> Box<dyn Environment> {
        Box::new(self.robot(horizon))
    }
}
