//! An episode to look at: drawn grasps of a hand, curves of anything else.

use hwasp_core::{Batch, Serial};
use hwasp_plot::trace;
use hwasp_runs::{RunError, SavedRun};
use hwasp_training::{Assembly, EvaluateError, held_out, sampler};
use maud::{Markup, html};

use crate::figure::{gallery, picture};
use crate::page::Section;
use crate::run::Run;
use crate::words::{sentence, spaced};

/// # Errors
/// Of a policy that is missing or damaged. Where an episode cannot be run, the page says so, and the rest of it stands.
pub(super) fn section(run: &Run) -> Result<Section, RunError> {
    let (title, body) = match run.design.hand {
        Some(_) => ("How it grasps", grasps(run)?),
        None => ("How it moves", moves(run)?),
    };
    Ok(Section { id: "episode", title, body })
}

fn failed(error: &dyn std::error::Error) -> Markup {
    html! { p { "No episode can be shown: " (error) "." } }
}

#[cfg(feature = "mujoco")]
fn grasps(run: &Run) -> Result<Markup, RunError> {
    let saved = SavedRun::open(&run.path, run.spec.catalogue())?;
    let drawn = crate::grasp::section(saved.assembly(), &saved.params()?);
    Ok(drawn.unwrap_or_else(|error| failed(&error)))
}

#[cfg(not(feature = "mujoco"))]
#[allow(clippy::unnecessary_wraps)] // as with the engine
fn grasps(_: &Run) -> Result<Markup, RunError> {
    Ok(html! {
        p {
            "Grasps are simulated when the report is made, and the program that made this one was built without the MuJoCo engine. \
             A program with it, which is the default, draws them here."
        }
    })
}

/// What the controller sees and commands in the first held-out episode.
fn moves(run: &Run) -> Result<Markup, RunError> {
    let saved = SavedRun::open(&run.path, run.spec.catalogue())?;
    let params = saved.params()?;
    let batch = first_episode(saved.assembly(), &params, run.summary.evaluation.seed);
    Ok(match batch {
        Ok(batch) => curves(run, saved.assembly(), &params, &batch),
        Err(error) => failed(&error),
    })
}

fn curves(run: &Run, assembly: &Assembly, params: &[f32], batch: &Batch) -> Markup {
    let seed = run.summary.evaluation.seed;
    let environment = assembly.worlds.deployment.make.make(None);
    let (seen, given) = (&environment.spec().observation, &environment.spec().command);
    let normalizer = assembly.policy.normalizer(params);
    let column = |values: &[f32], of: usize, i: usize| -> Vec<f64> {
        values.iter().skip(i).step_by(of.max(1)).map(|&value| f64::from(value)).collect()
    };
    let mut traces = Vec::new();
    for (i, port) in seen.iter().enumerate() {
        // The batch has what the controller reads: centred and scaled, and within its clip where it has one.
        let (centre, scale) = (normalizer.center()[i], normalizer.scale()[i]);
        let width = batch.obs.len() / batch.rows().max(1);
        let values: Vec<f64> = column(&batch.obs, width, i).iter().map(|value| centre + scale * value).collect();
        traces.push((format!("observed: {}", spaced(&port.name)), port.dimension.si(), values));
    }
    for (i, port) in given.iter().enumerate() {
        let values = column(&batch.action, given.len(), i).iter().map(|value| value.clamp(port.lo, port.hi)).collect();
        traces.push((format!("commanded: {}", spaced(&port.name)), port.dimension.si(), values));
    }
    traces.push(("reward".to_owned(), "", batch.reward.clone()));
    let about = "One line over the steps of the episode.";
    let plots = traces.iter().filter_map(|(label, unit, values)| trace(label, unit, values));
    let pictures: Vec<Markup> = plots
        .enumerate()
        .map(|(i, plot)| {
            picture(&plot.svg, &format!("episode-{i}"), &format!("{} in one episode", sentence(&plot.label)), about)
        })
        .collect();
    html! {
        p {
            "The first held-out episode (seed " (seed) "), by the deterministic controller on the hardware as built: what the \
             controller sees, what it commands, and what each step is worth."
        }
        (gallery(&pictures, ""))
    }
}

fn first_episode(assembly: &Assembly, params: &[f32], seed: u64) -> Result<Batch, EvaluateError> {
    let design = assembly.built(params);
    let sampler = sampler(assembly, &assembly.worlds.deployment, &design)?;
    Ok(sampler.collect(&Serial, assembly.policy.controller_params(params), &held_out(seed, 0..1))?)
}
