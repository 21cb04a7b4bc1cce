//! Beginning with what other trainings learned: weights by the names of ports, the design by the names of its parameters.

use hwasp_core::{CommandPort, HardwarePolicy, Moments, Normalizer, Policy, Serial};
use thiserror::Error;

use crate::assemble::Assembly;
use crate::evaluate::{held_out, sampler};

/// Why a controller cannot begin as others.
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
    /// Networks of several runs stand side by side.
    #[error("controller.hidden = {here}, where what it is to begin with has {there}: {way}")]
    Hidden {
        /// In the experiment.
        here: String,
        /// In the runs.
        there: String,
        /// What to set.
        way: String,
    },
    /// Nothing that the run's controller sees or commands has the name of anything here.
    #[error("the run to begin with has no {what} of these names: {names}")]
    Strange {
        /// Which ports.
        what: &'static str,
        /// What there is here, and what no run before has.
        names: String,
    },
    /// The run's controller cannot be tried in its own world.
    #[error("what the run to begin with sees cannot be found out: {0}")]
    Untried(String),
}

/// What another training has learned.
#[derive(Clone, Copy)]
pub struct Learned<'a> {
    /// The training.
    pub assembly: &'a Assembly,
    /// Its parameters.
    pub params: &'a [f32],
}

/// What varied by less than this for a controller, as a multiple of its scale, has weights of chance: to a grasp from above, the place
/// of an object that always lies in the middle is the noise of a sensor.
const HARDLY: f64 = 0.2;
/// From how many times as wide on such an input would have the controller do what it never did.
const BEYOND: f64 = 5.0;
/// Held-out episodes in which that is seen.
const TRIED: u64 = 8;

/// An observation over some episodes.
#[derive(Clone, Copy)]
struct Seen {
    /// Centred and scaled.
    mean: f64,
    /// Standard deviation, scaled.
    deviation: f64,
    /// SI.
    scale: f64,
}

impl Seen {
    /// Whether weights on it say nothing about what is seen `now`.
    fn is_beyond(&self, now: &Self) -> bool {
        self.deviation < HARDLY && now.deviation * now.scale > BEYOND * self.deviation * self.scale
    }
}

impl Learned<'_> {
    /// What the controller sees on its own hardware, in its own world.
    fn tried(&self) -> Result<Vec<Seen>, WarmStartError> {
        let Self { assembly, params } = self;
        let untried = |error: &dyn std::error::Error| WarmStartError::Untried(error.to_string());
        let world = &assembly.worlds.deployment;
        let sampler = sampler(assembly, world, &assembly.built(params)).map_err(|error| untried(&error))?;
        let episodes = held_out(assembly.experiment().seed, 0..TRIED);
        let controller = assembly.policy.controller_params(params);
        let batch = sampler.collect(&Serial, controller, &episodes).map_err(|error| untried(&error))?;
        let observations = world.env.observation.len();
        let mut moments = Moments::new(observations);
        for row in batch.obs.chunks_exact(sampler.policy().obs_dim()) {
            moments.push(&row[..observations].iter().map(|&x| f64::from(x)).collect::<Vec<_>>());
        }
        let normalizer = assembly.policy.normalizer(params);
        let seen = moments.mean.iter().zip(moments.variances()).zip(normalizer.scale());
        Ok(seen.map(|((&mean, variance), &scale)| Seen { mean, deviation: variance.sqrt(), scale }).collect())
    }
}

/// Parameters of `assembly` with which its controller and design begin as those of other trainings end.
///
/// The controllers' networks stand side by side, and each command comes from the first one that has it: with one for the way to an
/// object and one for the grasp, the palm goes there and grasps. They share nothing at first; training may connect them. Each does as it
/// did, wherever what it sees has the same name: centres and scales may differ. What it did not see counts nothing yet, nor does what
/// it hardly saw and what now varies far more. What none commands begins fresh, as exploration does. A design parameter begins where the
/// first training that has it ended, within the limits here.
///
/// # Errors
/// Where hidden layers are not those of all together, squash or limits of commands differ, or no name is common.
pub fn warm_start(assembly: &Assembly, learned: &[Learned<'_>]) -> Result<Vec<f32>, WarmStartError> {
    alike(&assembly.policy, learned)?;
    let mut blocks = blocks(assembly, learned)?;
    let whole = joined(assembly, &blocks);
    let here = Learned { assembly, params: &whole }.tried()?;
    for block in &mut blocks {
        let there = block.run.tried()?;
        for (input, now) in block.inputs.iter_mut().zip(&here) {
            if let Some(i) = input.filter(|&i| there[i].is_beyond(now)) {
                (*input, block.constant[i]) = (None, there[i].mean);
            }
        }
    }
    Ok(joined(assembly, &blocks))
}

/// A run's network among the others.
struct Block<'a> {
    run: Learned<'a>,
    /// Where each observation and each command of here is in the run.
    inputs: Vec<Option<usize>>,
    outputs: Vec<Option<usize>>,
    /// What stands for the observations that it has and that are none of these, centred and scaled.
    constant: Vec<f64>,
}

fn blocks<'a>(assembly: &Assembly, learned: &[Learned<'a>]) -> Result<Vec<Block<'a>>, WarmStartError> {
    let env = &assembly.worlds.training.env;
    let observations = names(env.observation.iter().map(|port| &port.name));
    let mut commands = names(env.command.iter().map(|port| &port.name));
    let block = |run: &Learned<'a>| {
        let there = &run.assembly.worlds.training.env;
        let inputs = matched("observation", &observations, &names(there.observation.iter().map(|port| &port.name)))?;
        let outputs = matched("command", &commands, &names(there.command.iter().map(|port| &port.name)))?;
        for ((command, &from), name) in env.command.iter().zip(&outputs).zip(&mut commands) {
            same_limits(command, from.map(|at| &there.command[at]))?;
            if from.is_some() {
                *name = TAKEN;
            }
        }
        Ok(Block { run: *run, inputs, outputs, constant: vec![0.0; there.observation.len()] })
    };
    learned.iter().map(block).collect()
}

/// Parameters with the networks side by side.
fn joined(assembly: &Assembly, blocks: &[Block<'_>]) -> Vec<f32> {
    let here = &assembly.policy;
    let mut start = assembly.init();
    for Block { run, inputs, .. } in blocks.iter().rev() {
        scaling(here, &mut start, inputs, &run.assembly.policy.normalizer(run.params));
        design(assembly, run.assembly, run.params, &mut start);
    }
    apart(here.controller().sizes(), &mut start);
    let now = here.normalizer(&start);
    let mut units = vec![0; here.spec().hidden.len()];
    for block in blocks {
        transfer(here, block, &units, &now, &mut start);
        for (unit, width) in units.iter_mut().zip(&block.run.assembly.policy.spec().hidden) {
            *unit += width;
        }
    }
    start
}

/// Stands for a command that comes from a run: no port has an empty name.
const TAKEN: &str = "";

fn names<'a>(ports: impl Iterator<Item = &'a String>) -> Vec<&'a str> {
    ports.map(String::as_str).collect()
}

/// Whether networks of these runs fit in side by side.
fn alike(here: &HardwarePolicy, learned: &[Learned<'_>]) -> Result<(), WarmStartError> {
    let mut sum = vec![0; here.spec().hidden.len()];
    let mut deep = true;
    for Learned { assembly, .. } in learned {
        let (a, b) = (here.spec(), assembly.policy.spec());
        let other = |what: &str, here: String, there: String| {
            if here == there { Ok(()) } else { Err(WarmStartError::Other { what: what.to_owned(), here, there }) }
        };
        other("controller.activation", format!("{:?}", a.activation), format!("{:?}", b.activation))?;
        other("controller.squash", a.squash.to_string(), b.squash.to_string())?;
        deep &= b.hidden.len() == sum.len();
        if deep {
            sum.iter_mut().zip(&b.hidden).for_each(|(sum, width)| *sum += width);
        }
    }
    if deep && sum == here.spec().hidden {
        return Ok(());
    }
    let there: Vec<_> = learned.iter().map(|run| format!("{:?}", run.assembly.policy.spec().hidden)).collect();
    let way =
        if deep { format!("set controller.hidden = {sum:?}") } else { "all need the same number of layers".to_owned() };
    Err(WarmStartError::Hidden { here: format!("{:?}", here.spec().hidden), there: there.join(" and "), way })
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

/// Running statistics begin with a run's centres and scales.
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

/// Hidden units hear nothing of the layer before until networks are put there.
fn apart(sizes: &[usize], start: &mut [f32]) {
    let mut at = 0;
    for layer in 0..sizes.len() - 2 {
        let [ins, outs] = [sizes[layer], sizes[layer + 1]];
        start[at..at + ins * outs].fill(0.0);
        at += ins * outs + outs;
    }
}

/// Copies the weights of a network to its place, from these units of the hidden layers on: layers are `[inputs × outputs]` and
/// `[outputs]` biases, one after the other.
fn transfer(here: &HardwarePolicy, block: &Block<'_>, units: &[usize], now: &Normalizer, start: &mut [f32]) {
    let Block { run: Learned { assembly, params }, inputs, outputs, constant } = block;
    let there = &assembly.policy;
    let before = there.normalizer(params);
    let (inputs, outputs) = (widened(here, inputs), doubled(here, there, outputs));
    let (sizes, other) = (here.controller().sizes(), there.controller().sizes());
    let last = sizes.len() - 2;
    let (mut at, mut from) = (0, 0);
    for layer in 0..=last {
        let ([ins, outs], [other_ins, other_outs]) =
            ([sizes[layer], sizes[layer + 1]], [other[layer], other[layer + 1]]);
        let (bias, other_bias) = (at + ins * outs, from + other_ins * other_outs);
        // Where a unit of a hidden layer is in the other network.
        let within = |unit: usize, layer: usize| unit.checked_sub(units[layer]).filter(|unit| *unit < other[layer + 1]);
        let source = |output: usize| if layer == last { outputs[output] } else { within(output, layer) };
        for (output, of) in (0..outs).filter_map(|output| source(output).map(|of| (output, of))) {
            let weight = |i: usize| f64::from(params[from + i * other_outs + of]);
            let mut offset = f64::from(params[other_bias + of]);
            if layer == 0 {
                offset += constant.iter().enumerate().map(|(i, x)| x * weight(i)).sum::<f64>();
            }
            for input in 0..ins {
                let source = if layer == 0 { inputs[input] } else { within(input, layer - 1) };
                let copied = match source {
                    Some(i) if layer == 0 => {
                        offset += weight(i) * (now.center()[input] - before.center()[i]) / before.scale()[i];
                        weight(i) * now.scale()[input] / before.scale()[i]
                    }
                    Some(i) => weight(i),
                    None => 0.0,
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
