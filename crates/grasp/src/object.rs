//! What is grasped: an object drawn anew for each episode.

use hwasp_core::Stream;
use rand::RngExt;

use crate::settings::{GraspSettings, Inertia, ShapeKind};
use hwasp_mujoco::engine::{BodyId, EditError, GeomId, Shape, Simulation};

/// An object and where it lies.
#[derive(Clone, Debug, PartialEq)]
pub struct Object {
    /// Its shape.
    pub kind: ShapeKind,
    /// Edges of its bounding box in its own frame, m.
    pub size: [f64; 3],
    /// Mass, kg.
    pub mass: f64,
    /// Principal moments of inertia, kg·m².
    pub inertia: [f64; 3],
    /// Coefficient of sliding friction, on hand and floor.
    pub friction: f64,
    /// Its centre on the floor, x and y, m.
    pub place: [f64; 2],
    /// Turned about the vertical, rad.
    pub yaw: f64,
    /// Whether a cylinder lies on its side.
    pub lying: bool,
}

fn between(range: [f64; 2], rng: &mut Stream) -> f64 {
    range[0] + (range[1] - range[0]) * rng.random::<f64>()
}

impl Object {
    /// Draws one at this fraction of training. Every quantity is drawn, whether its range has a width or not, so that narrowing one range leaves the
    /// other draws as they were; the inertia is last, as it may be drawn more than once.
    pub fn draw(settings: &GraspSettings, progress: f64, rng: &mut Stream) -> Self {
        let kinds = &settings.shapes;
        let kind = kinds[(rng.random::<f64>() * kinds.len() as f64) as usize % kinds.len()];
        let drawn: [f64; 3] = std::array::from_fn(|_| between(settings.size, rng));
        let size = match kind {
            ShapeKind::Sphere => [drawn[0]; 3],
            ShapeKind::Cylinder => [drawn[0], drawn[0], drawn[2]],
            ShapeKind::Box | ShapeKind::Ellipsoid => drawn,
        };
        let mass = between(settings.mass, rng) * settings.load_ramp.map_or(1.0, |ramp| ramp.at(progress));
        let friction = between(settings.friction, rng);
        let offset = settings.offset_ramp.map_or(settings.offset, |ramp| ramp.at(progress));
        let place: [f64; 2] = std::array::from_fn(|_| between([-offset, offset], rng));
        let yaw = between([-settings.yaw, settings.yaw], rng);
        let lying = kind == ShapeKind::Cylinder && rng.random::<f64>() < settings.lying;
        let inertia = match settings.inertia {
            Inertia::Independent(range) => loop {
                let moments: [f64; 3] = std::array::from_fn(|_| between(range, rng));
                // The triangle inequality, which every rigid body keeps.
                if 2.0 * moments.iter().fold(0.0_f64, |a, &b| a.max(b)) <= moments.iter().sum() {
                    break moments;
                }
            },
            Inertia::Physical => shape(kind, size).inertia(mass),
        };
        Self { kind, size, mass, inertia, friction, place, yaw, lying }
    }

    /// As the engine knows it.
    pub fn shape(&self) -> Shape {
        shape(self.kind, self.size)
    }

    /// Its bounding box as it lies at the start, m: what the controller is told.
    pub fn bounding_box(&self) -> [f64; 3] {
        let [x, y, z] = self.size;
        if self.lying { [z, y, x] } else { [x, y, z] }
    }

    /// Gives the model's object its shape, its inertia and, with the floor, its friction. Where it lies is [`Self::pose`].
    ///
    /// # Errors
    /// Where the engine does not take them for those of a body.
    pub fn enter(
        &self,
        simulation: &mut Simulation,
        body: BodyId,
        geom: GeomId,
        floor: GeomId,
    ) -> Result<(), EditError> {
        let [on_object, on_floor] = [geom, floor].map(|geom| {
            let [_, spin, roll] = simulation.friction(geom);
            [self.friction, spin, roll]
        });
        simulation
            .edit()
            .shape(geom, self.shape())?
            .inertial(body, self.mass, self.inertia)?
            .friction(geom, on_object)?
            .friction(floor, on_floor)?;
        Ok(())
    }

    /// Position and orientation (w, x, y, z) at rest on the floor.
    pub fn pose(&self) -> [f64; 7] {
        let [x, y] = self.place;
        let (sin, cos) = (0.5 * self.yaw).sin_cos();
        // Turned by 90° about y if it lies, then by the yaw about z.
        let (w, ey) = if self.lying { (0.5_f64.sqrt(), 0.5_f64.sqrt()) } else { (1.0, 0.0) };
        [x, y, 0.5 * self.bounding_box()[2], cos * w, -sin * ey, cos * ey, sin * w]
    }

    /// How far its lowest point is below its centre, m, when the vertical is `up` in its own frame.
    pub fn reach_down(&self, up: [f64; 3]) -> f64 {
        let half = self.size.map(|edge| 0.5 * edge);
        let stretched = [0, 1, 2].map(|i| up[i] * half[i]);
        match self.kind {
            ShapeKind::Sphere => half[0],
            ShapeKind::Box => stretched.iter().map(|s| s.abs()).sum(),
            ShapeKind::Cylinder => stretched[0].hypot(stretched[1]) + stretched[2].abs(),
            ShapeKind::Ellipsoid => stretched.iter().map(|s| s * s).sum::<f64>().sqrt(),
        }
    }
}

/// What the engine takes for a shape with this bounding box.
fn shape(kind: ShapeKind, size: [f64; 3]) -> Shape {
    let half = size.map(|edge| 0.5 * edge);
    match kind {
        ShapeKind::Sphere => Shape::Sphere { radius: half[0] },
        ShapeKind::Box => Shape::Box { half },
        ShapeKind::Cylinder => Shape::Cylinder { radius: half[0], half_length: half[2] },
        ShapeKind::Ellipsoid => Shape::Ellipsoid { radii: half },
    }
}

/// The third row of the rotation that a unit quaternion (w, x, y, z) stands for: the world's vertical in the body's frame.
pub(super) fn vertical([w, x, y, z]: [f64; 4]) -> [f64; 3] {
    [2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)]
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;

    use super::*;

    #[test]
    fn what_is_drawn_lies_on_the_floor_and_in_its_ranges() {
        let settings = GraspSettings { offset: 0.05, lying: 0.5, yaw: 1.0, ..GraspSettings::default() };
        let mut rng = Stream::seed_from_u64(3);
        let mut kinds = [0; 4];
        for _ in 0..400 {
            let object = Object::draw(&settings, 1.0, &mut rng);
            kinds[ShapeKind::ALL.iter().position(|&(_, k)| k == object.kind).unwrap()] += 1;
            assert!(object.size.iter().all(|s| (0.04..=0.1).contains(s)), "{object:?}");
            assert!((0.1..=0.5).contains(&object.mass) && (0.5..=1.0).contains(&object.friction), "{object:?}");
            assert!(object.place.iter().all(|p| p.abs() <= 0.05));
            let [.., z, w, i, j, k] = object.pose();
            let down = object.reach_down(vertical([w, i, j, k]));
            assert!((z - down).abs() < 1e-12, "{object:?}: {z} is not {down}");
        }
        assert!(kinds.iter().all(|count| (70..130).contains(count)), "{kinds:?}");
    }

    #[test]
    fn moments_by_hand() {
        let near =
            |a: [f64; 3], b: [f64; 3]| assert!(a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-12), "{a:?} {b:?}");
        // 2/5·m·r², m/12·(b² + c²), m/12·(3r² + h²) and m·r²/2.
        near(shape(ShapeKind::Sphere, [0.1; 3]).inertia(0.5), [0.4 * 0.5 * 0.0025; 3]);
        let [a, b, c] = [0.04, 0.06, 0.1];
        near(
            shape(ShapeKind::Box, [a, b, c]).inertia(1.2),
            [0.1 * (b * b + c * c), 0.1 * (a * a + c * c), 0.1 * (a * a + b * b)],
        );
        let across = 0.1 * (3.0 * 0.02 * 0.02 + 0.1 * 0.1);
        near(shape(ShapeKind::Cylinder, [0.04, 0.04, 0.1]).inertia(1.2), [across, across, 0.6 * 0.02 * 0.02]);
    }
}
