//! Learners: generalised advantages, value baselines, PPO. Searches without gradients: CMA-ES, random search. They see
//! policies, batches and scores, never an environment.

#![forbid(unsafe_code)]

mod adam;
mod baseline;
mod gae;
mod learner;
mod minibatch;
mod ppo;
mod search;

pub use adam::{Adam, AdamConfig};
pub use baseline::{Baseline, BaselineConfig, LinearBaseline, MlpBaseline, MlpBaselineConfig};
pub use gae::{Advantages, advantages, normalize};
pub use learner::{LearnError, Learner, UpdateMetrics};
pub use ppo::{Ppo, PpoConfig, PpoSettings};
pub use search::{
    Ars, ArsConfig, ArsState, Cmaes, CmaesConfig, CmaesState, Scored, Search, SearchError, StateFilter, Stop,
};
