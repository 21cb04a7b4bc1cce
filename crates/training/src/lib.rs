//! Trainings: the assembly of an experiment, the loops that learn and search, evaluation and statistics.
//!
//! A program that embeds training makes three calls: [`resolve`](hwasp_experiment::resolve) for the experiment,
//! [`Assembly::new`], [`train`]. An [`Observer`] is told what happens on the way.

#![forbid(unsafe_code)]

mod assemble;
mod checkpoint;
mod error;
mod evaluate;
mod gradient;
mod learned;
mod metrics;
mod observer;
mod paired;
mod search;
pub mod stats;
mod train;

pub use assemble::{AssembleError, Assembly, total_name};
pub use checkpoint::Checkpoint;
pub use error::TrainError;
pub use evaluate::{
    EvaluateError, Evaluation, MeanInterval, SuccessRate, evaluate, evaluate_in, evaluate_native, held_out, sampler,
};
pub use gradient::repeat;
pub use hwasp_problem::World;
pub use learned::TRAILING;
pub use metrics::MetricsRow;
pub use observer::{Event, Fault, Observer, ObserverError};
pub use paired::{Change, Reference};
pub use train::{Trained, beginning, params_at, train, train_from};
