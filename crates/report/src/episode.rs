//! Episodes to look at: a film of what shows itself, and curves.

use hwasp_core::{Batch, Port, Serial};
use hwasp_plot::trace;
use hwasp_training::{Assembly, EvaluateError, World, held_out, sampler};
use maud::{Markup, html};

use crate::figure::{gallery, picture};
use crate::film::{Request, film, takes};
use crate::page::Section;
use crate::run::Run;
use crate::trials::Played;
use crate::words::sentence;

/// Bytes of the films of a page, at most.
const MOST_BYTES: usize = 180_000;

pub(super) fn section(run: &Run, played: &Result<Played, String>) -> Section {
    let title = if run.design.hand.is_some() { "How it grasps" } else { "How it moves" };
    let body = match played {
        Ok(played) => shown(run, played),
        Err(error) => failed(error),
    };
    Section { id: "episode", title, body }
}

fn failed(error: &str) -> Markup {
    html! { p { "No episode can be shown: " (error) "." } }
}

/// A film of what shows itself, and curves of an episode; what a hand does is in its film, and in the chapter on the mechanism.
fn shown(run: &Run, Played { saved, params, trials }: &Played) -> Markup {
    let (assembly, seed) = (saved.assembly(), run.summary.evaluation.seed);
    let episodes = trials.shown();
    let chosen = (!episodes.is_empty()).then(|| {
        format!(
            "The first successes, each of another kind, and the first failures among {} episodes.",
            trials.results.len()
        )
    });
    let request = Request {
        assembly,
        params,
        world: &assembly.worlds.deployment,
        design: &assembly.built(params),
        seed,
        episodes,
    };
    let drawn = match takes(&request) {
        Ok(takes) => film(&takes, seed, MOST_BYTES),
        Err(error) => return failed(&error.to_string()),
    };
    html! {
        @if let Some(film) = drawn {
            @if let Some(chosen) = chosen { p { (chosen) } }
            (film)
        }
        @if run.design.hand.is_none() {
            @match first_episode(assembly, params, seed) {
                Ok(batch) => (curves(run, assembly, params, &batch)),
                Err(error) => (failed(&error.to_string())),
            }
        }
    }
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
        traces.push((format!("observed: {}", port.name), port.dimension.si(), values));
    }
    for (i, port) in given.iter().enumerate() {
        let values = column(&batch.action, given.len(), i).iter().map(|value| value.clamp(port.lo, port.hi)).collect();
        traces.push((format!("commanded: {}", port.name), port.dimension.si(), values));
    }
    for (port, values) in efforts(assembly, params, batch) {
        traces.push((format!("effort of the law: {}", port.name), port.dimension.si(), values));
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
             controller sees, what it commands, "
            @if !environment.spec().effort.is_empty() { "what efforts the law makes of that, " }
            "and what each step is worth."
        }
        (gallery(&pictures, ""))
    }
}

/// What the law gave in each step, effort by effort.
pub(super) fn efforts(assembly: &Assembly, params: &[f32], batch: &Batch) -> Vec<(Port, Vec<f64>)> {
    let World { law, env, .. } = &assembly.worlds.deployment;
    let design = assembly.built(params);
    let reads = law.reads(&env.command).unwrap_or_default();
    let mut traces: Vec<(Port, Vec<f64>)> = env.effort.iter().map(|port| (port.clone(), Vec::new())).collect();
    let mut effort = vec![0.0; traces.len()];
    for row in 0..batch.rows() {
        let commands = &batch.action[row * env.command.len()..][..env.command.len()];
        let limited = |&c: &usize| f64::from(commands[c]).clamp(env.command[c].lo, env.command[c].hi);
        let command: Vec<f64> = reads.iter().map(limited).collect();
        let state = &batch.state[row * env.state.len()..][..env.state.len()];
        let state: Vec<f64> = state.iter().map(|&value| f64::from(value)).collect();
        law.effort(&design, &command, &state, &mut effort);
        traces.iter_mut().zip(&effort).for_each(|((_, values), &effort)| values.push(effort));
    }
    traces
}

/// The first held-out episode, on the hardware as built.
pub(super) fn first_episode(assembly: &Assembly, params: &[f32], seed: u64) -> Result<Batch, EvaluateError> {
    let design = assembly.built(params);
    let sampler = sampler(assembly, &assembly.worlds.deployment, &design)?;
    Ok(sampler.collect(&Serial, assembly.policy.controller_params(params), &held_out(seed, 0..1))?)
}
