//! What stands on the pictures of a film.

use hwasp_plot::{Anchor, PlotError, Svg};

use super::canvas::{Canvas, Letters, Picture};

/// Success is green and failure vermilion, which the colour-blind tell apart too.
pub(super) fn verdict(success: bool) -> (&'static str, &'static str) {
    if success { ("success", "#007a5a") } else { ("failure", "#c44601") }
}

/// The texts of one picture.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Caption {
    /// Above on the left: what is grasped.
    pub object: String,
    /// Above on the right: how it ends, where that is known.
    pub success: Option<bool>,
    /// Below on the left: when.
    pub time: String,
    /// Below on the right: which episode.
    pub episode: String,
}

/// Height of the text, as a share of the picture's width.
const TEXT: f64 = 0.037;

/// The pictures of a film with their captions, on pale bands along their upper and lower edges.
pub fn label<'a>(pictures: impl IntoIterator<Item = (&'a Picture, &'a Caption)>) -> Result<Vec<Picture>, PlotError> {
    let letters = Letters::new();
    let labelled = |(picture, caption): (&Picture, &Caption)| {
        let mut canvas = Canvas::new(picture.width, picture.height)?;
        canvas.paste(picture, (0, 0));
        canvas.draw(&texts(picture, caption), &letters)?;
        Ok(canvas.picture())
    };
    pictures.into_iter().map(labelled).collect()
}

/// Height of the texts on a picture so wide, pixels.
fn text(width: usize) -> f64 {
    (width as f64 * TEXT).max(10.0)
}

/// Height of the bands, pixels.
pub(super) fn band(width: usize) -> f64 {
    (1.7 * text(width)).round()
}

/// As many of a text's parts, between commas, as find room beside the verdict.
pub(super) fn fitting(mut object: &str, width: usize) -> String {
    let letters = (1.6 * width as f64 / text(width)) as usize;
    while object.chars().count() > letters
        && let Some((shorter, _)) = object.rsplit_once(", ")
    {
        object = shorter;
    }
    object.to_owned()
}

fn texts(picture: &Picture, caption: &Caption) -> String {
    let (width, height) = (picture.width as f64, picture.height as f64);
    let (size, band) = (text(picture.width), band(picture.width));
    let margin = 0.6 * size;
    let mut page = Svg::transparent(width, height, "");
    for y in [0.0, height - band] {
        page.rectangle((0.0, y), (width, band), "fill=\"#ffffff\" fill-opacity=\"0.78\"");
    }
    let (above, below) = (0.5 * band + 0.36 * size, height - 0.5 * band + 0.36 * size);
    page.text((margin, above), size, Anchor::Start, "#1b1f24", &caption.object);
    if let Some((word, colour)) = caption.success.map(verdict) {
        page.text((width - margin, above), size, Anchor::End, colour, word);
    }
    page.text((margin, below), size, Anchor::Start, "#1b1f24", &caption.time);
    page.text((width - margin, below), size, Anchor::End, "#1b1f24", &caption.episode);
    page.finish()
}
