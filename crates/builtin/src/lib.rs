//! The problems and learners that come with the program, one line for each.

#![forbid(unsafe_code)]

use hwasp_algos::{PpoKind, TrpoKind};
use hwasp_experiment::{Catalogue, CatalogueError};
use hwasp_offpolicy::{SacKind, Td3Kind};
use hwasp_tasks::grasp::{Engine, GraspProblem};
use hwasp_tasks::mass_spring::{BarLength, Stiffness};
use hwasp_tasks::pendulum::PendulumProblem;
use hwasp_tasks::reach::ReachProblem;

/// The engine in which one grasps, in builds with the feature `mujoco`.
#[cfg(feature = "mujoco")]
const ENGINE: Option<Engine> = Some(hwasp_grasp::engine);
#[cfg(not(feature = "mujoco"))]
const ENGINE: Option<Engine> = None;

/// All of them, for a catalogue to begin with:
///
/// ```
/// let catalogue = hwasp_builtin::catalogue();
/// let layers = hwasp_experiment::load("reach", &catalogue)?.with_override("ppo.clip_ratio", "0.1");
/// let experiment = hwasp_experiment::resolve(layers, Some("minimal"), &catalogue)?;
///
/// // What a run folder keeps gives the same experiment again.
/// let again = hwasp_experiment::Layers::from_text("experiment.toml", &experiment.to_toml()?)?;
/// assert_eq!(hwasp_experiment::resolve(again, None, &catalogue)?, experiment);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Panics
/// Never: that they go together is tested.
pub fn catalogue() -> Catalogue {
    all().expect("the problems that come with the program have names and settings of their own")
}

fn all() -> Result<Catalogue, CatalogueError> {
    let catalogue = Catalogue::default()
        .with_learner(PpoKind)?
        .with_learner(TrpoKind)?
        .with_learner(Td3Kind)?
        .with_learner(SacKind)?
        .with(Stiffness)?
        .with(BarLength)?
        .with(ReachProblem)?
        .with(PendulumProblem)?
        .with(GraspProblem::vertical(ENGINE))?
        .with(GraspProblem::spatial(ENGINE))?;
    #[cfg(feature = "mujoco")]
    let catalogue = catalogue.with(hwasp_model::ModelProblem)?;
    Ok(catalogue)
}
