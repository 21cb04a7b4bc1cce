//! Pixels with text over them.

use hwasp_plot::{PlotError, embedded_font};
use resvg::{tiny_skia, usvg};

/// A picture: rows of red, green and blue from the top.
#[derive(Clone, PartialEq, Eq)]
pub struct Picture {
    /// Pixels across.
    pub width: usize,
    /// Pixels down.
    pub height: usize,
    /// `3·width·height` bytes.
    pub rgb: Vec<u8>,
}

impl std::fmt::Debug for Picture {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Picture({} × {})", self.width, self.height)
    }
}

/// Pixels to be drawn upon.
pub(super) struct Canvas {
    pixels: tiny_skia::Pixmap,
}

/// The letters, loaded once.
pub(super) struct Letters(usvg::Options<'static>);

impl Letters {
    pub(super) fn new() -> Self {
        Self(embedded_font())
    }
}

impl Canvas {
    /// A white one.
    pub(super) fn new(width: usize, height: usize) -> Result<Self, PlotError> {
        let impossible = || PlotError::Render(format!("{width} × {height} pixels are none or too many"));
        let side = |pixels: usize| u32::try_from(pixels).map_err(|_| impossible());
        let mut pixels = tiny_skia::Pixmap::new(side(width)?, side(height)?).ok_or_else(impossible)?;
        pixels.fill(tiny_skia::Color::WHITE);
        Ok(Self { pixels })
    }

    /// Puts a picture down, its upper left corner at (x, y); it has to fit.
    pub(super) fn paste(&mut self, picture: &Picture, (x, y): (usize, usize)) {
        let width = self.pixels.width() as usize;
        for (row, line) in picture.rgb.chunks_exact(3 * picture.width).enumerate() {
            let from = 4 * ((y + row) * width + x);
            let pixels = self.pixels.data_mut()[from..][..4 * picture.width].chunks_exact_mut(4);
            for (pixel, colour) in pixels.zip(line.chunks_exact(3)) {
                pixel[..3].copy_from_slice(colour);
                pixel[3] = u8::MAX;
            }
        }
    }

    /// Draws an SVG over it, pixel by pixel.
    pub(super) fn draw(&mut self, svg: &str, letters: &Letters) -> Result<(), PlotError> {
        let tree = usvg::Tree::from_str(svg, &letters.0).map_err(|e| PlotError::Render(e.to_string()))?;
        resvg::render(&tree, tiny_skia::Transform::identity(), &mut self.pixels.as_mut());
        Ok(())
    }

    /// The pixels; nothing of them is transparent.
    pub(super) fn picture(&self) -> Picture {
        let (width, height) = (self.pixels.width() as usize, self.pixels.height() as usize);
        let rgb = self.pixels.data().chunks_exact(4).flat_map(|pixel| [pixel[0], pixel[1], pixel[2]]).collect();
        Picture { width, height, rgb }
    }

    /// The bytes of a PNG file.
    pub(super) fn png(&self) -> Result<Vec<u8>, PlotError> {
        self.pixels.encode_png().map_err(|e| PlotError::Render(e.to_string()))
    }
}
