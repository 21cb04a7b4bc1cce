//! Films as GIF: one palette for all pictures, so that nothing flickers, and of each picture only what has changed.

use std::collections::HashMap;
use std::io::{self, Write};

use color_quant::NeuQuant;
use gif::{DisposalMethod, Encoder, EncodingError, Frame, Repeat};

use super::canvas::Picture;

/// Colours of a film; one entry of the palette is left for pixels that stay as they are.
const COLOURS: usize = 255;
const UNCHANGED: u8 = 255;
/// Every how many pictures, and of these every how many pixels, the colours are chosen from: up to the quantiser's pace.
const SAMPLED: usize = 8;
const PACE: i32 = 5;

/// Writes pictures of one size, each shown for `delay` hundredths of a second and the last for `last`, again and again.
pub(super) fn write(out: impl Write, pictures: &[Picture], [delay, last]: [u16; 2]) -> io::Result<()> {
    let Some(first) = pictures.first() else { return Ok(()) };
    let side = |pixels: usize| u16::try_from(pixels).map_err(io::Error::other);
    let (width, height) = (side(first.width)?, side(first.height)?);
    let sample: Vec<u8> = pictures
        .iter()
        .step_by(SAMPLED)
        .chain(pictures.last())
        .flat_map(|picture| picture.rgb.chunks_exact(3).flat_map(|p| [p[0], p[1], p[2], u8::MAX]))
        .collect();
    let quantiser = NeuQuant::new(PACE, COLOURS, &sample);
    let mut palette = quantiser.color_map_rgb();
    palette.resize(3 * (COLOURS + 1), 0);
    let mut known: HashMap<[u8; 3], u8> = HashMap::new();
    let mut encoder = Encoder::new(out, width, height, &palette).map_err(failed)?;
    encoder.set_repeat(Repeat::Infinite).map_err(failed)?;
    let mut shown: Vec<u8> = Vec::new();
    for (i, picture) in pictures.iter().enumerate() {
        let index =
            |p: &[u8]| *known.entry([p[0], p[1], p[2]]).or_insert_with_key(|&[r, g, b]| nearest(&quantiser, [r, g, b]));
        let indices: Vec<u8> = picture.rgb.chunks_exact(3).map(index).collect();
        let mut frame = if shown.is_empty() {
            Frame { width, height, buffer: indices.clone().into(), ..Frame::default() }
        } else {
            changed(&shown, &indices, picture.width)
        };
        frame.delay = if i + 1 == pictures.len() { last } else { delay };
        frame.dispose = DisposalMethod::Keep;
        encoder.write_frame(&frame).map_err(failed)?;
        shown = indices;
    }
    encoder.into_inner().map_err(failed)?.flush()
}

fn failed(error: EncodingError) -> io::Error {
    match error {
        EncodingError::Io(error) => error,
        other => io::Error::other(other),
    }
}

fn nearest(quantiser: &NeuQuant, [r, g, b]: [u8; 3]) -> u8 {
    quantiser.index_of(&[r, g, b, u8::MAX]) as u8
}

/// The smallest rectangle around what has changed, and in it only that; one pixel where nothing has.
fn changed(shown: &[u8], next: &[u8], width: usize) -> Frame<'static> {
    let mut edges: Option<[usize; 4]> = None;
    for (i, _) in shown.iter().zip(next).enumerate().filter(|(_, (old, new))| old != new) {
        let (x, y) = (i % width, i / width);
        let [left, right, top, bottom] = edges.unwrap_or([x, x, y, y]);
        edges = Some([left.min(x), right.max(x), top.min(y), bottom.max(y)]);
    }
    let [left, right, top, bottom] = edges.unwrap_or_default();
    let mut buffer = Vec::with_capacity((right + 1 - left) * (bottom + 1 - top));
    for row in top..=bottom {
        let at = row * width;
        let pair = shown[at + left..=at + right].iter().zip(&next[at + left..=at + right]);
        buffer.extend(pair.map(|(old, new)| if old == new { UNCHANGED } else { *new }));
    }
    Frame {
        left: left as u16,
        top: top as u16,
        width: (right + 1 - left) as u16,
        height: (bottom + 1 - top) as u16,
        transparent: Some(UNCHANGED),
        buffer: buffer.into(),
        ..Frame::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_can_be_read_again() {
        // A black square of 2 pixels walks over a red picture; then it rests.
        let square = |x: usize| {
            let colour = |i: usize| {
                if (x..x + 2).contains(&(i % 12)) && (3..5).contains(&(i / 12)) { [0, 0, 0] } else { [255, 0, 0] }
            };
            Picture { width: 12, height: 9, rgb: (0..12 * 9).flat_map(colour).collect() }
        };
        let pictures = [square(1), square(2), square(8), square(8)];
        let mut bytes = Vec::new();
        write(&mut bytes, &pictures, [5, 100]).unwrap();
        let mut options = gif::DecodeOptions::new();
        options.set_color_output(gif::ColorOutput::RGBA);
        let mut film = options.read_info(&bytes[..]).unwrap();
        assert_eq!((film.width(), film.height()), (12, 9));
        let mut screen = vec![0; 3 * 12 * 9];
        let mut delays = Vec::new();
        for picture in &pictures {
            let frame = film.read_next_frame().unwrap().unwrap();
            delays.push(frame.delay);
            for (i, pixel) in frame.buffer.chunks_exact(4).enumerate().filter(|(_, pixel)| pixel[3] > 0) {
                let (x, y) = (i % usize::from(frame.width), i / usize::from(frame.width));
                let at = 3 * ((y + usize::from(frame.top)) * 12 + x + usize::from(frame.left));
                screen[at..at + 3].copy_from_slice(&pixel[..3]);
            }
            let worst = screen.iter().zip(&picture.rgb).map(|(a, b)| a.abs_diff(*b)).max();
            assert!(worst < Some(20), "the quantiser is off by {worst:?}");
        }
        assert!(film.read_next_frame().unwrap().is_none());
        assert_eq!(delays, [5, 5, 5, 100]);
    }

    #[test]
    fn only_the_rectangle_that_changed_is_written() {
        let frame = changed(&[1; 20], &[1, 1, 1, 1, 1, 1, 2, 1, 1, 1, 1, 1, 1, 3, 1, 1, 1, 1, 1, 1], 5);
        assert_eq!([frame.left, frame.top, frame.width, frame.height], [1, 1, 3, 2]);
        assert_eq!(*frame.buffer, [2, 255, 255, 255, 255, 3]);
        let still = changed(&[1; 20], &[1; 20], 5);
        assert_eq!((still.width, still.height, &*still.buffer), (1, 1, &[255][..]));
    }
}
