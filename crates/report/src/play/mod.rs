//! Episodes to look at, of any world that shows itself: as pages for a browser, in three dimensions and as drawings; and as films
//! (GIF, MP4, WebM) with one sheet of stills (PNG).
//!
//! They are the episodes that [`evaluate`](hwasp_training::evaluate()) runs, to the bit. Films are [drawn](sketch); grasps can be
//! [rendered](render) by the engine as well, in builds with the feature `renderer`.

mod canvas;
#[cfg(feature = "renderer")]
mod draw;
#[cfg(feature = "mujoco")]
mod film;
mod gif;
mod html;
mod label;
#[cfg(feature = "mujoco")]
mod moments;
mod sheet;
mod shown;
mod sketches;
mod video;

use std::path::{Path, PathBuf};

use thiserror::Error;

use hwasp_plot::PlotError;
use hwasp_scene::Take;
use hwasp_tasks::grasp::GraspTaskSettings;
use hwasp_training::{AssembleError, Assembly, EvaluateError};

pub use canvas::Picture;
#[cfg(feature = "mujoco")]
pub use film::{Grasped, film};
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

/// What a film is written as.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Shown by everything, 256 colours.
    Gif,
    /// By the program `ffmpeg`.
    Mp4,
    /// By the program `ffmpeg`.
    Webm,
}

impl Format {
    /// How the names of its files end.
    pub fn ending(self) -> &'static str {
        match self {
            Self::Gif => "gif",
            Self::Mp4 => "mp4",
            Self::Webm => "webm",
        }
    }
}

/// An episode and the film of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Played {
    /// The episode's index.
    pub index: u64,
    /// What kind it is of, the shape that was grasped for one; may be empty.
    pub kind: String,
    /// Whether it succeeded, where its task knows.
    pub success: Option<bool>,
    /// The film.
    pub path: PathBuf,
}

/// Draws filmed episodes into a folder: `episode-INDEX-KIND.gif` for each, in real time, and all of them on `sheet.png` under
/// `title`. Tells of each film that is written. Files of these names are replaced. Returns the sheet's path.
pub fn sketch(
    takes: &[Take],
    options: &PlayOptions,
    format: Format,
    place: (&str, &Path),
    told: &mut dyn FnMut(&Played),
) -> Result<PathBuf, PlayError> {
    shown::write(sketches::sketches(takes, options), format, place, told)
}

/// The same of grasps, which it runs and has the engine render.
#[cfg(feature = "renderer")]
pub fn render(
    assembly: &Assembly,
    params: &[f32],
    options: &PlayOptions,
    format: Format,
    place: (&str, &Path),
    told: &mut dyn FnMut(&Played),
) -> Result<PathBuf, PlayError> {
    let mut renderer = draw::Renderer::new(assembly, options.size)?;
    shown::write(renderer.grasps(assembly, params, options)?, format, place, told)
}

/// Whether the experiment is about grasps.
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
    /// MP4 and WebM without the program that makes them.
    #[error("MP4 and WebM are made by the program `ffmpeg`, which is not on the PATH")]
    NoEncoder,
    /// The program that makes MP4 and WebM gave up.
    #[error("`{}` cannot be made by ffmpeg: {what}", path.display())]
    Encode {
        /// The film.
        path: PathBuf,
        /// What it said.
        what: String,
    },
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
