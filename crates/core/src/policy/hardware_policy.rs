//! The paper's policy: controller and hardware as one differentiable function.

use std::ops::Range;

use hwasp_diff::{Activation, Mlp, MlpTape, Program, ProgramTape};
use rand::RngExt;

use super::compose::{Composition, PolicySpec};
use super::spread::{CommandTape, Reparameterised};
use super::{NoiseSizes, Normalizer, ParamGroup, ParamKind, Policy, Rows};
use crate::design::DesignSpace;
use crate::environment::{CommandPort, EnvSpec};
use crate::placement::{ActionDecoder, PlacementError};
use crate::streams::{Purpose, stream};

/// A perceptron composed with a hardware law (paper, section 4): `π(a_new | s, a)·π(a | s)` as one Gaussian.
///
/// Parameters: the controller's, then (where they are running statistics) centre and scale of what it sees, then the
/// unbounded stand-ins of the design parameters that are not fixed, then (where they are trained) the log standard
/// deviations.
#[derive(Clone, Debug)]
pub struct HardwarePolicy {
    spec: PolicySpec,
    pub(super) controller: Mlp,
    pub(super) composition: Composition,
    groups: Vec<ParamGroup>,
    pub(super) commands: Vec<CommandPort>,
    observations: usize,
    state_dim: usize,
    context_dim: usize,
    start_shows_draw: bool,
}

/// Working memory of a [`HardwarePolicy`].
#[derive(Debug)]
pub struct PolicyTape {
    controller: MlpTape<f32>,
    law: ProgramTape<f32>,
    /// Inputs of the law: controller outputs, state, sampled design.
    columns: Vec<f32>,
    /// Their cotangents after a vjp, their tangents after a jvp.
    column_derivatives: Vec<f32>,
    /// Means, and their tangents.
    mean: Vec<f32>,
    mean_tangent: Vec<f32>,
    /// How the commands were drawn, where the controller tells their spread.
    drawn: Option<CommandTape>,
    /// Cotangents of the controller's outputs, row by row.
    output_cotangent: Vec<f32>,
    max_rows: usize,
}

impl HardwarePolicy {
    /// Composes a policy for an environment.
    pub fn new(spec: PolicySpec, env: &EnvSpec) -> Result<Self, PlacementError> {
        let composition = spec.compose(env)?;
        let (observations, space) = (env.observation.len(), spec.law.design());
        let mut sizes = vec![observations + if spec.sees_design { space.len() } else { 0 }];
        sizes.extend(&spec.hidden);
        sizes.push(env.command.len() * if spec.state_dependent_std { 2 } else { 1 });
        // Of a spread, what is squashed is the draw.
        let squash = spec.squash && !spec.state_dependent_std;
        let output = if squash { Activation::Tanh } else { Activation::Identity };
        let controller = Mlp::new(&sizes, spec.activation, output);
        let mut groups = Vec::new();
        let mut at = 0;
        let scaling = if spec.normalize.is_some() { 2 * env.observation.len() } else { 0 };
        let log_stds = if spec.noise.train { composition.layout.len() } else { 0 };
        for (kind, count) in [
            (ParamKind::Controller, controller.param_count()),
            (ParamKind::Normalizer, scaling),
            (ParamKind::Design, composition.free.len()),
            (ParamKind::LogStd, log_stds),
        ] {
            // Most policies have no running statistics, and their parameters are those of before there were any.
            if kind != ParamKind::Normalizer || count > 0 {
                groups.push(ParamGroup { kind, range: at..at + count });
            }
            at += count;
        }
        let commands = env.command.clone();
        let (state_dim, context_dim) = (env.state.len(), env.context.len());
        let mut drawn = composition.layout.sampled[..composition.layout.drawn].iter();
        let start_shows_draw = drawn.any(|&i| spec.sees_design || env.shaped_by.contains(&space.group_of(i).name));
        Ok(Self {
            spec,
            controller,
            composition,
            groups,
            commands,
            observations,
            state_dim,
            context_dim,
            start_shows_draw,
        })
    }

    /// What it was made of.
    pub fn spec(&self) -> &PolicySpec {
        &self.spec
    }

    /// Fresh parameters from the run's streams. The last layer's weights are scaled by `output_gain`.
    pub fn init(&self, seed: u64, output_gain: f64) -> Vec<f32> {
        let mut weights = stream(seed, Purpose::Weights, 0, 0);
        let mut params = self.controller.init(output_gain, || weights.random::<f64>());
        if self.spec.state_dependent_std {
            let (_, biases) = self.controller.last_layer();
            let log_stds = &mut params[biases][self.commands.len()..];
            for (bias, noise) in log_stds.iter_mut().zip(&self.spec.noise.command) {
                // Of half the range.
                *bias = (2.0 * noise.std).ln() as f32;
            }
        }
        if self.spec.normalize.is_some() {
            let scaling = self.spec.observation_center.iter().chain(&self.spec.observation_scale);
            params.extend(scaling.map(|&x| x as f32));
        }
        let u = self.space().sample_initial(&mut stream(seed, Purpose::Design, 0, 0));
        params.extend(self.composition.free.iter().map(|&i| u[i] as f32));
        if self.spec.noise.train {
            params.extend(self.composition.noise.iter().map(|n| n.log_std as f32));
        }
        params
    }

    /// The design space of the law.
    pub fn space(&self) -> &DesignSpace {
        self.spec.law.design()
    }

    /// The whole design in SI: what the parameters say, and the fixed values.
    pub fn design(&self, params: &[f32]) -> Vec<f64> {
        let mut design: Vec<f64> = self.spec.placements.iter().map(|place| place.kept().unwrap_or(0.0)).collect();
        for (&i, &u) in self.composition.free.iter().zip(&params[self.range(ParamKind::Design)]) {
            design[i] = self.space().squash(i, f64::from(u));
        }
        design
    }

    /// The design parameters that are not fixed, in the order of their stand-ins.
    pub fn free_design(&self) -> &[usize] {
        &self.composition.free
    }

    /// Where those stand-ins lie in the parameter vector.
    pub fn design_params(&self) -> Range<usize> {
        self.range(ParamKind::Design)
    }

    /// The controller's part of a parameter vector: its weights, and centre and scale of what it sees where they are
    /// parameters. They are all the parameters of the same controller on hardware that is fixed.
    pub fn controller_params<'p>(&self, params: &'p [f32]) -> &'p [f32] {
        &params[self.range(ParamKind::Controller).start..self.normalizer_params().end]
    }

    /// Where centre and scale of the observations lie in the parameter vector, the centres first; empty where they are not
    /// parameters.
    pub fn normalizer_params(&self) -> Range<usize> {
        let end = self.range(ParamKind::Controller).end;
        if self.spec.normalize.is_some() { self.range(ParamKind::Normalizer) } else { end..end }
    }

    /// What the controller sees of an observation, with these parameters.
    pub fn normalizer(&self, params: &[f32]) -> Normalizer {
        let spec = &self.spec;
        if spec.normalize.is_none() {
            return Normalizer::new(spec.observation_center.clone(), spec.observation_scale.clone(), None);
        }
        let wide = |values: &[f32]| values.iter().map(|&x| f64::from(x)).collect();
        let (center, scale) = params[self.normalizer_params()].split_at(spec.observation_center.len());
        Normalizer::new(wide(center), wide(scale), spec.normalize)
    }

    /// The parameters of the same controller without the spread of its commands ([`PolicySpec::state_dependent_std`]), from its
    /// part of a parameter vector: its means.
    pub fn without_spread(&self, controller_params: &[f32]) -> Vec<f32> {
        if !self.spec.state_dependent_std {
            return controller_params.to_vec();
        }
        let ((weights, biases), commands) = (self.controller.last_layer(), self.commands.len());
        let mut params = controller_params[..weights.start].to_vec();
        for row in controller_params[weights].chunks_exact(2 * commands) {
            params.extend_from_slice(&row[..commands]);
        }
        params.extend_from_slice(&controller_params[biases.clone()][..commands]);
        params.extend_from_slice(&controller_params[biases.end..]);
        params
    }

    /// The controller.
    pub fn controller(&self) -> &Mlp {
        &self.controller
    }

    /// The composed law, as drawn by `hwasp graph`.
    pub fn program(&self) -> &Program {
        &self.composition.program
    }

    /// The name of every action component.
    pub fn action_names(&self) -> &[String] {
        self.composition.program.output_names()
    }

    /// Where the parameters of a kind lie; empty where there are none.
    pub(super) fn range(&self, kind: ParamKind) -> Range<usize> {
        let group = self.groups.iter().find(|g| g.kind == kind);
        group.expect("a policy has a group of every kind but running statistics, if an empty one").range.clone()
    }

    /// Which component of the action a command is; none where the command is not sampled, as only the law reads it.
    pub fn action_of_command(&self, command: usize) -> Option<usize> {
        let layout = &self.composition.layout;
        let place = layout.commands.iter().position(|&c| c == command);
        place.map(|place| layout.len() - layout.commands.len() + place)
    }

    /// How strongly it explores with these parameters, at `progress` in [0, 1] of the training. Commands whose spread the controller
    /// [tells](PolicySpec::state_dependent_std) have no size that holds everywhere.
    pub fn noise_sizes(&self, params: &[f32], progress: f64) -> NoiseSizes {
        let mut log_std = vec![0.0; self.action_dim()];
        self.log_std(params, progress, &mut log_std);
        let (layout, space) = (&self.composition.layout, self.space());
        let (design, rest) = log_std.split_at(layout.sampled.len());
        let (effort, command) = rest.split_at(layout.efforts);
        let mean = |log_stds: &[f32], range: &dyn Fn(usize) -> f64| {
            let shares = log_stds.iter().enumerate().map(|(i, &log_std)| f64::from(log_std).exp() / range(i));
            shares.sum::<f64>() / log_stds.len() as f64
        };
        let port = |i: usize| &self.commands[layout.commands[i]];
        NoiseSizes {
            command: if self.spec.state_dependent_std { f64::NAN } else { mean(command, &|i| port(i).hi - port(i).lo) },
            effort: mean(effort, &|_| 1.0),
            design: mean(design, &|i| {
                let (lo, hi) = space.bounds(layout.sampled[i]);
                hi - lo
            }),
        }
    }

    /// What turns its actions into what an environment takes.
    pub fn action_decoder(&self) -> ActionDecoder {
        let law = (&self.spec.law, &self.composition.reads[..]);
        ActionDecoder::new(law, &self.spec.placements, &self.composition.layout, &self.commands)
    }

    /// How many numbers an observation has. The controller may see more: [`see_design`](Self::see_design).
    pub fn observations(&self) -> usize {
        self.observations
    }

    /// Writes what the controller sees of a design in SI: each parameter scaled to [-1, 1] by its limits. This is what follows
    /// the observation in its input, and nothing for a controller that [does not](PolicySpec::sees_design) see the design.
    pub fn see_design(&self, design: &[f64], out: &mut [f32]) {
        for (i, (out, value)) in out.iter_mut().zip(design).enumerate() {
            let (lo, hi) = self.space().bounds(i);
            *out = (2.0 * (value - lo) / (hi - lo) - 1.0) as f32;
        }
    }
}

/// Column `j` of rows of `width` numbers.
#[inline]
fn take_column(rows: &[f32], width: usize, j: usize, to: &mut [f32]) {
    if width == 1 {
        to.copy_from_slice(&rows[..to.len()]);
        return;
    }
    for (to, from) in to.iter_mut().zip(rows.chunks_exact(width)) {
        *to = from[j];
    }
}

/// Its inverse: writes column `j` of rows of `width` numbers.
#[inline]
fn put_column(column: &[f32], width: usize, j: usize, rows: &mut [f32]) {
    if width == 1 {
        rows.copy_from_slice(column);
        return;
    }
    for (to, from) in rows.chunks_exact_mut(width).zip(column) {
        to[j] = *from;
    }
}

impl PolicyTape {
    /// Lays out the law's columns of a block.
    fn fill_columns(&mut self, policy: &HardwarePolicy, rows: &Rows<'_>, noise: Option<&[f32]>) {
        let (count, stride) = (rows.count, self.max_rows);
        let commands = policy.commands.len();
        let (output, width) = self.controller.output();
        if let Some(drawn) = &mut self.drawn {
            drawn.draw((output, width), count, noise.map(|noise| (noise, rows.stride)), &mut self.columns);
        } else {
            for (j, column) in self.columns.chunks_exact_mut(stride).take(commands).enumerate() {
                take_column(output, width, j, &mut column[..count]);
            }
        }
        let state = self.columns[commands * stride..].chunks_exact_mut(stride).take(policy.state_dim);
        for (s, to) in state.enumerate() {
            to[..count].copy_from_slice(&rows.state[s * rows.stride..][..count]);
        }
        let sampled = self.columns[(commands + policy.state_dim) * stride..].chunks_exact_mut(stride);
        for (j, (to, &i)) in sampled.zip(&policy.composition.layout.sampled).enumerate() {
            // The law saw the sample within its limits.
            let (lo, hi) = policy.space().bounds(i);
            for (to, from) in to[..count].iter_mut().zip(&rows.action[j * rows.stride..]) {
                *to = from.clamp(lo as f32, hi as f32);
            }
        }
    }
}

impl HardwarePolicy {
    /// Controller and law over a block, with commands as they are drawn; without noise they are the means.
    fn pass(&self, rows: &Rows<'_>, noise: Option<&[f32]>, tape: &mut PolicyTape) {
        self.controller.forward(rows.obs, rows.count, &mut tape.controller);
        tape.fill_columns(self, rows, noise);
        let stride = tape.max_rows;
        self.composition.program.forward(&tape.columns, stride, rows.count, &mut tape.law, &mut tape.mean, stride);
    }

    /// The way back of the last [`pass`](Self::pass): of actions, and of log-probabilities where commands were drawn.
    fn pull(&self, rows: &Rows<'_>, cotangent: &[f32], of_log_prob: f32, tape: &mut PolicyTape) {
        let stride = tape.max_rows;
        self.composition.program.vjp(
            &tape.columns,
            stride,
            rows.count,
            cotangent,
            stride,
            &mut tape.law,
            &mut tape.column_derivatives,
            stride,
        );
        let (commands, width) = (self.commands.len(), self.controller.outputs());
        let outputs = &mut tape.output_cotangent[..rows.count * width];
        if let Some(drawn) = &tape.drawn {
            drawn.pull((&tape.columns, &tape.column_derivatives), of_log_prob, rows.count, outputs);
        } else {
            for (j, column) in tape.column_derivatives.chunks_exact(stride).take(commands).enumerate() {
                put_column(&column[..rows.count], commands, j, outputs);
            }
        }
        self.controller.vjp(rows.obs, outputs, &mut tape.controller);
    }
}

impl Reparameterised for HardwarePolicy {
    fn drawn_commands(&self) -> usize {
        self.commands.len()
    }

    fn sample<'t>(&self, rows: &Rows<'_>, noise: &[f32], tape: &'t mut PolicyTape) -> (&'t [f32], &'t [f32]) {
        self.pass(rows, Some(noise), tape);
        let drawn = tape.drawn.as_ref().expect("the controller of this policy tells no spread of its commands");
        (&tape.mean, &drawn.log_prob)
    }

    fn vjp_sample(&self, rows: &Rows<'_>, cotangent: &[f32], of_log_prob: f32, tape: &mut PolicyTape) {
        self.pull(rows, cotangent, of_log_prob, tape);
    }
}

impl Policy for HardwarePolicy {
    type Tape = PolicyTape;

    fn param_count(&self) -> usize {
        self.groups.last().map_or(0, |g| g.range.end)
    }

    fn groups(&self) -> &[ParamGroup] {
        &self.groups
    }

    fn action_dim(&self) -> usize {
        self.composition.layout.len()
    }

    fn obs_dim(&self) -> usize {
        self.controller.inputs()
    }

    fn state_dim(&self) -> usize {
        self.state_dim
    }

    fn context_dim(&self) -> usize {
        self.context_dim
    }

    fn action_limits(&self) -> Vec<Option<(f32, f32)>> {
        self.composition.layout.limits(self.space(), &self.commands)
    }

    fn drawn_actions(&self) -> usize {
        self.composition.layout.drawn
    }

    fn drawn_params(&self) -> Vec<usize> {
        let (layout, begin) = (&self.composition.layout, self.design_params().start);
        let free = &self.composition.free;
        let stand_in = |i| begin + free.iter().position(|free| free == i).expect("what is drawn is free");
        layout.sampled[..layout.drawn].iter().map(stand_in).collect()
    }

    fn seen_design(&self, params: &[f32]) -> Vec<f32> {
        let mut seen = vec![0.0; self.obs_dim() - self.observations];
        self.see_design(&self.design(params), &mut seen);
        seen
    }

    fn seen_draws(&self) -> &[usize] {
        let layout = &self.composition.layout;
        if self.spec.sees_design { &layout.sampled[..layout.drawn] } else { &[] }
    }

    fn start_shows_draw(&self) -> bool {
        self.start_shows_draw
    }

    fn log_std_params(&self) -> Option<Range<usize>> {
        self.spec.noise.train.then(|| self.range(ParamKind::LogStd))
    }

    fn log_std(&self, params: &[f32], progress: f64, out: &mut [f32]) {
        let trained = self.log_std_params().map(|range| &params[range]);
        for (j, (out, noise)) in out.iter_mut().zip(&self.composition.noise).enumerate() {
            let own = trained.map_or(noise.log_std, |t| f64::from(t[j]));
            *out = (own + noise.anneal.map_or(0.0, |a| a.log_offset(progress))) as f32;
        }
    }

    fn tape(&self, max_rows: usize) -> PolicyTape {
        let program = &self.composition.program;
        let columns = vec![0.0; program.column_names().len() * max_rows];
        let mean = vec![0.0; self.action_dim() * max_rows];
        PolicyTape {
            controller: self.controller.tape(max_rows),
            law: program.tape(max_rows),
            column_derivatives: columns.clone(),
            columns,
            mean_tangent: mean.clone(),
            mean,
            drawn: self
                .spec
                .state_dependent_std
                .then(|| CommandTape::new(self.commands.len(), self.spec.squash, max_rows)),
            output_cotangent: vec![0.0; self.controller.outputs() * max_rows],
            max_rows,
        }
    }

    fn bind(&self, params: &[f32], tape: &mut PolicyTape) {
        self.controller.bind(&params[self.range(ParamKind::Controller)], &mut tape.controller);
        self.composition.program.bind(&params[self.range(ParamKind::Design)], &mut tape.law);
    }

    fn clear(&self, tape: &mut PolicyTape) {
        self.controller.clear(&mut tape.controller);
        tape.law.clear_uniform_cotangents();
    }

    fn forward<'t>(&self, rows: &Rows<'_>, tape: &'t mut PolicyTape) -> &'t [f32] {
        self.pass(rows, None, tape);
        &tape.mean
    }

    fn vjp(&self, rows: &Rows<'_>, cotangent: &[f32], tape: &mut PolicyTape) {
        self.pull(rows, cotangent, 0.0, tape);
    }

    fn gradient(&self, tape: &mut PolicyTape, gradient: &mut [f32]) {
        gradient.fill(0.0);
        self.controller.gradient(&tape.controller, &mut gradient[self.range(ParamKind::Controller)]);
        self.composition.program.vjp_uniform(&mut tape.law, &mut gradient[self.range(ParamKind::Design)]);
    }

    fn add_cotangents(&self, tape: &mut PolicyTape, other: &PolicyTape) {
        tape.controller.add_cotangents(&other.controller);
        tape.law.add_uniform_cotangents(&other.law);
    }

    fn bind_tangent(&self, tangent: &[f32], tape: &mut PolicyTape) {
        self.controller.bind_tangent(&tangent[self.range(ParamKind::Controller)], &mut tape.controller);
        self.composition.program.bind_tangent(&tangent[self.range(ParamKind::Design)], &mut tape.law);
    }

    fn jvp<'t>(&self, rows: &Rows<'_>, tape: &'t mut PolicyTape) -> &'t [f32] {
        self.controller.jvp(rows.obs, &mut tape.controller);
        let stride = tape.max_rows;
        let (output, width) = tape.controller.tangent();
        tape.column_derivatives.fill(0.0);
        for (j, column) in tape.column_derivatives.chunks_exact_mut(stride).take(self.commands.len()).enumerate() {
            let column = &mut column[..rows.count];
            take_column(output, width, j, column);
            if let Some(drawn) = &tape.drawn {
                for (tangent, &command) in column.iter_mut().zip(&tape.columns[j * stride..]) {
                    *tangent *= drawn.slope(command);
                }
            }
        }
        self.composition.program.jvp(
            &tape.columns,
            &tape.column_derivatives,
            stride,
            rows.count,
            &mut tape.law,
            &mut tape.mean_tangent,
            stride,
        );
        &tape.mean_tangent
    }
}
