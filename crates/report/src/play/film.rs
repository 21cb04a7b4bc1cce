//! Runs held-out episodes as the evaluation does, and films them.

use std::sync::Arc;

use hwasp_core::{RolloutError, Serial};
use hwasp_grasp::{Film, Filmed, Grasp, Object, settings_of};
use hwasp_training::{Assembly, World, held_out, sampler};

use super::{PlayError, PlayOptions, check};

/// One episode on film.
#[derive(Clone, Debug, PartialEq)]
pub struct Grasped {
    /// Its index among the held-out episodes.
    pub index: u64,
    /// What was grasped.
    pub object: Object,
    /// Whether it succeeded.
    pub success: bool,
    /// Its undiscounted return.
    pub undiscounted_return: f64,
    /// What was to be seen.
    pub film: Film,
}

/// The grasping task by itself, whose episodes can be looked at: that of evaluation, or with a `native` design (SI) that of
/// [`Assembly::native`].
pub(super) fn grasp(assembly: &Assembly, native: Option<&[f64]>) -> Result<Grasp, PlayError> {
    let settings = settings_of(check(assembly)?);
    Ok(match native {
        None => Grasp::new(settings)?,
        Some(design) => Grasp::native(settings, &std::array::from_fn(|i| design[i]))?,
    })
}

/// Runs and films the episodes of `options`, with the controller in `params` on the design in them: as built and by the law,
/// or with the engine's own tendons.
pub fn film(assembly: &Assembly, params: &[f32], options: &PlayOptions) -> Result<Vec<Grasped>, PlayError> {
    let trained = assembly.policy.design(params);
    let design = if options.native { trained } else { assembly.worlds.training.law.as_built(&trained) };
    let grasp = grasp(assembly, options.native.then_some(&design[..]))?;
    let law = grasp.law();
    let filmed = Arc::new(Filmed::new(grasp));
    let sampler = sampler(
        assembly,
        &World::shared(law, filmed.clone()).with_horizon(assembly.experiment().task.horizon),
        &design,
    )?;
    let controller = assembly.policy.controller_params(params);
    // One at a time: the film is of the last episode. Neighbours change nothing in an episode.
    let take = |index| {
        let batch = sampler.collect(&Serial, controller, &held_out(options.seed, index..index + 1))?;
        let film = filmed.take();
        let missing = || RolloutError {
            seed: options.seed,
            iteration: 0,
            episode: index,
            step: 0,
            what: "it left no film or no outcome".into(),
        };
        let outcome = batch.episodes.first().and_then(|episode| episode.outcome.clone());
        let (outcome, object) = outcome.zip(film.object.clone()).ok_or_else(missing)?;
        let undiscounted_return = *batch.returns(1.0).first().expect("an episode with an outcome has a return");
        Ok(Grasped { index, object, success: outcome.success, undiscounted_return, film })
    };
    (options.first..options.first.saturating_add(options.episodes)).map(take).collect()
}
