//! The traced composition of controller output, squash and law.

use hwasp_diff::{Activation, Program, Scalar, Var};

use super::noise::{Anneal, Noise, Spread};
use crate::environment::{EnvSpec, Port};
use crate::law::Law;
use crate::placement::{ActionLayout, Placement, PlacementError};

/// Everything that makes a [`HardwarePolicy`](super::HardwarePolicy).
#[derive(Clone, Debug)]
pub struct PolicySpec {
    /// Widths of the hidden layers.
    pub hidden: Vec<usize>,
    /// What the hidden layers do.
    pub activation: Activation,
    /// Whether the output passes a tanh, so that it covers the motors' range and no more.
    pub squash: bool,
    /// Whether the controller tells how widely its commands spread, too: it has twice as many outputs, means first, then log
    /// standard deviations, both of what goes into the squash and as shares of half a motor's range. Commands are drawn before the
    /// law then, so that the law sees the draw ([`Reparameterised`](super::Reparameterised)); `noise.command` is where the spread
    /// begins.
    pub state_dependent_std: bool,
    /// The controller sees (observation - centre)/scale, per component.
    pub observation_center: Vec<f64>,
    /// See `observation_center`.
    pub observation_scale: Vec<f64>,
    /// Whether the controller sees the design as well: after the observation, each parameter scaled to [-1, 1] by its limits. It
    /// sees what was drawn for the episode, and of other parameters what they are at the time. No gradient passes this way.
    pub sees_design: bool,
    /// Where centre and scale are running statistics, how far from zero what the controller sees may be: they are parameters
    /// of the policy then ([`ParamKind::Normalizer`](super::ParamKind::Normalizer)) that begin with the two above.
    pub normalize: Option<f64>,
    /// The mechanism.
    pub law: Law,
    /// Where each design parameter sits.
    pub placements: Vec<Placement>,
    /// Exploration.
    pub noise: Noise,
}

/// The log standard deviation of one action component, and how it changes.
#[derive(Clone, Copy, Debug)]
pub(super) struct ComponentNoise {
    pub(super) log_std: f64,
    pub(super) anneal: Option<Anneal>,
}

/// The law as part of a policy.
#[derive(Clone, Debug)]
pub(super) struct Composition {
    /// Uniform inputs: `u` of every design parameter that is not fixed. Columns: controller outputs, state, sampled design.
    /// Outputs: the means of the action components.
    pub(super) program: Program,
    /// Where the law's commands are among the environment's.
    pub(super) reads: Vec<usize>,
    pub(super) layout: ActionLayout,
    /// The design parameters that are not fixed, in order.
    pub(super) free: Vec<usize>,
    pub(super) noise: Vec<ComponentNoise>,
}

impl PolicySpec {
    /// Checks that placements and ports fit, and traces the composition.
    pub(super) fn compose(&self, env: &EnvSpec) -> Result<Composition, PlacementError> {
        let (law, space) = (&self.law, self.law.design());
        if self.placements.len() != space.len() {
            return Err(PlacementError::Count { given: self.placements.len(), needed: space.len() });
        }
        for (i, place) in self.placements.iter().enumerate() {
            let (value, (lo, hi)) = match *place {
                Placement::Fixed(value) => (value, space.bounds(i)),
                Placement::Built(value) => (value, (f64::MIN, f64::MAX)),
                Placement::Graph | Placement::Action | Placement::Episode => continue,
            };
            if !(lo..=hi).contains(&value) {
                return Err(PlacementError::Outside { name: space.names()[i].clone(), value, lo, hi });
            }
        }
        let names = |ports: &[Port]| ports.iter().map(|p| p.name.clone()).collect::<Vec<_>>();
        let reads = law.reads(&env.command).ok_or_else(|| {
            let environment = env.command.iter().map(|p| p.name.clone()).collect();
            PlacementError::Ports { what: "command", law: law.ports().command.clone(), environment }
        })?;
        for (what, law, environment) in
            [("state", &law.ports().state, names(&env.state)), ("effort", &law.ports().effort, names(&env.effort))]
        {
            if *law != environment {
                return Err(PlacementError::Ports { what, law: law.clone(), environment });
            }
        }
        if let Some((_, port)) = env.command.iter().enumerate().find(|(c, port)| !port.direct && !reads.contains(c)) {
            return Err(PlacementError::Unread { name: port.name.clone() });
        }
        self.check_shaped(env)?;
        let layout = ActionLayout::new(&self.placements, env.effort.len(), &env.command);
        let (commands, efforts) = (&self.noise.command, &self.noise.effort);
        for (what, given, needed) in
            [("commands", commands.len(), env.command.len()), ("efforts", efforts.len(), env.effort.len())]
        {
            // Noise of efforts that are not sampled says nothing.
            if given != needed && (what == "commands" || layout.efforts > 0) {
                return Err(PlacementError::Noise { what, given, needed });
            }
        }
        let free: Vec<usize> = (0..space.len()).filter(|&i| self.placements[i].kept().is_none()).collect();
        let (program, noise) = (self.trace(env, (&layout, &reads), &free), self.component_noise(env, &layout));
        Ok(Composition { program, reads, layout, free, noise })
    }

    /// Refuses parameters that the world's model is made from where they would change within an episode.
    fn check_shaped(&self, env: &EnvSpec) -> Result<(), PlacementError> {
        let space = self.law.design();
        for (i, &place) in self.placements.iter().enumerate() {
            let moves = matches!(place, Placement::Graph | Placement::Action);
            if moves && env.shaped_by.contains(&space.group_of(i).name) {
                return Err(PlacementError::Shaped { name: space.names()[i].clone(), place });
            }
        }
        Ok(())
    }

    fn trace(&self, env: &EnvSpec, (layout, reads): (&ActionLayout, &[usize]), free: &[usize]) -> Program {
        let space = self.law.design();
        let names = space.names();
        let uniforms: Vec<String> = free.iter().map(|&i| names[i].clone()).collect();
        let (commands, states) = (env.command.len(), env.state.len());
        let mut columns: Vec<String> = env.command.iter().map(|p| format!("controller: {}", p.name)).collect();
        columns.extend(env.state.iter().map(|p| p.name.clone()));
        columns.extend(layout.sampled.iter().map(|&i| format!("{} (sample)", names[i])));
        let held: Vec<bool> = (0..columns.len()).map(|c| c >= commands).collect();
        Program::trace(&uniforms, &columns, |u, c| {
            let mut squashed = vec![Var::constant(0.0); space.len()];
            for (&i, &u) in free.iter().zip(u) {
                squashed[i] = space.squash(i, u);
            }
            let command: Vec<Var<'_>> = env
                .command
                .iter()
                .zip(c)
                .map(|(port, &out)| out * (0.5 * (port.hi - port.lo)) + 0.5 * (port.hi + port.lo))
                .collect();
            let mut outputs: Vec<_> = layout.sampled.iter().map(|&i| (names[i].clone(), squashed[i])).collect();
            if layout.efforts > 0 {
                let mut design = squashed;
                for (i, place) in self.placements.iter().enumerate() {
                    if let Some(value) = place.kept() {
                        design[i] = Var::constant(value);
                    }
                }
                for (&i, &sample) in layout.sampled.iter().zip(&c[commands + states..]) {
                    design[i] = sample;
                }
                // What the motors will do: a squashed output is within their limits anyway.
                let limit = |&c: &usize| {
                    let port = &env.command[c];
                    if self.squash { command[c] } else { command[c].clamp(port.lo, port.hi) }
                };
                let limited: Vec<Var<'_>> = reads.iter().map(limit).collect();
                let effort = self.law.effort_traced(&design, &limited, &c[commands..commands + states]);
                outputs.extend(self.law.ports().effort.iter().cloned().zip(effort));
            }
            outputs.extend(layout.commands.iter().map(|&c| (env.command[c].name.clone(), command[c])));
            outputs
        })
        .holding(&held)
    }

    fn component_noise(&self, env: &EnvSpec, layout: &ActionLayout) -> Vec<ComponentNoise> {
        let (noise, space) = (&self.noise, self.law.design());
        let component =
            |spread: &Spread, range: f64| ComponentNoise { log_std: (spread.std * range).ln(), anneal: spread.anneal };
        let design = layout.sampled.iter().map(|&i| {
            let (lo, hi) = space.bounds(i);
            component(&noise.design, hi - lo)
        });
        let effort = noise.effort[..layout.efforts].iter().map(|spread| component(spread, 1.0));
        let command = layout.commands.iter().map(|&c| {
            let port = &env.command[c];
            component(&noise.command[c], port.hi - port.lo)
        });
        design.chain(effort).chain(command).collect()
    }
}
