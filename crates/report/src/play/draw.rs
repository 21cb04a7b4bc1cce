//! Films of grasps that the engine renders.

use hwasp_grasp::{Object, Stage, Still};
use hwasp_mujoco::engine::{EditError, Painter};
use hwasp_tasks::hand::names;
use hwasp_training::Assembly;

use super::film::grasp;
use super::shown::Shown;
use super::{Caption, Grasped, Moment, Picture, PlayError, PlayOptions, Row, film, label, moments};

/// Pictures a second, and what a step lasts, s.
const RATE: usize = 20;
const STEP: f64 = 0.01;
/// Steps between pictures, so that films run at the speed of life.
const EVERY: usize = 100 / RATE;

/// What renders.
pub(super) struct Renderer {
    stage: Stage,
    painter: Painter,
}

impl Renderer {
    /// For the grasps of an experiment.
    pub(super) fn new(assembly: &Assembly, size: [usize; 2]) -> Result<Self, PlayError> {
        let stage = Stage::new(&grasp(assembly, None)?);
        let camera = stage.simulation().camera(names::CAMERA)?;
        let painter = Painter::new(stage.simulation(), camera, size)?;
        Ok(Self { stage, painter })
    }

    /// Runs, films and renders the episodes of `options`, one after the other.
    pub(super) fn grasps<'a>(
        &'a mut self,
        assembly: &Assembly,
        params: &[f32],
        options: &'a PlayOptions,
    ) -> Result<impl Iterator<Item = Result<Shown, PlayError>> + 'a, PlayError> {
        let takes = film(assembly, params, options)?;
        Ok(takes.into_iter().map(|take| Scene { renderer: &mut *self, take: &take, options }.shown()))
    }
}

/// An episode in front of the camera.
struct Scene<'a> {
    renderer: &'a mut Renderer,
    take: &'a Grasped,
    options: &'a PlayOptions,
}

impl Scene<'_> {
    fn shown(mut self) -> Result<Shown, PlayError> {
        let Grasped { index, object, success, .. } = self.take;
        let failed = |error: EditError| PlayError::Pose { index: *index, what: error.to_string() };
        self.renderer.stage.set(object).map_err(failed)?;
        Ok(Shown {
            index: *index,
            kind: object.kind.name().to_owned(),
            success: Some(*success),
            pictures: self.film()?,
            pace: 1.0 / RATE as f64,
            row: self.row()?,
        })
    }

    fn picture(&mut self, still: &Still) -> Result<Picture, PlayError> {
        let index = self.take.index;
        let Renderer { stage, painter } = self.renderer;
        stage.pose(still).map_err(|error| PlayError::Pose { index, what: error.to_string() })?;
        let [width, height] = self.options.size;
        let rgb = painter.draw(stage.simulation_mut())?.to_vec();
        Ok(Picture { width, height, rgb })
    }

    /// The labelled pictures of the whole episode, the last step among them.
    fn film(&mut self) -> Result<Vec<Picture>, PlayError> {
        let Grasped { index, object, success, film, .. } = self.take;
        let end = film.stills.len() - 1;
        let steps: Vec<usize> = (0..end).step_by(EVERY).chain([end]).collect();
        let drawn: Result<Vec<_>, PlayError> = steps.iter().map(|&step| self.picture(&film.stills[step])).collect();
        let native = if self.options.native { " · native tendons" } else { "" };
        let caption = |&step: &usize| Caption {
            object: format!("{} · {:.0} g{native}", object.kind.name(), 1e3 * object.mass),
            success: Some(*success),
            time: format!("{:.2} s · step {step}/{end}", STEP * step as f64),
            episode: format!("seed {} · episode {index}", self.options.seed),
        };
        let captions: Vec<Caption> = steps.iter().map(caption).collect();
        Ok(label(drawn?.iter().zip(&captions))?)
    }

    /// Its row on the sheet.
    fn row(&mut self) -> Result<Row, PlayError> {
        let Grasped { index, object, success, film, .. } = self.take;
        let mut cells = Vec::new();
        for Moment { step, name } in moments(&film.stills) {
            let gap = if name.is_empty() { "" } else { " · " };
            cells.push((self.picture(&film.stills[step])?, format!("{name}{gap}{:.2} s", STEP * step as f64)));
        }
        Ok(Row { lines: lines(*index, object), success: Some(*success), cells })
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
