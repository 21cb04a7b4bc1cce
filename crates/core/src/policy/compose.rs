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
    /// The controller sees (observation - centre)/scale, per component.
    pub observation_center: Vec<f64>,
    /// See `observation_center`.
    pub observation_scale: Vec<f64>,
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
                Placement::Graph | Placement::Action => continue,
            };
            if !(lo..=hi).contains(&value) {
                return Err(PlacementError::Outside { name: space.names()[i].clone(), value, lo, hi });
            }
        }
        let names = |ports: &[Port]| ports.iter().map(|p| p.name.clone()).collect::<Vec<_>>();
        let commands: Vec<_> = env.command.iter().map(|p| p.name.clone()).collect();
        for (what, law, environment) in [
            ("command", &law.ports().command, commands),
            ("state", &law.ports().state, names(&env.state)),
            ("effort", &law.ports().effort, names(&env.effort)),
        ] {
            if *law != environment {
                return Err(PlacementError::Ports { what, law: law.clone(), environment });
            }
        }
        if self.noise.command.len() != env.command.len() {
            return Err(PlacementError::Noise { given: self.noise.command.len(), needed: env.command.len() });
        }
        let layout = ActionLayout::new(&self.placements, env.effort.len(), env.command.len());
        let free: Vec<usize> = (0..space.len()).filter(|&i| self.placements[i].kept().is_none()).collect();
        let mut composition = Composition { program: self.trace(env, &layout, &free), layout, free, noise: Vec::new() };
        composition.noise = self.component_noise(env, &composition.layout);
        Ok(composition)
    }

    fn trace(&self, env: &EnvSpec, layout: &ActionLayout, free: &[usize]) -> Program {
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
                let limited: Vec<Var<'_>> = if self.squash {
                    command.clone()
                } else {
                    command.iter().zip(&env.command).map(|(c, p)| c.clamp(p.lo, p.hi)).collect()
                };
                let effort = self.law.effort_traced(&design, &limited, &c[commands..commands + states]);
                outputs.extend(self.law.ports().effort.iter().cloned().zip(effort));
            }
            outputs.extend(env.command.iter().map(|p| p.name.clone()).zip(command));
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
        let effort = (0..layout.efforts).map(|_| component(&noise.effort, 1.0));
        let command = env.command.iter().zip(&noise.command).map(|(port, spread)| component(spread, port.hi - port.lo));
        design.chain(effort).chain(command).collect()
    }
}
