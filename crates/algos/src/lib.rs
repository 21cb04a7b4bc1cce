//! Learners with gradients: generalised advantages, value baselines, PPO, TRPO. Searches without gradients: CMA-ES, augmented
//! random search. They see policies, batches and scores, and never an environment.
//!
//! A [`LearnerKind`] gives a learner its name, its settings and their description, so that experiments can ask for it.

#![forbid(unsafe_code)]

mod adam;
mod archive;
mod baseline;
mod draws;
mod gae;
mod learner;
mod learner_kind;
mod metrics;
mod minibatch;
mod ppo;
mod search;
mod settings;
mod surrogate;
#[cfg(test)]
mod tests;
mod trpo;

pub use adam::{Adam, AdamConfig, group_rates};
pub use archive::{Archive, Array, Element, Exchange, Persist, StateError};
pub use baseline::{Baseline, BaselineConfig, InputDims, LinearBaseline, MlpBaseline, MlpBaselineConfig};
pub use gae::{AdvantageConfig, Advantages, Foresight, advantages, normalize};
pub use learner::{LearnError, Learner};
pub use learner_kind::{LearnerKind, LearnerSetup, PpoKind, SettingFault, TrpoKind, own};
pub use metrics::Metrics;
pub use minibatch::BLOCK;
pub use ppo::{Ppo, PpoConfig, PpoSettings};
pub use search::{
    Ars, ArsConfig, Bo, BoConfig, Cmaes, CmaesConfig, RandomConfig, RandomSearch, Search, SearchError, StateFilter,
    Stop,
};
pub use settings::{
    ArsSettings, ArsVariant, BaselineKind, BaselineSettings, MOST_LAYERS, MOST_ROWS, RATES, WIDEST_LAYER,
};
pub use trpo::{FisherRows, Solution, Trpo, TrpoConfig, TrpoSettings, conjugate_gradient};
