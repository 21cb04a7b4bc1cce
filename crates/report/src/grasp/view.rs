//! From the world to the picture: a parallel projection, which keeps parallels and the sizes along its plane.

/// A position or a direction in the world, m; z is up.
pub(super) type World = [f64; 3];
/// A position in the picture, tenths of a millimetre; y is down.
pub(super) type Flat = [f64; 2];

/// From the x axis towards the fingers, and up, rad: where the camera of `hwasp play` stands.
const AZIMUTH: f64 = -0.55;
const ELEVATION: f64 = 0.28;
/// Units of the picture per metre.
const SCALE: f64 = 1e4;

/// The direction of the view.
#[derive(Clone, Copy, Debug)]
pub(super) struct View {
    right: World,
    up: World,
    /// Towards the eye.
    towards: World,
}

impl Default for View {
    fn default() -> Self {
        let ((sin, cos), (rise, run)) = (AZIMUTH.sin_cos(), ELEVATION.sin_cos());
        Self { right: [-sin, cos, 0.0], up: [-rise * cos, -rise * sin, run], towards: [run * cos, run * sin, rise] }
    }
}

impl View {
    /// Where a position is seen, or how a direction is seen.
    pub(super) fn flat(&self, at: World) -> Flat {
        [SCALE * inner(self.right, at), -SCALE * inner(self.up, at)]
    }

    /// A length along the plane of the picture.
    pub(super) fn length(metres: f64) -> f64 {
        SCALE * metres
    }

    /// Whether a surface with this outward normal is seen.
    pub(super) fn sees(&self, normal: World) -> bool {
        inner(self.towards, normal) > 0.0
    }
}

/// The inner product.
pub(super) fn inner(a: World, b: World) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// `a + t·b`.
pub(super) fn along(a: World, t: f64, b: World) -> World {
    [a[0] + t * b[0], a[1] + t * b[1], a[2] + t * b[2]]
}

/// `a - b`.
pub(super) fn minus(a: World, b: World) -> World {
    along(a, -1.0, b)
}

/// The axes of a body whose orientation is the unit quaternion (w, x, y, z).
pub(super) fn axes([w, x, y, z]: [f64; 4]) -> [World; 3] {
    [
        [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + w * z), 2.0 * (x * z - w * y)],
        [2.0 * (x * y - w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z + w * x)],
        [2.0 * (x * z + w * y), 2.0 * (y * z - w * x), 1.0 - 2.0 * (x * x + y * y)],
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_view_is_a_rotation() {
        let View { right, up, towards } = View::default();
        let units = [(right, right, 1.0), (up, up, 1.0), (towards, towards, 1.0), (right, up, 0.0), (up, towards, 0.0)];
        for (a, b, expected) in units {
            assert!((inner(a, b) - expected).abs() < 1e-12);
        }
        // The eye is above, and on the thumb's side.
        assert!(View::default().sees([0.0, 0.0, 1.0]) && View::default().sees([0.0, -1.0, 0.0]));
    }

    #[test]
    fn axes_of_a_quarter_turn_about_z() {
        let half = 0.5_f64.sqrt();
        let [x, y, z] = axes([half, 0.0, 0.0, half]);
        let near = |a: World, b: World| minus(a, b).iter().all(|d| d.abs() < 1e-12);
        assert!(near(x, [0.0, 1.0, 0.0]) && near(y, [-1.0, 0.0, 0.0]) && near(z, [0.0, 0.0, 1.0]), "{x:?} {y:?} {z:?}");
    }
}
