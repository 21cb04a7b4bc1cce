//! Episodes as pages for a browser.

use hwasp_scene::{Scene, Take};
use hwasp_training::Assembly;

use super::{PlayError, PlayOptions};
use crate::film::{self, Request};
use crate::page::{Page, Section};

/// Bytes of each drawn episode, at most.
const MOST_BYTES: usize = 120_000;

/// Films the episodes of `options`: of every world that [shows itself](hwasp_core::Environment::look).
pub fn record(assembly: &Assembly, params: &[f32], options: &PlayOptions) -> Result<Vec<Take>, PlayError> {
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
        episodes: (options.first..options.first.saturating_add(options.episodes)).collect(),
    };
    let takes = film::takes(&request)?;
    let unseen = || PlayError::Unseen { problem: assembly.experiment().task.name().to_owned() };
    if takes.is_empty() { Err(unseen()) } else { Ok(takes) }
}

/// Filmed episodes in three dimensions, on one page that loads nothing.
pub fn scene_page(takes: &[Take], title: &str) -> String {
    hwasp_scene::page(&Scene::new(title, takes))
}

/// Filmed episodes as drawings, on one page that loads nothing; its stills need no script.
pub fn film_page(assembly: &Assembly, takes: &[Take], seed: u64, title: &str) -> String {
    let body = film::film(takes, seed, takes.len() * MOST_BYTES).unwrap_or_default();
    let sections = vec![Section { id: "episode", title: "Episodes", body }];
    let lead = assembly.experiment().description.clone();
    Page { title: title.to_owned(), kind: "Film", lead, figures: Vec::new(), sections }.html()
}
