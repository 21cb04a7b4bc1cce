//! Policies: from parameters to a diagonal Gaussian over actions.
//!
//! [`Policy`] is all that a gradient learner knows. [`HardwarePolicy`] is the paper's: a perceptron composed with a
//! hardware law, each design parameter in the graph, in the action at every step or once an episode, or fixed.

mod actor;
mod compose;
mod hardware_policy;
mod noise;
mod normalizer;
mod spread;

pub use actor::Actor;
pub use compose::PolicySpec;
pub use hardware_policy::{HardwarePolicy, PolicyTape};
pub use noise::{Anneal, Noise, NoiseSizes, Spread};
pub use normalizer::Normalizer;
pub use spread::Reparameterised;

use std::ops::Range;

/// What the parameters of a group are.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ParamKind {
    /// Weights and biases of the controller.
    Controller,
    /// Centre and scale of every observation, one after the other, where they are running statistics: nothing learns
    /// them, and whoever gathers the statistics writes them.
    Normalizer,
    /// Unbounded stand-ins of the design parameters that are not fixed.
    Design,
    /// Log standard deviations of the action's components.
    LogStd,
}

impl ParamKind {
    /// Its name in files and messages.
    pub fn name(self) -> &'static str {
        match self {
            Self::Controller => "controller",
            Self::Normalizer => "normalizer",
            Self::Design => "design",
            Self::LogStd => "log_std",
        }
    }
}

/// Parameters that are treated alike by an optimiser.
#[derive(Clone, Debug, PartialEq)]
pub struct ParamGroup {
    /// What they are.
    pub kind: ParamKind,
    /// Where they lie in the parameter vector.
    pub range: Range<usize>,
}

/// A block of rows of a batch, for one pass.
#[derive(Clone, Copy, Debug)]
pub struct Rows<'a> {
    /// The number of rows, B.
    pub count: usize,
    /// Controller inputs `[B × obs_dim]`, row by row.
    pub obs: &'a [f32],
    /// The law's state `[state_dim × stride]`, column by column.
    pub state: &'a [f32],
    /// The actions that were taken `[action_dim × stride]`, column by column: the law of a policy that places some of its
    /// design in the action reads that part of them.
    pub action: &'a [f32],
    /// The distance between columns, at least B.
    pub stride: usize,
}

/// A differentiable function from parameters to the mean `[A × B]` and log standard deviation `[A]` of a diagonal Gaussian.
///
/// Work goes in blocks: bind parameters once; then per block forward and vjp (or jvp); then collect the gradient.
pub trait Policy: Send + Sync {
    /// Working memory.
    type Tape: Send;

    /// The length of the parameter vector.
    fn param_count(&self) -> usize;
    /// How the parameter vector divides.
    fn groups(&self) -> &[ParamGroup];
    /// The number of action components, A.
    fn action_dim(&self) -> usize;
    /// The number of controller inputs.
    fn obs_dim(&self) -> usize;
    /// The number of state columns.
    fn state_dim(&self) -> usize;
    /// The number of quantities that tell a baseline, and nobody else, what an episode is about.
    fn context_dim(&self) -> usize;
    /// Limits of each component of the action, SI: beyond them it does to the world what it does there. None of a component that
    /// has none, such as an effort.
    fn action_limits(&self) -> Vec<Option<(f32, f32)>>;
    /// How many of the action's components, the first ones, are drawn once an episode and held. Their means depend on no row,
    /// and their probability counts once an episode ([`Episode::log_prob`](crate::Episode::log_prob)), not in every row.
    fn drawn_actions(&self) -> usize {
        0
    }
    /// Where the stand-ins of their means lie among the parameters, in the same order.
    fn drawn_params(&self) -> Vec<usize> {
        Vec::new()
    }
    /// What the controller sees of the design with these parameters: its last inputs. Nothing where it sees none.
    fn seen_design(&self, _params: &[f32]) -> Vec<f32> {
        Vec::new()
    }
    /// Which of those inputs show what was drawn for the episode.
    fn seen_draws(&self) -> &[usize] {
        &[]
    }
    /// Whether what there is to see at the start of an episode tells what was drawn for it. A value of the start is no
    /// baseline for the draw then: it would take away what the draw is worth.
    fn start_shows_draw(&self) -> bool {
        false
    }
    /// Where the log standard deviations lie in the parameter vector; `None` where they are not trained.
    fn log_std_params(&self) -> Option<Range<usize>>;
    /// The log standard deviations `[A]` at `progress` in [0, 1] of the training.
    fn log_std(&self, params: &[f32], progress: f64, out: &mut [f32]);

    /// Working memory for blocks of up to `max_rows` rows.
    fn tape(&self, max_rows: usize) -> Self::Tape;
    /// Takes over a parameter vector and clears the sums of cotangents.
    fn bind(&self, params: &[f32], tape: &mut Self::Tape);
    /// Clears the sums of cotangents and keeps the parameters.
    fn clear(&self, tape: &mut Self::Tape);
    /// The means of a block, `[A × tape rows]` column by column; the stride is the tape's `max_rows`.
    fn forward<'t>(&self, rows: &Rows<'_>, tape: &'t mut Self::Tape) -> &'t [f32];
    /// Adds the gradient of Σ cotangent·mean over the block of the last forward; `cotangent` is laid out as the means.
    fn vjp(&self, rows: &Rows<'_>, cotangent: &[f32], tape: &mut Self::Tape);
    /// Writes the gradient summed over all blocks since [`bind`](Self::bind); zero for the log standard deviations.
    fn gradient(&self, tape: &mut Self::Tape, gradient: &mut [f32]);
    /// Adds the sums of cotangents of a tape that worked on other blocks.
    fn add_cotangents(&self, tape: &mut Self::Tape, other: &Self::Tape);
    /// Takes over a direction in parameter space.
    fn bind_tangent(&self, tangent: &[f32], tape: &mut Self::Tape);
    /// The means' tangents along it over the block of the last forward, laid out as the means.
    fn jvp<'t>(&self, rows: &Rows<'_>, tape: &'t mut Self::Tape) -> &'t [f32];
}
