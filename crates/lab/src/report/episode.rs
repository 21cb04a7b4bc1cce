//! An episode to look at: drawn grasps of a hand, curves of anything else.

use hwasp_core::{Batch, Serial};
use maud::{Markup, html};

use super::figure::{gallery, picture};
use super::page::Section;
use super::run::Run;
use super::words::{sentence, spaced};
use crate::assemble::Assembly;
use crate::evaluate::{held_out, sampler};
use crate::plot::trace;
use crate::run_folder::SavedRun;

pub(super) fn section(run: &Run) -> Section {
    if run.design.hand.is_some() {
        return Section { id: "episode", title: "How it grasps", body: grasps(run) };
    }
    let body = curves(run).unwrap_or_else(|error| failed(&*error));
    Section { id: "episode", title: "How it moves", body }
}

/// What there is to say where an episode cannot be run; the rest of the report stands without it.
fn failed(error: &dyn std::error::Error) -> Markup {
    html! { p { "No episode can be shown: " (error) "." } }
}

type Failed = Box<dyn std::error::Error>;

/// The controller that the run has trained, ready to run.
fn trained(run: &Run) -> Result<(SavedRun, Vec<f32>), Failed> {
    let saved = SavedRun::open(&run.path)?;
    let params = saved.params()?;
    Ok((saved, params))
}

#[cfg(feature = "mujoco")]
fn grasps(run: &Run) -> Markup {
    let drawn = trained(run).and_then(|(saved, params)| Ok(super::grasp::section(saved.assembly(), &params)?));
    drawn.unwrap_or_else(|error| failed(&*error))
}

#[cfg(not(feature = "mujoco"))]
fn grasps(_: &Run) -> Markup {
    html! {
        p {
            "Grasps are simulated when the report is made, and the program that made this one was built without the MuJoCo engine. \
             A program with it, which is the default, draws them here."
        }
    }
}

/// What the controller sees and commands in the first held-out episode.
fn curves(run: &Run) -> Result<Markup, Failed> {
    let (saved, params) = trained(run)?;
    let assembly = saved.assembly();
    let seed = run.summary.evaluation.seed;
    let batch = first_episode(assembly, &params, seed)?;
    let environment = assembly.problem.deployment.make.make(None);
    let (seen, given) = (&environment.spec().observation, &environment.spec().command);
    let controller = &run.spec.controller;
    let column = |values: &[f32], of: usize, i: usize| -> Vec<f64> {
        values.iter().skip(i).step_by(of.max(1)).map(|&value| f64::from(value)).collect()
    };
    let mut traces = Vec::new();
    for (i, port) in seen.iter().enumerate() {
        // The batch has what the controller reads: centred and scaled.
        let (centre, scale) = (controller.observation_center[i], controller.observation_scale[i]);
        let values: Vec<f64> = column(&batch.obs, seen.len(), i).iter().map(|value| centre + scale * value).collect();
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
    Ok(html! {
        p {
            "The first held-out episode (seed " (seed) "), by the deterministic controller on the hardware as built: what the \
             controller sees, what it commands, and what each step is worth."
        }
        (gallery(&pictures, ""))
    })
}

fn first_episode(assembly: &Assembly, params: &[f32], seed: u64) -> Result<Batch, Failed> {
    let design = assembly.built(params);
    let sampler = sampler(assembly, &assembly.problem.deployment, &design)?;
    Ok(sampler.collect(&Serial, assembly.policy.controller_params(params), &held_out(seed, 0..1))?)
}
