//! Trainings as the command `train` and the Python package run them: from what was asked for to a finished run folder, by the threads
//! of this process or by workers elsewhere.

#![forbid(unsafe_code)]

mod crew;
mod failure;
mod given;
mod session;
mod words;

#[cfg(feature = "cluster")]
pub use crew::identity;
pub use crew::{Crew, Elsewhere, place};
pub use failure::{Failure, OTHER_FILE};
pub use given::{executor, run_folder, saved_run};
pub use session::{Session, Training, What, into_folder};
pub use words::{beginning, shell};
