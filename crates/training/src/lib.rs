//! Trainings: the assembly of an experiment, the loops that learn and search, evaluation and statistics.
//!
//! A program that embeds training makes three calls: [`resolve`](hwasp_experiment::resolve) for the experiment,
//! [`Assembly::new`], [`train`]. An [`Observer`] is told what happens on the way. A [`Collector`] runs the episodes: threads
//! of this process, or [`Worker`]s elsewhere.

#![forbid(unsafe_code)]

mod assemble;
mod checkpoint;
pub mod collect;
mod error;
mod evaluate;
mod evaluation;
mod gradient;
mod learned;
mod machine;
mod metrics;
mod observer;
mod paired;
mod polish;
mod returns;
mod running;
mod search;
pub mod stats;
mod train;
mod trainer;
mod trial;
mod warm_start;
mod worker;

pub use assemble::{AssembleError, Assembly, Piece};
pub use checkpoint::Checkpoint;
pub use collect::Collector;
pub use error::TrainError;
pub use evaluate::{evaluate, evaluate_by, evaluate_in, evaluate_native, evaluate_native_by, held_out, sampler};
pub use evaluation::{Ends, EvaluateError, Evaluation, MeanInterval, SuccessRate};
pub use hwasp_experiment::total_name;
pub use hwasp_problem::{StandInKind, World};
pub use learned::TRAILING;
pub use metrics::MetricsRow;
pub use observer::{Event, FailedIteration, Observer, ObserverError};
pub use paired::{Change, Reference};
pub use polish::{params_at, stage_at};
pub use train::{STILL, Trained, beginning, moved, repeat, train, train_by, train_from};
pub use trainer::Trainer;
pub use trial::{AT_ONCE, Trial};
pub use warm_start::{Learned, WarmStartError, warm_start};
pub use worker::{LocalCollector, Worker};
