//! The contact sheet: a row for each episode, a column for each moment.

use hwasp_plot::{Anchor, PlotError, Svg};

use super::canvas::{Canvas, Letters, Picture};
use super::label::verdict;

/// A row of the sheet.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Row {
    /// On the left, line by line; the first is the heading.
    pub lines: Vec<String>,
    /// Written below them, where it is known.
    pub success: Option<bool>,
    /// Pictures, all of one size, and what stands below each.
    pub cells: Vec<(Picture, String)>,
}

/// Width of the texts on the left, height of the title, of a line below a picture, and gaps; pixels.
const LEFT: usize = 200;
const TITLE: usize = 44;
const BELOW: usize = 26;
const GAP: usize = 8;
/// Height of the texts, pixels.
const TEXT: f64 = 15.0;
const INK: &str = "#1b1f24";

/// The sheet as the bytes of a PNG file: a title above the rows.
pub fn sheet(title: &str, rows: &[Row]) -> Result<Vec<u8>, PlotError> {
    let cells = || rows.iter().flat_map(|row| &row.cells);
    let (width, height) = cells().next().map_or((0, 0), |(picture, _)| (picture.width, picture.height));
    if let Some((odd, _)) = cells().find(|(picture, _)| (picture.width, picture.height) != (width, height)) {
        return Err(PlotError::Render(format!("{odd:?} is among pictures of {width} × {height} pixels")));
    }
    let columns = rows.iter().map(|row| row.cells.len()).max().unwrap_or_default();
    let place = |row: usize, column: usize| (LEFT + column * (width + GAP), TITLE + row * (height + BELOW));
    let (right, bottom) = place(rows.len(), columns);
    let mut canvas = Canvas::new(right.max(LEFT), bottom + GAP)?;
    let mut page = Svg::transparent(right as f64, (bottom + GAP) as f64, title);
    let margin = 2.0 * GAP as f64;
    page.text((margin, 0.64 * TITLE as f64), 1.2 * TEXT, Anchor::Start, INK, title);
    for (i, row) in rows.iter().enumerate() {
        for (j, (picture, below)) in row.cells.iter().enumerate() {
            let (x, y) = place(i, j);
            canvas.paste(picture, (x, y));
            let middle = x as f64 + 0.5 * width as f64;
            page.text((middle, (y + height) as f64 + 1.15 * TEXT), TEXT, Anchor::Middle, INK, below);
        }
        let line = |n: usize| place(i, 0).1 as f64 + TEXT * (1.2 + 1.5 * n as f64);
        for (n, text) in row.lines.iter().enumerate() {
            let (size, ink) = if n == 0 { (1.15 * TEXT, INK) } else { (TEXT, "#4a5058") };
            page.text((margin, line(n)), size, Anchor::Start, ink, text);
        }
        if let Some((word, colour)) = row.success.map(verdict) {
            page.text((margin, line(row.lines.len())), 1.15 * TEXT, Anchor::Start, colour, word);
        }
    }
    canvas.draw(&page.finish(), &Letters::new())?;
    canvas.png()
}
