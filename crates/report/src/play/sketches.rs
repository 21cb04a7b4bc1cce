//! Films of drawings: of every world that shows itself, without the engine and its renderer.

use hwasp_scene::Take;

use super::canvas::{Canvas, Letters};
use super::label::{band, fitting};
use super::shown::Shown;
use super::{Caption, Picture, PlayError, PlayOptions, Row, label};
use crate::film::{Set, chosen, sketch, told_of_moment};
use crate::words::{decimal, decimals};

/// The episodes as pictures of the size of `options`, one after the other.
pub(super) fn sketches<'a>(
    takes: &'a [Take],
    options: &'a PlayOptions,
) -> impl Iterator<Item = Result<Shown, PlayError>> + 'a {
    let (set, letters) = (Set::new(takes), Letters::new());
    takes.iter().enumerate().map(move |(number, take)| {
        let picture = |i: usize| -> Result<Picture, PlayError> {
            let [width, height] = options.size;
            let mut canvas = Canvas::new(width, height)?;
            canvas.draw(&sketch(&set, (number, take, i), options.size, band(width)), &letters)?;
            Ok(canvas.picture())
        };
        let time = |i: usize| take.time_step * take.moments[i].step as f64;
        let (kind, success) = (take.kind().unwrap_or_default(), take.success());
        let about = take.moments.first().map_or("", |moment| &moment.sight.about);
        let object = [kind, about].into_iter().filter(|text| !text.is_empty()).collect::<Vec<_>>().join(" · ");
        let caption = |i: usize| Caption {
            object: fitting(&object, options.size[0]),
            success,
            time: format!("{:.2} s · {}", time(i), told_of_moment(&take.moments[i])),
            episode: format!("episode {}", take.index),
        };
        let drawn = (0..take.moments.len()).map(picture).collect::<Result<Vec<_>, _>>()?;
        let captions: Vec<Caption> = (0..take.moments.len()).map(caption).collect();
        let cell = |(i, name): (usize, &str)| {
            let gap = if name.is_empty() { "" } else { " · " };
            (drawn[i].clone(), format!("{name}{gap}{:.2} s", time(i)))
        };
        let worth = take.result.undiscounted_return;
        let about = about.split(", ").filter(|text| !text.is_empty()).map(str::to_owned);
        let lines = [format!("episode {}", take.index), kind.to_owned()].into_iter().filter(|line| !line.is_empty());
        let row = Row {
            lines: lines.chain(about).chain([format!("return {}", decimal(worth, decimals(worth)))]).collect(),
            success,
            cells: chosen(take).into_iter().map(cell).collect(),
        };
        let pace = if take.moments.len() > 1 { time(1) } else { 1.0 };
        let pictures = label(drawn.iter().zip(&captions))?;
        Ok(Shown { index: take.index, kind: kind.to_owned(), success, pictures, pace, row })
    })
}
