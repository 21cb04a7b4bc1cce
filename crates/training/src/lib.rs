//! The laboratory: experiment files, their assembly, training, run folders, evaluation, statistics and plots.
//!
//! A program that embeds training needs three calls: [`spec::load`] and [`spec::resolve`] an experiment,
//! [`Assembly::new`], [`train`]. What happens on the way is told to an [`Observer`].

#![forbid(unsafe_code)]

mod assemble;
pub mod checkpoint;
pub mod compare;
pub mod design;
mod drawing;
mod evaluate;
pub mod export;
pub mod files;
mod gradient;
mod learned;
pub mod metrics;
mod observer;
mod paired;
pub mod parts;
pub mod play;
pub mod plot;
mod policy_file;
pub mod project;
mod replay;
pub mod report;
mod run_folder;
mod search;
pub mod spec;
pub mod stats;
mod summary;
mod tensorboard;
mod tensors;
pub mod text;
pub mod tolerances;
mod train;

pub use assemble::{AssembleError, Assembly, LearnerSettings, Problems, World};
pub use drawing::Drawing;
pub use evaluate::{EvaluateError, Evaluation, MeanInterval, SuccessRate, evaluate, evaluate_in, evaluate_native};
pub use observer::{Event, Fault, Observer, ObserverError};
pub use paired::Change;
pub use policy_file::{PolicyFileError, read_policy, write_policy};
pub use replay::{Replay, ReplayError, replay};
pub use run_folder::{Keeping, Provenance, Resumed, RunError, RunFolder, SavedRun};
pub use summary::{DesignGroupSummary, Summary};
pub use tensorboard::{TensorBoard, TensorBoardError};
pub use train::{TRAILING, TrainError, Trained, train, train_from};
