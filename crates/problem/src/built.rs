//! A problem for given settings.

use std::sync::Arc;

use hwasp_core::{Law, MakeEnvironment};
use hwasp_settings::Files;

use crate::error::AnyError;
use crate::manual::Manual;
use crate::mechanism::Mechanism;
use crate::words::Words;
use crate::world::World;

/// How the world that stands in for the built robot comes nearer to it than the law, held for a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StandInKind {
    /// It has tendons and springs of the engine's own, and the law has no say.
    NativeTendons,
    /// The law acts at the rate of the physics.
    FastLaw,
}

/// The world that comes nearest to the built robot.
#[derive(Clone)]
pub struct StandIn {
    /// How it does so.
    pub kind: StandInKind,
    /// From a design (SI) to the world.
    pub make: Arc<MakeWorld>,
}

/// From a design, SI, to a world.
pub type MakeWorld = dyn Fn(&[f64]) -> Result<World, AnyError> + Send + Sync;

/// A problem: where one trains, where the result has to work, and what is known of it.
#[derive(Clone)]
pub struct Built {
    /// Where one trains: the law that is differentiated, and aids to training.
    pub training: World,
    /// Where the result has to work: the mechanism as built, without aids. Evaluations happen here.
    pub deployment: World,
    /// The total of each design group that is best as built, where it is known, SI.
    pub optimum: Vec<Option<f64>>,
    /// The standard deviation with which each effort is explored unless an experiment says otherwise, SI; as its dimension says
    /// where there is none.
    pub effort_std: Vec<Option<f64>>,
    /// What problem and ports are called in exports and reports.
    pub words: Words,
    /// What somebody has to know who puts its controller to work.
    pub manual: Manual,
    /// What is built of the law: parts, shapes, statics.
    pub mechanism: Option<Arc<dyn Mechanism>>,
    /// The world that stands in for the built robot.
    pub stand_in: Option<StandIn>,
    /// The files that its settings name, by their paths: a run keeps them beside its experiment.
    pub files: Arc<Files>,
}

impl Built {
    /// A mechanism that works as it is trained: one world, of which nothing else is known.
    pub fn new(law: Law, make: impl MakeEnvironment + 'static) -> Self {
        let world = World::new(law, make);
        Self::of(world.clone(), world)
    }

    /// The same with a world to train in and another in which the result has to work.
    pub fn of(training: World, deployment: World) -> Self {
        let optimum = vec![None; training.law.design().groups().len()];
        let effort_std = vec![None; training.env.effort.len()];
        let words = Words::default();
        Self {
            training,
            deployment,
            optimum,
            effort_std,
            words,
            manual: Manual::default(),
            mechanism: None,
            stand_in: None,
            files: Arc::default(),
        }
    }
}

impl std::fmt::Debug for Built {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Built")
            .field("training", &self.training)
            .field("deployment", &self.deployment)
            .field("mechanism", &self.mechanism)
            .finish_non_exhaustive()
    }
}
