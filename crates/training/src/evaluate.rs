//! Evaluation: the deterministic policy on held-out starts, on the hardware as built.

use std::ops::Range;
use std::sync::Arc;

use hwasp_core::{EpisodeKind, Episodes, Executor, Sampler, all_failed};
use hwasp_problem::World;

use crate::assemble::{AssembleError, Assembly};
use crate::collect::{Collector, EpisodeAnswer, EpisodesRequest, ExperimentText, Stage};
use crate::evaluation::{EvaluateError, Evaluation};
use crate::worker::LocalCollector;

/// Evaluates the controller in `params` on the design in them, as built, where it has to work: so many episodes from the
/// starts of a root seed.
pub fn evaluate(
    assembly: &Assembly,
    params: &[f32],
    asked: (u64, u64),
    executor: &dyn Executor,
) -> Result<Evaluation, EvaluateError> {
    evaluate_by(&LocalCollector::new(assembly, executor)?, assembly, params, asked)
}

/// The same, of episodes that `collector` gives.
pub fn evaluate_by(
    collector: &dyn Collector,
    assembly: &Assembly,
    params: &[f32],
    asked: (u64, u64),
) -> Result<Evaluation, EvaluateError> {
    evaluate_at(Stage::Deployment(assembly.built(params)), collector, assembly, params, asked)
}

/// Evaluates the controller in `params` on the design in them in the world that stands in for the built robot: the hand with
/// the engine's own tendons ([`Assembly::native`]).
pub fn evaluate_native(
    assembly: &Assembly,
    params: &[f32],
    asked: (u64, u64),
    executor: &dyn Executor,
) -> Result<Evaluation, EvaluateError> {
    evaluate_native_by(&LocalCollector::new(assembly, executor)?, assembly, params, asked)
}

/// The same, of episodes that `collector` gives.
pub fn evaluate_native_by(
    collector: &dyn Collector,
    assembly: &Assembly,
    params: &[f32],
    asked: (u64, u64),
) -> Result<Evaluation, EvaluateError> {
    evaluate_at(Stage::StandIn(assembly.policy.design(params)), collector, assembly, params, asked)
}

fn evaluate_at(
    stage: Stage,
    collector: &dyn Collector,
    assembly: &Assembly,
    params: &[f32],
    asked: (u64, u64),
) -> Result<Evaluation, EvaluateError> {
    let experiment = ExperimentText::of(assembly.experiment())?;
    let results = rollouts(collector, assembly, experiment, stage, params, asked)?;
    Ok(Evaluation::new(&results, &assembly.worlds.deployment.env, asked)?)
}

/// Evaluates the controller in `params` on a given design in a given world of the same problem, which only this process has.
pub fn evaluate_in(
    assembly: &Assembly,
    world: &World,
    design: &[f64],
    params: &[f32],
    asked: (u64, u64),
    executor: &dyn Executor,
) -> Result<Evaluation, EvaluateError> {
    let (episodes, seed) = asked;
    let (sampler, controller) = (sampler(assembly, world, design)?, assembly.policy.controller_params(params));
    let discount = assembly.experiment().discount();
    let results = sampler.outcomes(executor, controller, &held_out(seed, 0..episodes), discount)?;
    Ok(Evaluation::new(&results, &world.env, asked)?)
}

/// What the episodes of an evaluation come to, by index; the error where the physics failed. Their rows are not kept, so that
/// there may be many.
pub(crate) fn rollouts(
    collector: &dyn Collector,
    assembly: &Assembly,
    experiment: ExperimentText,
    stage: Stage,
    params: &[f32],
    (episodes, seed): (u64, u64),
) -> Result<Vec<EpisodeAnswer>, EvaluateError> {
    let params = assembly.policy.controller_params(params).to_vec();
    let episodes = held_out(seed, 0..episodes);
    let request = EpisodesRequest { experiment, stage, params, episodes, steps: None, lanes: None };
    let results = collector.results(&request)?;
    all_failed(&results).map_or(Ok(results), |first| Err(first.into()))
}

/// The deterministic controller on the hardware of `design` in a world; for [`HardwarePolicy::controller_params`].
///
/// [`HardwarePolicy::controller_params`]: hwasp_core::HardwarePolicy::controller_params
pub fn sampler(assembly: &Assembly, world: &World, design: &[f64]) -> Result<Sampler, AssembleError> {
    let policy = assembly.fixed_in(world, design, false)?;
    Ok(Sampler::new(Arc::new(policy), Arc::clone(&world.make), None))
}

/// Episodes that training never sees.
pub fn held_out(seed: u64, indices: Range<u64>) -> Episodes {
    Episodes { seed, iteration: 0, indices, progress: 1.0, kind: EpisodeKind::Evaluation }
}
