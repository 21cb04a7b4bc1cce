//! Beginning with what another training learned: weights by the names of ports, the design by the names of its parameters.

use hwasp_core::{CommandPort, HardwarePolicy, Normalizer};
use thiserror::Error;

use crate::assemble::Assembly;

/// Why a controller cannot begin as another one.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum WarmStartError {
    /// What controllers have to have in common, and the values here and there.
    #[error("{what} = {here}, and the run to begin with has {there}: both have to have the same")]
    Other {
        /// Which key.
        what: String,
        /// Its value in the experiment.
        here: String,
        /// Its value in the run.
        there: String,
    },
    /// Nothing that the run's controller sees or commands has the name of anything here.
    #[error("the run to begin with has no {what} of these names: {names}")]
    Strange {
        /// Which ports.
        what: &'static str,
        /// What there is here.
        names: String,
    },
}

/// Parameters of `assembly` with which its controller and design begin as those of another training end.
///
/// The controller does as the other one does, wherever what it sees has the same name: centres and scales may differ, and
/// what only this one sees counts nothing yet. What only this one commands begins fresh, as exploration does. The design begins where the
/// other one ended, within the limits here.
///
/// # Errors
/// Where hidden layers, squash or limits of commands differ, or no name is common.
pub fn warm_start(assembly: &Assembly, other: &Assembly, params: &[f32]) -> Result<Vec<f32>, WarmStartError> {
    let (here, there) = (&assembly.policy, &other.policy);
    alike(here, there)?;
    let (env, other_env) = (&assembly.worlds.training.env, &other.worlds.training.env);
    let inputs = matched(
        "observation",
        &names(env.observation.iter().map(|port| &port.name)),
        &names(other_env.observation.iter().map(|port| &port.name)),
    )?;
    let outputs = matched(
        "command",
        &names(env.command.iter().map(|port| &port.name)),
        &names(other_env.command.iter().map(|port| &port.name)),
    )?;
    for (command, &from) in env.command.iter().zip(&outputs) {
        same_limits(command, from.map(|at| &other_env.command[at]))?;
    }
    let mut start = assembly.init();
    scaling(here, &mut start, &inputs, &there.normalizer(params));
    let scales = (here.normalizer(&start), there.normalizer(params));
    let (inputs, outputs) = (widened(here, &inputs), doubled(here, there, &outputs));
    let controller = here.controller().param_count();
    transfer(here, there, (&inputs, &outputs), &scales, (&mut start[..controller], params));
    design(assembly, other, params, &mut start);
    Ok(start)
}

fn names<'a>(ports: impl Iterator<Item = &'a String>) -> Vec<&'a str> {
    ports.map(String::as_str).collect()
}

fn alike(here: &HardwarePolicy, there: &HardwarePolicy) -> Result<(), WarmStartError> {
    let (a, b) = (here.spec(), there.spec());
    let other = |what: &str, here: String, there: String| {
        if here == there { Ok(()) } else { Err(WarmStartError::Other { what: what.to_owned(), here, there }) }
    };
    other("controller.hidden", format!("{:?}", a.hidden), format!("{:?}", b.hidden))?;
    other("controller.activation", format!("{:?}", a.activation), format!("{:?}", b.activation))?;
    other("controller.squash", a.squash.to_string(), b.squash.to_string())
}

/// Where each of these names is among others.
fn matched(what: &'static str, here: &[&str], there: &[&str]) -> Result<Vec<Option<usize>>, WarmStartError> {
    let found: Vec<_> = here.iter().map(|name| there.iter().position(|other| other == name)).collect();
    if found.iter().all(Option::is_none) {
        return Err(WarmStartError::Strange { what, names: here.join(", ") });
    }
    Ok(found)
}

/// Outputs are fractions of a command's range.
fn same_limits(here: &CommandPort, there: Option<&CommandPort>) -> Result<(), WarmStartError> {
    match there {
        Some(there) if [there.lo, there.hi] != [here.lo, here.hi] => Err(WarmStartError::Other {
            what: format!("the range of {}", here.name),
            here: format!("{} to {}", here.lo, here.hi),
            there: format!("{} to {}", there.lo, there.hi),
        }),
        _ => Ok(()),
    }
}

/// Running statistics begin with the other one's centres and scales.
fn scaling(here: &HardwarePolicy, start: &mut [f32], inputs: &[Option<usize>], there: &Normalizer) {
    let running = &mut start[here.normalizer_params()];
    let (centers, scales) = running.split_at_mut(running.len() / 2);
    for ((center, scale), &from) in centers.iter_mut().zip(scales).zip(inputs) {
        if let Some(from) = from {
            (*center, *scale) = (there.center()[from] as f32, there.scale()[from] as f32);
        }
    }
}

/// Inputs beyond the observation, of a controller that sees the design: nothing of the other one is for them.
fn widened(here: &HardwarePolicy, inputs: &[Option<usize>]) -> Vec<Option<usize>> {
    let mut inputs = inputs.to_vec();
    inputs.resize(here.controller().inputs(), None);
    inputs
}

/// The same for the outputs that tell how widely commands spread, after their means, where both controllers have them.
fn doubled(here: &HardwarePolicy, there: &HardwarePolicy, outputs: &[Option<usize>]) -> Vec<Option<usize>> {
    let mut all = outputs.to_vec();
    if here.spec().state_dependent_std {
        let means = there.controller().outputs() / 2;
        let both = there.spec().state_dependent_std;
        all.extend(outputs.iter().map(|from| from.filter(|_| both).map(|at| means + at)));
    }
    all
}

/// Copies weights: layers are `[inputs × outputs]` and `[outputs]` biases, one after the other.
fn transfer(
    here: &HardwarePolicy,
    there: &HardwarePolicy,
    (inputs, outputs): (&[Option<usize>], &[Option<usize>]),
    (now, before): &(Normalizer, Normalizer),
    (start, params): (&mut [f32], &[f32]),
) {
    let (sizes, other) = (here.controller().sizes(), there.controller().sizes());
    let last = sizes.len() - 2;
    let (mut at, mut from) = (0, 0);
    for layer in 0..=last {
        let ([ins, outs], [other_ins, other_outs]) =
            ([sizes[layer], sizes[layer + 1]], [other[layer], other[layer + 1]]);
        let (bias, other_bias) = (at + ins * outs, from + other_ins * other_outs);
        let source = |output: usize| if layer == last { outputs[output] } else { Some(output) };
        for (output, of) in (0..outs).filter_map(|output| source(output).map(|of| (output, of))) {
            let mut offset = f64::from(params[other_bias + of]);
            for input in 0..ins {
                let weight = |i: usize| f64::from(params[from + i * other_outs + of]);
                let copied = match (layer, inputs.get(input)) {
                    (0, Some(Some(i))) => {
                        offset += weight(*i) * (now.center()[input] - before.center()[*i]) / before.scale()[*i];
                        weight(*i) * now.scale()[input] / before.scale()[*i]
                    }
                    (0, _) => 0.0,
                    _ => weight(input),
                };
                start[at + input * outs + output] = copied as f32;
            }
            start[bias + output] = offset as f32;
        }
        (at, from) = (bias + outs, other_bias + other_outs);
    }
}

/// The design begins where the other one ended, as near to it as the limits let.
fn design(assembly: &Assembly, other: &Assembly, params: &[f32], start: &mut [f32]) {
    let (space, policy) = (assembly.policy.space(), &assembly.policy);
    let (names, built) = (other.policy.space().names(), other.built(params));
    let at = policy.design_params();
    for (u, &i) in start[at].iter_mut().zip(policy.free_design()) {
        let name = &space.names()[i];
        if let Some(from) = names.iter().position(|other| other == name) {
            let (lo, hi) = space.bounds(i);
            let inside = EDGE * (hi - lo);
            *u = space.unsquash(i, built[from].clamp(lo + inside, hi - inside)) as f32;
        }
    }
}

/// At a limit itself no gradient would lead back.
const EDGE: f64 = 1e-3;
