//! `[learner]`, `[ppo]` and `[baseline]`: what improves the policy.

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

/// `[learner]`: `algorithm` ("ppo").
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

/// `[baseline]`.
///
/// | key | default | meaning | limits |
/// |---|---|---|---|
/// | `kind` | "mlp" | `mlp` or `linear` | |
/// | `hidden` | [32, 32] | widths of the network's hidden layers | up to 16 of 1 to 4096 |
/// | `learning_rate` | 1e-3 | Adam's | 1e-9 to 1 |
/// | `epochs` | 4 | passes over a batch, in PPO's minibatches | 1 to 1000 |
/// | `privileged` | false | whether it also sees the law's state, which the controller does not | |
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
    /// Whether it also sees the law's state.
    pub privileged: bool,
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
        let sound = s.reader.sound(&["train.episodes_per_iteration", "train.episode_steps", "task.horizon"]);
        if spec.minibatch_rows > rows && sound {
            let message = format!("ppo.minibatch_rows = {} is more than the {}", spec.minibatch_rows, train.portion());
            s.clash("minibatch_rows", message, "0 takes the whole batch at once");
        }
        s.finish();
        spec
    }
}

impl BaselineSpec {
    pub(super) fn read(mut s: Section<'_>) -> Self {
        let spec = Self {
            kind: s.choice("kind", BaselineKind::ALL).unwrap_or(BaselineKind::Mlp),
            hidden: s.counts("hidden", &[32, 32], MOST_LAYERS, &(1..=WIDEST_LAYER)),
            learning_rate: s.number("learning_rate", 1e-3, 1e-9..=1.0),
            epochs: s.count("epochs", 4, 1..=1000),
            privileged: s.flag("privileged", false),
            ridge: s.number("ridge", 1e-5, 0.0..=1e6),
        };
        s.finish();
        spec
    }
}
