//! Episodes to look at: of any world that shows itself, drawn as a page for a browser; held-out grasps of a saved run as films (GIF)
//! and on one sheet (PNG), too.
//!
//! `film` runs the episodes that [`evaluate`](hwasp_training::evaluate()) runs, to the bit, and keeps their poses. Only `play`
//! renders them, in builds with the feature `renderer`.

mod canvas;
#[cfg(feature = "renderer")]
mod draw;
#[cfg(feature = "mujoco")]
mod film;
#[cfg(feature = "renderer")]
mod gif;
mod html;
mod label;
#[cfg(feature = "mujoco")]
mod moments;
mod sheet;

use std::path::PathBuf;

use thiserror::Error;

use hwasp_plot::PlotError;
use hwasp_tasks::grasp::GraspTaskSettings;
use hwasp_training::{AssembleError, Assembly, EvaluateError};

pub use canvas::Picture;
#[cfg(feature = "renderer")]
pub use draw::play;
#[cfg(feature = "mujoco")]
pub use film::{Take, film};
pub use html::{film_page, record, scene_page};
pub use label::{Caption, label};
#[cfg(feature = "mujoco")]
pub use moments::{MOMENTS, Moment, moments};
pub use sheet::{Row, sheet};

/// The fewest and the most pixels of a picture's sides.
pub const SIDES: [u64; 2] = [160, 640];
/// The most episodes on one sheet.
pub const MOST_EPISODES: u64 = 64;

/// Which episodes to look at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PlayOptions {
    /// Index of the first one among the held-out episodes.
    pub first: u64,
    /// How many.
    pub episodes: u64,
    /// The root seed of their starts.
    pub seed: u64,
    /// On the hand with the engine's own tendons ([`Assembly::native`]).
    pub native: bool,
    /// Pixels across and down, within [`SIDES`].
    pub size: [usize; 2],
}

/// An episode and the film of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Played {
    /// The episode's index.
    pub index: u64,
    /// What was grasped.
    pub shape: &'static str,
    /// Whether it succeeded.
    pub success: bool,
    /// The film.
    pub path: PathBuf,
}

/// Whether the experiment has episodes to look at: that it is about grasps.
pub fn check(assembly: &Assembly) -> Result<&GraspTaskSettings, PlayError> {
    let task = &assembly.experiment().task;
    task.settings().ok_or_else(|| PlayError::NoGrasp { problem: task.name().to_owned() })
}

/// Why there is nothing to look at.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum PlayError {
    /// A problem in which nothing is grasped.
    #[error("{problem} has no grasps to look at; z-grasp and 3d-grasp have")]
    NoGrasp {
        /// The problem.
        problem: String,
    },
    /// A problem that does not show itself.
    #[error("nothing is to be seen of {problem}: its task does not say how it looks")]
    Unseen {
        /// The problem.
        problem: String,
    },
    /// Episodes for a page cannot be run.
    #[error(transparent)]
    Evaluate(#[from] EvaluateError),
    /// A grasping task that cannot be.
    #[cfg(feature = "mujoco")]
    #[error(transparent)]
    Grasp(#[from] hwasp_grasp::GraspError),
    /// The world of the episodes cannot be put together, or nothing is grasped in it.
    #[error(transparent)]
    Assemble(#[from] AssembleError),
    /// An episode failed.
    #[error(transparent)]
    Rollout(#[from] hwasp_core::RolloutError),
    /// No OpenGL, for one.
    #[cfg(feature = "renderer")]
    #[error(transparent)]
    Picture(#[from] hwasp_mujoco::engine::PictureError),
    /// Model and code do not fit.
    #[cfg(feature = "renderer")]
    #[error(transparent)]
    Name(#[from] hwasp_mujoco::engine::UnknownName),
    /// A film whose object or pose the engine does not take.
    #[error("episode {index} cannot be shown: {what}")]
    Pose {
        /// The episode.
        index: u64,
        /// What the engine says.
        what: String,
    },
    /// A text or a sheet cannot be drawn.
    #[error(transparent)]
    Plot(#[from] PlotError),
    /// The file system.
    #[error("`{}` cannot be written: {source}", path.display())]
    Write {
        /// The file or folder.
        path: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
}

impl PlayError {
    /// Whether there is nothing to render with on this machine.
    #[cfg(feature = "renderer")]
    pub fn is_without_renderer(&self) -> bool {
        matches!(self, Self::Picture(hwasp_mujoco::engine::PictureError::NoContext(_)))
    }
}
