//! Runs on disk. A run folder has everything about one training: its checkpoints, its learning curve, its result. This crate
//! writes run folders and reads them back.

#![forbid(unsafe_code)]

pub mod checkpoint;
mod error;
pub mod files;
mod layout;
pub mod metrics;
mod policy_file;
mod replay;
mod run_folder;
mod store;
mod summary;
mod tensorboard;
pub mod tensors;
pub mod text;

pub use error::{RunError, encode, io_error};
pub use layout::{CHECKPOINTS, DESIGN, LARGEST_SUMMARY, LOG, METRICS, POLICY, PROVENANCE, SUMMARY};
pub use policy_file::{PolicyFileError, read_policy, write_policy};
pub use replay::{Replay, ReplayError, replay};
pub use run_folder::{
    ExtraFiles, Extras, Keeping, Provenance, Resumed, RunFolder, SavedRun, Writers, no_extras, saved_experiment,
    saved_json, saved_metrics, saved_provenance, saved_summary,
};
pub use store::{CheckpointStore, Found};
pub use summary::{DesignGroupSummary, Summary};
pub use tensorboard::{TensorBoard, TensorBoardError};
