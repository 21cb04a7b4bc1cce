//! `[learner]`, `[ppo]`, `[trpo]` and `[baseline]`: what improves the policy.

use serde::Serialize;

use super::controller::{MOST_LAYERS, WIDEST_LAYER};
use super::names::named;
use super::section::Section;
use super::train::{MOST_ROWS, TrainSpec};

named! {
    /// What improves the policy.
    pub enum Algorithm {
        /// Proximal policy optimisation.
        Ppo = "ppo",
        /// Trust region policy optimisation.
        Trpo = "trpo",
    }
}

named! {
    /// What estimates values.
    pub enum BaselineKind {
        /// A network.
        Mlp = "mlp",
        /// Ridge regression on features of state and time.
        Linear = "linear",
    }
}

/// `[learner]`.
///
/// | key | default | meaning | limits |
/// |---|---|---|---|
/// | `algorithm` | "ppo" | what improves the policy | `ppo` or `trpo` |
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct LearnerSpec {
    /// What improves the policy.
    pub algorithm: Algorithm,
}

/// `[ppo]` (Schulman et al. 2017).
///
/// | key | default | meaning | limits |
/// |---|---|---|---|
/// | `discount` | 0.99 | gamma | 0 to 1 |
/// | `gae_lambda` | 0.95 | lambda | 0 to 1 |
/// | `clip_ratio` | 0.2 | epsilon | 0.001 to 1 |
/// | `epochs` | 4 | passes over a batch | 1 to 1000 |
/// | `minibatch_rows` | 1000 | rows of a minibatch; 0: the whole batch | 0 to the rows of an iteration |
/// | `learning_rate` | 1e-3 | Adam's | 1e-9 to 1 |
/// | `learning_rate_final` | 1.0 | fraction of it at the end of a linear decay | 0 to 1 |
/// | `adam_epsilon` | 1e-8 | Adam's | 1e-16 to 0.1 |
/// | `entropy_coef` | 0.0 | weight of the entropy | 0 to 10 |
/// | `max_grad_norm` | 0.5 | longest gradient; 0: any | 0 to 1e6 |
/// | `target_kl` | 0.0 | ends the epochs beyond; 0: never | 0 to 100 |
/// | `normalize_advantages` | true | centred and scaled per batch | |
/// | `bootstrap_truncated` | true | whether a cut episode has a future | |
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PpoSpec {
    /// Discount, gamma.
    pub discount: f64,
    /// Lambda of generalised advantage estimation.
    pub gae_lambda: f64,
    /// How far the probability ratio may leave 1, epsilon.
    pub clip_ratio: f64,
    /// Passes over a batch.
    pub epochs: usize,
    /// Rows of a minibatch; 0 for the whole batch.
    pub minibatch_rows: usize,
    /// Adam's learning rate.
    pub learning_rate: f64,
    /// Fraction of it at the end of training; 1 for a constant one.
    pub learning_rate_final: f64,
    /// Adam's epsilon.
    pub adam_epsilon: f64,
    /// Weight of the entropy in the objective.
    pub entropy_coef: f64,
    /// Longer gradients are shortened to this; 0 for never.
    pub max_grad_norm: f64,
    /// A mean KL divergence beyond this ends an iteration's epochs; 0 for never.
    pub target_kl: f64,
    /// Whether advantages are centred and scaled per batch.
    pub normalize_advantages: bool,
    /// Whether the value of the last state stands for the future of a truncated episode.
    pub bootstrap_truncated: bool,
}

/// `[trpo]` (Schulman et al. 2015).
///
/// | key | default | meaning | limits |
/// |---|---|---|---|
/// | `discount` | that of `[ppo]` | gamma | 0 to 1 |
/// | `gae_lambda` | that of `[ppo]` | lambda | 0 to 1 |
/// | `max_kl` | 0.01 | the most mean KL divergence of an update, nats | 1e-9 to 10 |
/// | `max_kl_final` | 1.0 | fraction of it at the end of a linear decay | 1e-6 to 1 |
/// | `fisher_rows` | 1.0 | rows that the curvature is taken of: a share of the batch, or above 1 how many | 1e-6 to 1e7 |
/// | `cg_iterations` | 10 | most steps of conjugate gradients | 1 to 1000 |
/// | `cg_tolerance` | 1e-10 | they end where the squared norm of the residual is below | 0 to 1 |
/// | `damping` | 1e-5 | added to the diagonal of the curvature, in units of the parameters | 0 to 1e3 |
/// | `design_scale` | 1.0 | unit of the design's parameters in the equations of a step: the larger, the further the design goes for the same KL | 1e-3 to 1e3 |
/// | `backtrack_ratio` | 0.8 | what a step that does not hold is shortened by | 0.01 to 0.99 |
/// | `backtracks` | 15 | steps tried, the full one among them | 1 to 100 |
/// | `normalize_advantages` | that of `[ppo]` | centred and scaled per batch | |
/// | `bootstrap_truncated` | that of `[ppo]` | whether a cut episode has a future | |
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TrpoSpec {
    /// Discount, gamma.
    pub discount: f64,
    /// Lambda of generalised advantage estimation.
    pub gae_lambda: f64,
    /// The most mean KL divergence of an update, nats.
    pub max_kl: f64,
    /// Fraction of it at the end of a linear decay.
    pub max_kl_final: f64,
    /// Rows that the curvature is taken of: up to 1 a share of the batch, above it how many.
    pub fisher_rows: f64,
    /// Most steps of conjugate gradients.
    pub cg_iterations: usize,
    /// Conjugate gradients end where the squared norm of the residual is below this.
    pub cg_tolerance: f64,
    /// Added to the diagonal of the curvature, in units of the parameters.
    pub damping: f64,
    /// Unit of the design's parameters in the equations of a step.
    pub design_scale: f64,
    /// What a step that does not hold is shortened by.
    pub backtrack_ratio: f64,
    /// Steps tried, the full one among them.
    pub backtracks: usize,
    /// Whether advantages are centred and scaled per batch.
    pub normalize_advantages: bool,
    /// Whether the value of the last state stands for the future of a truncated episode.
    pub bootstrap_truncated: bool,
}

/// `[baseline]`.
///
/// | key | default | meaning | limits |
/// |---|---|---|---|
/// | `kind` | "mlp" | `mlp` or `linear` | |
/// | `hidden` | [32, 32] | widths of the network's hidden layers | up to 16 of 1 to 4096 |
/// | `learning_rate` | 1e-3 | Adam's | 1e-9 to 1 |
/// | `epochs` | 4 | passes over a batch | 1 to 1000 |
/// | `minibatch_rows` | that of `[ppo]` | rows of a minibatch of the network; 0: the whole batch | 0 to the rows of an iteration |
/// | `privileged` | false | whether it also sees the law's state, which the controller does not | |
/// | `context` | false | whether it also sees what an episode is about and no sensor tells: of a grasp the object's shape, mass, friction and inertia | |
/// | `ridge` | 1e-5 | regularisation of the linear one | 0 to 1e6 |
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BaselineSpec {
    /// What estimates values.
    pub kind: BaselineKind,
    /// Widths of the network's hidden layers.
    pub hidden: Vec<usize>,
    /// Adam's learning rate.
    pub learning_rate: f64,
    /// Passes over a batch.
    pub epochs: usize,
    /// Rows of a minibatch; 0 for the whole batch.
    pub minibatch_rows: usize,
    /// Whether it also sees the law's state.
    pub privileged: bool,
    /// Whether it also sees what an episode is about.
    pub context: bool,
    /// Regularisation of the linear one.
    pub ridge: f64,
}

impl LearnerSpec {
    pub(super) fn read(mut s: Section<'_>) -> Self {
        let spec = Self { algorithm: s.choice("algorithm", Algorithm::ALL).unwrap_or(Algorithm::Ppo) };
        s.finish();
        spec
    }
}

impl PpoSpec {
    /// Reads the table for iterations of so many rows.
    pub(super) fn read(mut s: Section<'_>, train: &TrainSpec) -> Self {
        let rows = train.rows();
        let spec = Self {
            discount: s.number("discount", 0.99, 0.0..=1.0),
            gae_lambda: s.number("gae_lambda", 0.95, 0.0..=1.0),
            clip_ratio: s.number("clip_ratio", 0.2, 1e-3..=1.0),
            epochs: s.count("epochs", 4, 1..=1000),
            minibatch_rows: s.count("minibatch_rows", rows.min(1000), 0..=MOST_ROWS),
            learning_rate: s.number("learning_rate", 1e-3, 1e-9..=1.0),
            learning_rate_final: s.number("learning_rate_final", 1.0, 0.0..=1.0),
            adam_epsilon: s.number("adam_epsilon", 1e-8, 1e-16..=0.1),
            entropy_coef: s.number("entropy_coef", 0.0, 0.0..=10.0),
            max_grad_norm: s.number("max_grad_norm", 0.5, 0.0..=1e6),
            target_kl: s.number("target_kl", 0.0, 0.0..=100.0),
            normalize_advantages: s.flag("normalize_advantages", true),
            bootstrap_truncated: s.flag("bootstrap_truncated", true),
        };
        check_minibatch(&mut s, "ppo", spec.minibatch_rows, train);
        s.finish();
        spec
    }
}

/// Refuses minibatches that an iteration does not fill.
fn check_minibatch(s: &mut Section<'_>, table: &str, minibatch_rows: usize, train: &TrainSpec) {
    let sound = s.reader.sound(&["train.episodes_per_iteration", "train.episode_steps", "task.horizon"]);
    if minibatch_rows > train.rows() && sound {
        let message = format!("{table}.minibatch_rows = {minibatch_rows} is more than the {}", train.portion());
        s.clash("minibatch_rows", message, "0 takes the whole batch at once");
    }
}

impl TrpoSpec {
    /// Reads the table; what it does not say of advantages is as PPO has it.
    pub(super) fn read(mut s: Section<'_>, ppo: &PpoSpec) -> Self {
        let spec = Self {
            discount: s.number("discount", ppo.discount, 0.0..=1.0),
            gae_lambda: s.number("gae_lambda", ppo.gae_lambda, 0.0..=1.0),
            max_kl: s.number("max_kl", 0.01, 1e-9..=10.0),
            max_kl_final: s.number("max_kl_final", 1.0, 1e-6..=1.0),
            fisher_rows: s.number("fisher_rows", 1.0, 1e-6..=MOST_ROWS as f64),
            cg_iterations: s.count("cg_iterations", 10, 1..=1000),
            cg_tolerance: s.number("cg_tolerance", 1e-10, 0.0..=1.0),
            damping: s.number("damping", 1e-5, 0.0..=1e3),
            design_scale: s.number("design_scale", 1.0, 1e-3..=1e3),
            backtrack_ratio: s.number("backtrack_ratio", 0.8, 0.01..=0.99),
            backtracks: s.count("backtracks", 15, 1..=100),
            normalize_advantages: s.flag("normalize_advantages", ppo.normalize_advantages),
            bootstrap_truncated: s.flag("bootstrap_truncated", ppo.bootstrap_truncated),
        };
        if spec.fisher_rows > 1.0 && spec.fisher_rows.fract() != 0.0 && s.reader.sound(&["trpo.fisher_rows"]) {
            let message = format!("trpo.fisher_rows = {} is neither a share nor a number of rows", spec.fisher_rows);
            s.clash("fisher_rows", message, "up to 1 it is a share of the batch, above it a whole number of rows");
        }
        s.finish();
        spec
    }
}

impl BaselineSpec {
    /// Reads the table for iterations of so many rows.
    pub(super) fn read(mut s: Section<'_>, ppo: &PpoSpec, train: &TrainSpec) -> Self {
        let spec = Self {
            kind: s.choice("kind", BaselineKind::ALL).unwrap_or(BaselineKind::Mlp),
            hidden: s.counts("hidden", &[32, 32], MOST_LAYERS, &(1..=WIDEST_LAYER)),
            learning_rate: s.number("learning_rate", 1e-3, 1e-9..=1.0),
            epochs: s.count("epochs", 4, 1..=1000),
            minibatch_rows: s.count("minibatch_rows", ppo.minibatch_rows, 0..=MOST_ROWS),
            privileged: s.flag("privileged", false),
            context: s.flag("context", false),
            ridge: s.number("ridge", 1e-5, 0.0..=1e6),
        };
        // What it takes over from PPO is judged there.
        if s.origin("minibatch_rows").is_some() {
            check_minibatch(&mut s, "baseline", spec.minibatch_rows, train);
        }
        s.finish();
        spec
    }
}
