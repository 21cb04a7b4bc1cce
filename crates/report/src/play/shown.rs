//! Episodes as pictures, and the files that are made of them.

use std::fs::{self, File};
use std::io::{self, BufWriter};
use std::path::{Path, PathBuf};

use super::{Format, Picture, PlayError, Played, Row, gif, sheet, video};

/// How long the last picture is shown, s.
const REST: f64 = 1.5;

/// An episode as pictures.
pub(super) struct Shown {
    /// Its index.
    pub(super) index: u64,
    /// What kind it is of; may be empty.
    pub(super) kind: String,
    /// Whether it succeeded, where its task knows.
    pub(super) success: Option<bool>,
    /// All of one size.
    pub(super) pictures: Vec<Picture>,
    /// Time from picture to picture, s.
    pub(super) pace: f64,
    /// Its row on the sheet.
    pub(super) row: Row,
}

/// Writes `episode-INDEX-KIND.gif`, or what else the format is, for each episode into a folder, and all of them on `sheet.png` under
/// a title. Tells of each film that is written. Returns the sheet's path.
pub(super) fn write(
    episodes: impl Iterator<Item = Result<Shown, PlayError>>,
    format: Format,
    (title, out): (&str, &Path),
    told: &mut dyn FnMut(&Played),
) -> Result<PathBuf, PlayError> {
    fs::create_dir_all(out).map_err(|source| PlayError::Write { path: out.to_owned(), source })?;
    let mut rows = Vec::new();
    for episode in episodes {
        let Shown { index, kind, success, pictures, pace, row } = episode?;
        let plain = |letter: char| if letter.is_alphanumeric() { letter } else { '-' };
        let gap = if kind.is_empty() { "" } else { "-" };
        let name: String = kind.chars().map(plain).collect();
        let path = out.join(format!("episode-{index}{gap}{name}.{}", format.ending()));
        if format == Format::Gif {
            let delay = |seconds: f64| (100.0 * seconds).round().clamp(2.0, 1e4) as u16;
            save(&path, |file| gif::write(BufWriter::new(file), &pictures, [delay(pace), delay(REST)]))?;
        } else {
            video::write(&path, &pictures, pace, REST)?;
        }
        rows.push(row);
        told(&Played { index, kind, success, path });
    }
    let path = out.join("sheet.png");
    let png = sheet(title, &rows)?;
    save(&path, |mut file| io::Write::write_all(&mut file, &png))?;
    Ok(path)
}

fn save(path: &Path, write: impl FnOnce(File) -> io::Result<()>) -> Result<(), PlayError> {
    File::create(path).and_then(write).map_err(|source| PlayError::Write { path: path.to_owned(), source })
}
