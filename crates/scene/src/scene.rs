//! Episodes as data for the viewer.

use hwasp_core::{Cord, Form, Solid};
use serde::Serialize;

use crate::numbers::reals;
use crate::record::Take;
use crate::surface::{Surface, Surfaces};

/// Episodes to be shown. As JSON it is short: numbers over time are base64 of 4-byte numbers, what stays is there once, and
/// so are equal meshes. SI; z is up.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Scene {
    title: String,
    /// Surfaces of meshes and of ground that is not flat.
    surfaces: Vec<Surface>,
    takes: Vec<Episode>,
}

/// An episode.
#[derive(Clone, Debug, PartialEq, Serialize)]
struct Episode {
    index: u64,
    name: String,
    about: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    success: Option<bool>,
    #[serde(skip_serializing_if = "Option::is_none")]
    kind: Option<String>,
    /// Undiscounted.
    #[serde(rename = "return")]
    undiscounted_return: f64,
    discounted_return: f64,
    steps: usize,
    /// The time of each moment, s, what is told of it, and the return so far.
    times: Vec<f32>,
    told: Vec<String>,
    worth: Vec<f32>,
    solids: Vec<Body>,
    cords: Vec<Line>,
}

/// A solid.
#[derive(Clone, Debug, PartialEq, Serialize)]
struct Body {
    form: &'static str,
    /// The number of its surface.
    #[serde(skip_serializing_if = "Option::is_none")]
    surface: Option<usize>,
    colour: [u8; 3],
    opacity: f32,
    fixed: bool,
    /// Three lengths, m, once or for each moment: half the edges of a box or a plane, half the axes of an ellipsoid; two times the
    /// radius and half the length of capsules and cylinders; factors of a surface.
    sizes: String,
    /// Position, m, and quaternion (x, y, z, w), once or for each moment.
    poses: String,
}

/// A cord.
#[derive(Clone, Debug, PartialEq, Serialize)]
struct Line {
    colour: [u8; 3],
    /// Once or for each moment: the number of its parts, then of each part the number of its points and the points, m.
    ways: String,
}

impl Scene {
    /// Of filmed episodes.
    pub fn new(title: impl Into<String>, takes: &[Take]) -> Self {
        let mut surfaces = Surfaces::default();
        let takes = takes.iter().map(|take| episode(take, &mut surfaces)).collect();
        Self { title: title.into(), surfaces: surfaces.all(), takes }
    }

    /// What it is called.
    pub fn title(&self) -> &str {
        &self.title
    }

    /// As JSON.
    pub fn json(&self) -> String {
        serde_json::to_string(self).expect("texts and numbers can be written as JSON")
    }
}

fn episode(take: &Take, surfaces: &mut Surfaces) -> Episode {
    let Take { index, name, moments, result, time_step } = take;
    let first = moments.first().map(|moment| &moment.sight);
    let solids = first.map_or(&[][..], |sight| &sight.solids).iter().enumerate().map(|(i, solid)| {
        let over_time: Vec<&Solid> = moments.iter().filter_map(|moment| moment.sight.solids.get(i)).collect();
        body(solid, &over_time, surfaces)
    });
    let cords = first.map_or(&[][..], |sight| &sight.cords).iter().enumerate().map(|(i, cord)| {
        let ways = moments.iter().filter_map(|moment| moment.sight.cords.get(i)).map(way).collect();
        Line { colour: cord.colour, ways: over_time(ways) }
    });
    Episode {
        index: *index,
        name: name.clone(),
        about: first.map_or_else(String::new, |sight| sight.about.clone()),
        success: take.success(),
        kind: take.kind().map(str::to_owned),
        undiscounted_return: result.undiscounted_return,
        discounted_return: result.discounted_return,
        steps: result.steps,
        times: moments.iter().map(|moment| (moment.step as f64 * time_step) as f32).collect(),
        told: moments.iter().map(|moment| moment.sight.told.clone()).collect(),
        worth: moments.iter().map(|moment| moment.worth as f32).collect(),
        solids: solids.collect(),
        cords: cords.collect(),
    }
}

fn body(solid: &Solid, moments: &[&Solid], surfaces: &mut Surfaces) -> Body {
    let form = match solid.form {
        Form::Plane(_) => "plane",
        Form::Field(_) => "field",
        Form::Ellipsoid(_) => "ellipsoid",
        Form::Capsule { .. } => "capsule",
        Form::Cylinder { .. } => "cylinder",
        Form::Box(_) => "box",
        Form::Mesh(_) => "mesh",
    };
    Body {
        form,
        surface: surfaces.number(&solid.form),
        colour: solid.colour,
        opacity: solid.opacity,
        fixed: solid.fixed,
        sizes: over_time(moments.iter().map(|solid| size(&solid.form)).collect()),
        poses: over_time(moments.iter().map(|solid| pose(solid)).collect()),
    }
}

/// The numbers of each moment, or of one where all are alike.
fn over_time(moments: Vec<Vec<f32>>) -> String {
    let same = moments.windows(2).all(|pair| pair[0] == pair[1]);
    let shown = if same { 1 } else { moments.len() };
    reals(moments.into_iter().take(shown).flatten())
}

fn size(form: &Form) -> Vec<f32> {
    let lengths = match *form {
        Form::Plane([x, y]) => [x, y, 0.0],
        Form::Ellipsoid(lengths) | Form::Box(lengths) => lengths,
        Form::Capsule { radius, half_length } | Form::Cylinder { radius, half_length } => [radius, radius, half_length],
        Form::Field(_) | Form::Mesh(_) => [1.0; 3],
    };
    lengths.map(|length| length as f32).to_vec()
}

fn way(cord: &Cord) -> Vec<f32> {
    let part = |points: &Vec<[f64; 3]>| {
        let points_of = points.iter().flatten().map(|&part| part as f32);
        std::iter::once(points.len() as f32).chain(points_of).collect::<Vec<f32>>()
    };
    std::iter::once(cord.parts.len() as f32).chain(cord.parts.iter().flat_map(part)).collect()
}

/// Position, and the rotation as a quaternion whose largest part is positive.
fn pose(solid: &Solid) -> Vec<f32> {
    let [x, y, z] = solid.axes;
    // Four times the squares of the parts, by the sums along the diagonal.
    let squares =
        [1.0 + x[0] - y[1] - z[2], 1.0 - x[0] + y[1] - z[2], 1.0 - x[0] - y[1] + z[2], 1.0 + x[0] + y[1] + z[2]];
    let largest = (0..4).fold(0, |best, i| if squares[i] > squares[best] { i } else { best });
    let [xy, xz, yz] = [x[1] + y[0], x[2] + z[0], y[2] + z[1]];
    let [wx, wy, wz] = [y[2] - z[1], z[0] - x[2], x[1] - y[0]];
    let products = match largest {
        0 => [squares[0], xy, xz, wx],
        1 => [xy, squares[1], yz, wy],
        2 => [xz, yz, squares[2], wz],
        _ => [wx, wy, wz, squares[3]],
    };
    let length = products.iter().map(|part| part * part).sum::<f64>().sqrt();
    solid.at.into_iter().chain(products.map(|part| part / length)).map(|part| part as f32).collect()
}

#[cfg(test)]
mod tests;
