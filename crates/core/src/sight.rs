//! What is to be seen of an environment, for films: solids where they are, and cords. Whoever draws needs no engine.

use std::sync::Arc;

use crate::mesh::Mesh;

/// One moment of an episode as it looks. Solids and cords are the same ones, in the same order, at every moment of it. SI; z is
/// up.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Sight {
    /// What is solid.
    pub solids: Vec<Solid>,
    /// Ways of tendons.
    pub cords: Vec<Cord>,
    /// What this episode is about, in a few words: the object that is grasped. Empty where there is nothing to say.
    pub about: String,
    /// What is to be known of the moment, such as `12 mm above the floor`; may be empty.
    pub told: String,
    /// What is the case now, such as `contact`: a row of stills shows the first moment of each, in the order of these names.
    pub moments: Vec<&'static str>,
}

/// A body with a surface.
#[derive(Clone, Debug, PartialEq)]
pub struct Solid {
    /// Its shape, in its own frame.
    pub form: Form,
    /// Where its frame is, m.
    pub at: [f64; 3],
    /// The axes of its frame, of length 1.
    pub axes: [[f64; 3]; 3],
    /// Red, green, blue.
    pub colour: [u8; 3],
    /// 1 where nothing is seen through it.
    pub opacity: f32,
    /// Whether it stays where it is whatever happens.
    pub fixed: bool,
}

/// A shape; lengths in m.
#[derive(Clone, Debug, PartialEq)]
pub enum Form {
    /// The plane of the x and y axes: half its edges, 0 for one without end.
    Plane([f64; 2]),
    /// Ground that is not flat: points in rows.
    Field(Arc<[Vec<[f64; 3]>]>),
    /// Half the axes; a ball where they are alike.
    Ellipsoid([f64; 3]),
    /// A cylinder along z with half balls at its ends.
    Capsule {
        /// Of cylinder and balls.
        radius: f64,
        /// Half the length of the cylinder.
        half_length: f64,
    },
    /// A cylinder along z.
    Cylinder {
        /// Its radius.
        radius: f64,
        /// Half its length.
        half_length: f64,
    },
    /// Half the edges.
    Box([f64; 3]),
    /// Triangles.
    Mesh(Arc<Mesh>),
}

/// A cord.
#[derive(Clone, Debug, PartialEq)]
pub struct Cord {
    /// Its parts, each a broken line, m.
    pub parts: Vec<Vec<[f64; 3]>>,
    /// Red, green, blue.
    pub colour: [u8; 3],
}

/// The axes of the world.
const UPRIGHT: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

impl Solid {
    /// A solid that moves and lets nothing through, its axes those of the world.
    pub fn new(form: Form, at: [f64; 3], colour: [u8; 3]) -> Self {
        Self { form, at, axes: UPRIGHT, colour, opacity: 1.0, fixed: false }
    }

    /// A capsule of this radius from one point to another, m; a ball where they are one.
    pub fn rod(ends: [[f64; 3]; 2], radius: f64, colour: [u8; 3]) -> Self {
        Self::between(ends, colour, |half_length| Form::Capsule { radius, half_length })
    }

    /// A cylinder of this radius from the middle of one end to that of the other, m.
    pub fn cylinder(ends: [[f64; 3]; 2], radius: f64, colour: [u8; 3]) -> Self {
        Self::between(ends, colour, |half_length| Form::Cylinder { radius, half_length })
    }

    /// What leads along its own z axis from one point to another; upright where they are one.
    fn between([from, to]: [[f64; 3]; 2], colour: [u8; 3], form: impl FnOnce(f64) -> Form) -> Self {
        let way: [f64; 3] = std::array::from_fn(|k| to[k] - from[k]);
        let length = norm(way);
        let middle = std::array::from_fn(|k| 0.5 * (from[k] + to[k]));
        let upright = Self::new(form(0.5 * length), middle, colour);
        if length == 0.0 {
            return upright;
        }
        let along = way.map(|part| part / length);
        // Across to the axis of the world that is farthest from it.
        let least = (0..3).min_by(|&a, &b| along[a].abs().total_cmp(&along[b].abs())).unwrap_or(0);
        let across = cross(along, UPRIGHT[least]);
        let across = across.map(|part| part / norm(across));
        Self { axes: [across, cross(along, across), along], ..upright }
    }

    /// The same, turned about a line through its own place that is parallel to the y axis of the world, by `angle`, rad: from z
    /// towards x.
    #[must_use]
    pub fn turned(mut self, angle: f64) -> Self {
        let (sin, cos) = angle.sin_cos();
        self.axes = self.axes.map(|[x, y, z]| [cos * x + sin * z, y, cos * z - sin * x]);
        self
    }

    /// The same, at rest whatever happens.
    #[must_use]
    pub fn fixed(self) -> Self {
        Self { fixed: true, ..self }
    }
}

impl Cord {
    /// A cord from point to point, m.
    pub fn new(points: Vec<[f64; 3]>, colour: [u8; 3]) -> Self {
        Self { parts: vec![points], colour }
    }

    /// A spring from one point to another, m, with so many `bends` to either side of the line between them; `across`, m, leads
    /// from that line to the first one.
    pub fn spring([from, to]: [[f64; 3]; 2], across: [f64; 3], bends: usize, colour: [u8; 3]) -> Self {
        let on_line = |share: f64| -> [f64; 3] { std::array::from_fn(|k| from[k] + share * (to[k] - from[k])) };
        let bend = |i: usize| -> [f64; 3] {
            let (at, side) =
                (on_line((i as f64 + 1.0) / (bends as f64 + 1.0)), if i.is_multiple_of(2) { 1.0 } else { -1.0 });
            std::array::from_fn(|k| at[k] + side * across[k])
        };
        Self::new(std::iter::once(from).chain((0..bends).map(bend)).chain([to]).collect(), colour)
    }
}

fn norm(a: [f64; 3]) -> f64 {
    a.iter().map(|part| part * part).sum::<f64>().sqrt()
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn near(a: [f64; 3], b: [f64; 3]) {
        assert!((0..3).all(|k| (a[k] - b[k]).abs() < 1e-12), "{a:?} is not {b:?}");
    }

    /// From (1, 0, 0) to (1, 3, 4): 5 m long, its middle at (1, 1.5, 2), and a right-handed frame along it.
    #[test]
    fn a_rod_leads_from_point_to_point() {
        let rod = Solid::rod([[1.0, 0.0, 0.0], [1.0, 3.0, 4.0]], 0.1, [0; 3]);
        assert_eq!(rod.form, Form::Capsule { radius: 0.1, half_length: 2.5 });
        near(rod.at, [1.0, 1.5, 2.0]);
        near(rod.axes[2], [0.0, 0.6, 0.8]);
        for i in 0..3 {
            near(cross(rod.axes[i], rod.axes[(i + 1) % 3]), rod.axes[(i + 2) % 3]);
        }
        let ball = Solid::rod([[2.0; 3]; 2], 0.1, [0; 3]);
        assert_eq!((ball.form, ball.axes), (Form::Capsule { radius: 0.1, half_length: 0.0 }, UPRIGHT));
    }

    /// A quarter of a turn brings z to x, and x to -z.
    #[test]
    fn a_solid_is_turned() {
        let turned = Solid::new(Form::Box([0.1; 3]), [0.0; 3], [0; 3]).turned(std::f64::consts::FRAC_PI_2);
        near(turned.axes[2], [1.0, 0.0, 0.0]);
        near(turned.axes[0], [0.0, 0.0, -1.0]);
        near(turned.axes[1], [0.0, 1.0, 0.0]);
    }

    #[test]
    fn a_spring_has_bends_on_both_sides() {
        let spring = Cord::spring([[0.0; 3], [0.0, 0.0, -4.0]], [0.2, 0.0, 0.0], 3, [0; 3]);
        let points = [[0.0; 3], [0.2, 0.0, -1.0], [-0.2, 0.0, -2.0], [0.2, 0.0, -3.0], [0.0, 0.0, -4.0]];
        assert_eq!(spring.parts, [points.to_vec()]);
    }
}
