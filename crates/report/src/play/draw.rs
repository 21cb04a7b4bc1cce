//! Draws what was filmed, into files.

use std::fs::{self, File};
use std::io::{self, BufWriter};
use std::path::{Path, PathBuf};

use hwasp_grasp::{Object, Stage, Still};
use hwasp_mujoco::engine::Painter;
use hwasp_tasks::hand::names;
use hwasp_training::Assembly;

use super::film::grasp;
use super::{Caption, Moment, Picture, PlayError, PlayOptions, Played, Row, Take, film, gif, label, moments, sheet};

/// Pictures a second, and what a step lasts, s.
const RATE: usize = 20;
const STEP: f64 = 0.01;
/// Steps between pictures, so that films run at the speed of life.
const EVERY: usize = 100 / RATE;
/// How long a picture is shown, and the last one, hundredths of a second.
const DELAYS: [u16; 2] = [100 / RATE as u16, 150];

/// Runs, films and draws the episodes of `options` into a folder: `episode-INDEX-SHAPE.gif` for each, 20 pictures a second
/// in real time, and all of them on `sheet.png` under `title`. Tells of each film that is written. Files of these names are
/// replaced. Returns the sheet's path.
pub fn play(
    assembly: &Assembly,
    params: &[f32],
    options: &PlayOptions,
    (title, out): (&str, &Path),
    told: &mut dyn FnMut(&Played),
) -> Result<PathBuf, PlayError> {
    let grasp = grasp(assembly, None)?;
    let mut stage = Stage::new(&grasp);
    let camera = stage.simulation().camera(names::CAMERA)?;
    let mut painter = Painter::new(stage.simulation(), camera, options.size)?;
    fs::create_dir_all(out).map_err(|source| PlayError::Write { path: out.to_owned(), source })?;
    let mut rows = Vec::new();
    for take in film(assembly, params, options)? {
        let mut scene = Scene { stage: &mut stage, painter: &mut painter, take: &take, options };
        scene.begin()?;
        let path = out.join(format!("episode-{}-{}.gif", take.index, take.object.kind.name()));
        let pictures = scene.film()?;
        save(&path, |file| gif::write(BufWriter::new(file), &pictures, DELAYS))?;
        rows.push(scene.row()?);
        told(&Played { index: take.index, shape: take.object.kind.name(), success: take.success, path });
    }
    let path = out.join("sheet.png");
    let png = sheet(title, &rows)?;
    save(&path, |mut file| io::Write::write_all(&mut file, &png))?;
    Ok(path)
}

fn save(path: &Path, write: impl FnOnce(File) -> io::Result<()>) -> Result<(), PlayError> {
    File::create(path).and_then(write).map_err(|source| PlayError::Write { path: path.to_owned(), source })
}

/// An episode in front of the camera.
struct Scene<'a> {
    stage: &'a mut Stage,
    painter: &'a mut Painter,
    take: &'a Take,
    options: &'a PlayOptions,
}

impl Scene<'_> {
    fn begin(&mut self) -> Result<(), PlayError> {
        let index = self.take.index;
        self.stage.set(&self.take.object).map_err(|error| PlayError::Pose { index, what: error.to_string() })
    }

    fn picture(&mut self, still: &Still) -> Result<Picture, PlayError> {
        let index = self.take.index;
        self.stage.pose(still).map_err(|error| PlayError::Pose { index, what: error.to_string() })?;
        let [width, height] = self.options.size;
        let rgb = self.painter.draw(self.stage.simulation_mut())?.to_vec();
        Ok(Picture { width, height, rgb })
    }

    /// The labelled pictures of the whole episode, the last step among them.
    fn film(&mut self) -> Result<Vec<Picture>, PlayError> {
        let Take { index, object, success, film, .. } = self.take;
        let end = film.stills.len() - 1;
        let steps: Vec<usize> = (0..end).step_by(EVERY).chain([end]).collect();
        let drawn: Result<Vec<_>, PlayError> = steps.iter().map(|&step| self.picture(&film.stills[step])).collect();
        let native = if self.options.native { " · native tendons" } else { "" };
        let caption = |&step: &usize| Caption {
            object: format!("{} · {:.0} g{native}", object.kind.name(), 1e3 * object.mass),
            success: *success,
            time: format!("{:.2} s · step {step}/{end}", STEP * step as f64),
            episode: format!("seed {} · episode {index}", self.options.seed),
        };
        let captions: Vec<Caption> = steps.iter().map(caption).collect();
        Ok(label(drawn?.iter().zip(&captions))?)
    }

    /// Its row on the sheet.
    fn row(&mut self) -> Result<Row, PlayError> {
        let Take { index, object, success, film, .. } = self.take;
        let mut cells = Vec::new();
        for Moment { step, name } in moments(&film.stills) {
            let gap = if name.is_empty() { "" } else { " · " };
            cells.push((self.picture(&film.stills[step])?, format!("{name}{gap}{:.2} s", STEP * step as f64)));
        }
        Ok(Row { lines: lines(*index, object), success: *success, cells })
    }
}

/// What a row says of its object.
fn lines(index: u64, object: &Object) -> Vec<String> {
    let [x, y, z] = object.size.map(|edge| (1e3 * edge).round());
    vec![
        format!("episode {index}"),
        object.kind.name().to_owned(),
        format!("{x} × {y} × {z} mm"),
        format!("{:.0} g, friction {:.2}", 1e3 * object.mass, object.friction),
    ]
}
