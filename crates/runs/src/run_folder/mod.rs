//! Run folders: everything about one training, in files that explain themselves.

mod lock;
mod provenance;
mod saved;
mod table;
mod writer;

pub use self::lock::Writers;
pub use self::provenance::Provenance;
pub use self::saved::{SavedRun, saved_experiment, saved_json, saved_metrics, saved_provenance, saved_summary};
pub use self::writer::{ExtraFiles, Extras, Keeping, Resumed, RunFolder, no_extras};
