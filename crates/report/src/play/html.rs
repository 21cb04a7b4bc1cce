//! Episodes as a page for a browser, drawn without a renderer.

use hwasp_training::Assembly;

use super::{PlayError, PlayOptions};
use crate::film::{Request, film};
use crate::page::{Page, Section};

/// Bytes of the film of an episode, at most.
const MOST_BYTES: usize = 120_000;

/// The episodes of `options` on one page that loads nothing, under `title`: of every world that
/// [shows itself](hwasp_core::Environment::look).
pub fn page(assembly: &Assembly, params: &[f32], options: &PlayOptions, title: &str) -> Result<String, PlayError> {
    let trained = assembly.policy.design(params);
    let (world, design) = if options.native {
        (assembly.native(&trained)?, trained)
    } else {
        (assembly.worlds.deployment.clone(), assembly.built(params))
    };
    let request = Request {
        assembly,
        params,
        world: &world,
        design: &design,
        seed: options.seed,
        most_bytes: options.episodes as usize * MOST_BYTES,
        episodes: (options.first..options.first.saturating_add(options.episodes)).collect(),
    };
    let unseen = || PlayError::Unseen { problem: assembly.experiment().task.name().to_owned() };
    let body = film(&request)?.ok_or_else(unseen)?;
    let sections = vec![Section { id: "episode", title: "Episodes", body }];
    let lead = assembly.experiment().description.clone();
    Ok(Page { title: title.to_owned(), kind: "Film", lead, figures: Vec::new(), sections }.html())
}
