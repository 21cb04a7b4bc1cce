//! Plots as files: the SVG itself, or its pixels.

use std::path::Path;
use std::sync::Arc;

use resvg::{tiny_skia, usvg};

use crate::error::PlotError;
use crate::options::Theme;
use crate::picture::Plot;

/// The font of every PNG, whatever the machine has installed; see `assets/README.md`.
const FONT: &[u8] = include_bytes!("../assets/DejaVuSans-subset.ttf");
/// Pixels of a PNG for each of the SVG's, so that it is sharp in print and on fine screens.
const SCALE: f32 = 2.0;
/// The same for print: 300 dots per inch.
const PRINT_SCALE: f32 = 300.0 / 96.0;
/// The most pixels of a PNG on either side.
const MOST_PIXELS: f32 = 20_000.0;

/// Writes the plot as `.svg` or `.png`, whichever the file's name ends in.
pub fn write_plot(path: &Path, plot: &Plot) -> Result<(), PlotError> {
    let extension = path.extension().and_then(|e| e.to_str()).map(str::to_ascii_lowercase);
    let bytes = match extension.as_deref() {
        Some("svg") => plot.svg.clone().into_bytes(),
        Some("png") => render_png(plot, if plot.theme == Theme::Print { PRINT_SCALE } else { SCALE })?,
        _ => return Err(PlotError::Extension { path: path.to_owned() }),
    };
    std::fs::write(path, bytes).map_err(|source| PlotError::Write { path: path.to_owned(), source })
}

/// How texts are drawn in pixels: in the embedded font alone.
pub fn embedded_font() -> usvg::Options<'static> {
    let mut fonts = usvg::fontdb::Database::new();
    fonts.load_font_data(FONT.to_vec());
    usvg::Options { fontdb: Arc::new(fonts), font_family: "DejaVu Sans".to_owned(), ..usvg::Options::default() }
}

/// The plot as the bytes of a PNG file, `scale` pixels for each of the SVG's.
pub fn render_png(plot: &Plot, scale: f32) -> Result<Vec<u8>, PlotError> {
    let tree = usvg::Tree::from_str(&plot.svg, &embedded_font()).map_err(|e| PlotError::Render(e.to_string()))?;
    let (width, height) = ((tree.size().width() * scale).round(), (tree.size().height() * scale).round());
    let possible = |side: f32| (1.0..=MOST_PIXELS).contains(&side);
    let pixels =
        if possible(width) && possible(height) { tiny_skia::Pixmap::new(width as u32, height as u32) } else { None };
    let mut pixels = pixels.ok_or_else(|| {
        PlotError::Render(format!("{width} × {height} pixels are outside [1, {MOST_PIXELS}]; choose another scale"))
    })?;
    resvg::render(&tree, tiny_skia::Transform::from_scale(scale, scale), &mut pixels.as_mut());
    pixels.encode_png().map_err(|e| PlotError::Render(e.to_string()))
}
