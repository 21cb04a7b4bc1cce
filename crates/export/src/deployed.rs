//! The trained robot where it has to work.

use std::path::Path;
use std::sync::Arc;

use hwasp_core::{Actor, EnvSpec, HardwarePolicy, Normalizer, PolicySpec};
use hwasp_diff::Activation;
use hwasp_experiment::{Catalogue, Experiment};
use hwasp_runs::SavedRun;
use hwasp_training::{AssembleError, Assembly, World};

use crate::error::ExportError;

/// Rows in which [`Deployed::act`] works.
const BLOCK: usize = 64;

/// The deterministic controller on the design as built: what `hwasp eval` evaluates. It is the same for all methods, for
/// nothing of the design is left to move: where the design was in the graph or in the action, it is fixed now.
pub struct Deployed {
    pub(super) spec: Experiment,
    pub(super) world: World,
    pub(super) env: EnvSpec,
    pub(super) policy: Arc<HardwarePolicy>,
    /// Where the law's commands are among the environment's.
    pub(super) reads: Vec<usize>,
    /// The controller's parameters: its layers', and centre and scale of what it sees where they are among them. One that saw the
    /// design needs no such input any more: the hardware stays as it is.
    pub(super) params: Vec<f32>,
    /// SI, as built.
    pub(super) design: Vec<f64>,
}

/// One layer of the controller.
#[derive(Clone, Copy, Debug)]
pub struct Layer<'a> {
    /// How many numbers go in.
    pub inputs: usize,
    /// How many come out.
    pub outputs: usize,
    /// `[inputs × outputs]`.
    pub weight: &'a [f32],
    /// One for each output.
    pub bias: &'a [f32],
    /// What is done to the sums.
    pub activation: Activation,
}

impl Deployed {
    /// That of a run folder.
    pub fn open(path: &Path, catalogue: &Catalogue) -> Result<Self, ExportError> {
        let saved = SavedRun::open(path, catalogue)?;
        Ok(Self::new(saved.assembly(), &saved.params()?)?)
    }

    /// The experiment of the run.
    pub fn spec(&self) -> &Experiment {
        &self.spec
    }

    /// What the controller sees and commands: names, units, limits, period.
    pub fn env(&self) -> &EnvSpec {
        &self.env
    }

    /// The policy that acts.
    pub fn policy(&self) -> &HardwarePolicy {
        &self.policy
    }

    /// Its parameters.
    pub fn params(&self) -> &[f32] {
        &self.params
    }

    /// What the controller commands at these observations, rows one after the other: within the motors' limits.
    pub fn commands(&self, observations: &[f32]) -> Vec<f64> {
        let rows = observations.len() / self.env.observation.len().max(1);
        self.act(observations, &vec![0.0; rows * self.env.state.len()]).0
    }

    /// The design as built, SI.
    pub fn design(&self) -> &[f64] {
        &self.design
    }

    /// That of an assembly with these parameters.
    ///
    /// # Errors
    /// Where the design as built has no place in the world where it has to work.
    pub fn new(assembly: &Assembly, params: &[f32]) -> Result<Self, AssembleError> {
        let world = assembly.worlds.deployment.clone();
        let design = assembly.worlds.training.law.as_built(&assembly.policy.design(params));
        let env = world.make.make(None).spec().clone();
        let mut policy = assembly.deployed(&design)?;
        let mut params = policy.without_spread(assembly.policy.controller_params(params));
        let alone = PolicySpec { state_dependent_std: false, ..policy.spec().clone() };
        policy = HardwarePolicy::new(alone.clone(), &env)?;
        if alone.sees_design {
            params = with_design_folded(&policy, &params, &design);
            policy = HardwarePolicy::new(PolicySpec { sees_design: false, ..alone }, &env)?;
        }
        let reads = world.law.reads(&env.command).expect("the policy was composed of this law and these commands");
        Ok(Self { spec: assembly.experiment().clone(), env, policy: Arc::new(policy), reads, params, world, design })
    }

    /// What the controller sees of an observation.
    pub fn normalizer(&self) -> Normalizer {
        self.policy.normalizer(&self.params)
    }

    /// What the last layer does to its sums.
    pub(super) fn output_activation(&self) -> Activation {
        if self.policy.spec().squash { Activation::Tanh } else { Activation::Identity }
    }

    /// The controller's layers, first to last.
    pub fn layers(&self) -> Vec<Layer<'_>> {
        let sizes = self.policy.controller().sizes();
        let (hidden, last) = (self.policy.spec().activation, sizes.len() - 2);
        let mut rest = &self.params[..];
        let mut layers = Vec::new();
        for (l, size) in sizes.windows(2).enumerate() {
            let (weight, after) = rest.split_at(size[0] * size[1]);
            let (bias, after) = after.split_at(size[1]);
            let activation = if l == last { self.output_activation() } else { hidden };
            layers.push(Layer { inputs: size[0], outputs: size[1], weight, bias, activation });
            rest = after;
        }
        layers
    }

    /// What the program itself does at these observations and states, rows one after the other: commands within the motors'
    /// limits, and the law's efforts.
    pub(super) fn act(&self, observations: &[f32], states: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let (seen, state_dim) = (self.env.observation.len(), self.env.state.len());
        let mut actor = Actor::new(&self.policy, &self.params, 1.0, BLOCK);
        let normalizer = self.normalizer();
        let (mut commands, mut efforts) = (Vec::new(), Vec::new());
        let mut inputs = vec![0.0_f32; BLOCK * seen];
        let mut columns = vec![0.0; BLOCK * state_dim];
        let mut effort = vec![0.0; self.env.effort.len()];
        for (block, observations) in observations.chunks(BLOCK * seen).enumerate() {
            let rows = observations.len() / seen;
            // A law may read no state.
            let state = |r: usize| &states[(block * BLOCK + r) * state_dim..][..state_dim];
            for (seen, input) in observations.chunks_exact(seen).zip(inputs.chunks_exact_mut(seen)) {
                let seen: Vec<f64> = seen.iter().map(|&x| f64::from(x)).collect();
                normalizer.apply(&seen, input);
            }
            for r in 0..rows {
                for (s, &x) in state(r).iter().enumerate() {
                    columns[s * BLOCK + r] = x;
                }
            }
            actor.act(&inputs[..rows * seen], &columns, rows, None);
            for r in 0..rows {
                let limited = actor.action(r).iter().zip(&self.env.command).map(|(c, port)| c.clamp(port.lo, port.hi));
                let at = commands.len();
                commands.extend(limited);
                let read: Vec<f64> = self.reads.iter().map(|&c| commands[at + c]).collect();
                self.world.law.effort(&self.design, &read, state(r), &mut effort);
                efforts.extend_from_slice(&effort);
            }
        }
        (commands, efforts)
    }
}

/// The parameters of a controller that does not see the design, and does what this one does on hardware of `design` (SI): what
/// its first layer makes of the design is the same at every step, and goes into the biases.
fn with_design_folded(policy: &HardwarePolicy, params: &[f32], design: &[f64]) -> Vec<f32> {
    let width = policy.controller().sizes()[1];
    let mut seen = vec![0.0; design.len()];
    policy.see_design(design, &mut seen);
    let (kept, rest) = params.split_at(policy.observations() * width);
    let (of_design, rest) = rest.split_at(seen.len() * width);
    let mut folded = params.to_vec();
    folded.truncate(kept.len());
    folded.extend(rest);
    for (j, bias) in folded[kept.len()..][..width].iter_mut().enumerate() {
        let added = seen.iter().zip(of_design.chunks_exact(width)).map(|(&x, row)| f64::from(x) * f64::from(row[j]));
        *bias = (f64::from(*bias) + added.sum::<f64>()) as f32;
    }
    folded
}
