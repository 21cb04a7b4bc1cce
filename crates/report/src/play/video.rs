//! Films as MP4 and WebM: the program `ffmpeg` makes them, from pixels that it is given.

use std::io::{self, Write};
use std::path::Path;
use std::process::{Command, Stdio};

use hwasp_settings::text::printable_lines;

use super::{Picture, PlayError};

/// Lets `ffmpeg` write a film, the format by the name's ending: pictures of one size, `pace` seconds each, the last one for `rest`
/// seconds.
pub(super) fn write(path: &Path, pictures: &[Picture], pace: f64, rest: f64) -> Result<(), PlayError> {
    let Some(first) = pictures.first() else { return Ok(()) };
    let (size, rate) = (format!("{}x{}", first.width, first.height), format!("{}", 1.0 / pace));
    let started = Command::new("ffmpeg")
        .args(["-y", "-loglevel", "error", "-f", "rawvideo", "-pix_fmt", "rgb24", "-s", &size, "-r", &rate, "-i", "-"])
        // Players want sides of even numbers of pixels, and half as many colours as pixels each way.
        .args(["-vf", "pad=ceil(iw/2)*2:ceil(ih/2)*2:color=white", "-pix_fmt", "yuv420p", "-fflags", "+bitexact"])
        .args(if path.extension().is_some_and(|ending| ending == "webm") {
            ["-b:v", "0", "-crf", "32"]
        } else {
            ["-crf", "20", "-movflags", "+faststart"]
        })
        .arg(path)
        .stdin(Stdio::piped())
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn();
    let failed = |what: String| PlayError::Encode { path: path.to_owned(), what };
    let mut encoder = started.map_err(|error| match error.kind() {
        io::ErrorKind::NotFound => PlayError::NoEncoder,
        _ => failed(error.to_string()),
    })?;
    let still = (rest / pace).round().max(1.0) as usize;
    let mut input = encoder.stdin.take().expect("its input is a pipe");
    let frames = pictures.iter().chain(std::iter::repeat_n(&pictures[pictures.len() - 1], still - 1));
    let given = frames.map(|picture| &picture.rgb).try_for_each(|rgb| input.write_all(rgb));
    drop(input);
    let ended = encoder.wait_with_output().map_err(|error| failed(error.to_string()))?;
    // What it says tells more than that it took no more pixels.
    if !ended.status.success() {
        let said = printable_lines(&String::from_utf8_lossy(&ended.stderr));
        return Err(failed(if said.trim().is_empty() { ended.status.to_string() } else { said.trim().to_owned() }));
    }
    given.map_err(|error| failed(error.to_string()))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Runs where the encoder is.
    #[test]
    fn films_are_encoded_and_failures_told() {
        let square = |x: usize| {
            let inside = |i: usize| (x..x + 20).contains(&(i % 161)) && i / 161 > 80;
            let rgb = (0..161 * 161).flat_map(|i| if inside(i) { [0, 0, 0] } else { [255; 3] }).collect();
            Picture { width: 161, height: 161, rgb }
        };
        let pictures: Vec<Picture> = (0..10).map(|i| square(10 * i)).collect();
        let out = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../target/film-test");
        let _ = std::fs::create_dir_all(&out);
        for (name, magic, from) in [("a.mp4", &b"ftyp"[..], 4), ("a.webm", &[0x1a, 0x45, 0xdf, 0xa3][..], 0)] {
            match write(&out.join(name), &pictures, 0.05, 0.5) {
                Err(PlayError::NoEncoder) => return,
                written => written.unwrap(),
            }
            let bytes = std::fs::read(out.join(name)).unwrap();
            assert_eq!(&bytes[from..from + magic.len()], magic, "{name}");
        }
        let error = write(&out.join("no/such/folder.mp4"), &pictures, 0.05, 0.5).unwrap_err().to_string();
        assert!(error.contains("No such file"), "{error}");
    }
}
