//! Pictures of a simulation, drawn without a screen: the engine's renderer in an OpenGL context of EGL.

use mujoco_rs::prelude::MjvCamera;
use mujoco_rs::renderer::{MjRenderer, RendererError};

use super::{CameraId, Simulation};

/// Why there is no picture.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PictureError {
    /// No OpenGL context can be had.
    #[error(
        "no picture can be rendered: {0}; rendering needs EGL and an OpenGL driver, which need no screen and no graphics card: \
         on Debian and Ubuntu install libegl1, libegl-mesa0 and libgl1-mesa-dri"
    )]
    NoContext(String),
    /// A side that is none, or more than the model makes room for.
    #[error("a picture of {width} × {height} pixels is outside 1 × 1 to {} × {}", .most[0], .most[1])]
    Size {
        /// Pixels across.
        width: usize,
        /// Pixels down.
        height: usize,
        /// What the model makes room for (`offwidth`, `offheight`).
        most: [usize; 2],
    },
    /// The renderer gave up.
    #[error("the picture cannot be drawn: {0}")]
    Draw(String),
}

/// Draws simulations of one MJCF text. It stays on the thread that made it, as OpenGL contexts do.
#[derive(Debug)]
pub struct Painter {
    renderer: MjRenderer,
}

impl Painter {
    /// Pictures of `size` (across, down; pixels) from a camera of the model.
    pub fn new(simulation: &Simulation, camera: CameraId, size: [usize; 2]) -> Result<Self, PictureError> {
        let global = &simulation.model().vis().global;
        let most = [global.offwidth, global.offheight].map(|side| usize::try_from(side).unwrap_or_default());
        let [width, height] = size;
        // The engine draws into a buffer of this size and would leave the rest of the picture black.
        if size.contains(&0) || width > most[0] || height > most[1] {
            return Err(PictureError::Size { width, height, most });
        }
        let renderer = MjRenderer::new(simulation.model(), width, height, 0).map_err(|error| match error {
            RendererError::GlutinError(cause) => PictureError::NoContext(cause.to_string()),
            other => PictureError::Draw(other.to_string()),
        })?;
        Ok(Self { renderer: renderer.with_camera(MjvCamera::new_fixed(camera.0)) })
    }

    /// The state as it was computed last ([`Simulation::forward`]), as rows of red, green and blue from the top.
    pub fn draw(&mut self, simulation: &mut Simulation) -> Result<&[u8], PictureError> {
        let draw = |error: RendererError| PictureError::Draw(error.to_string());
        self.renderer.sync_data(simulation.data_mut()).map_err(draw)?;
        self.renderer.render().map_err(draw)?;
        Ok(self.renderer.rgb_flat().expect("a renderer draws colours unless it is told not to"))
    }
}
