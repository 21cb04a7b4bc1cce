//! From the world to the picture: a parallel projection, which keeps parallels and the sizes along its plane.

/// A position or a direction in the world, m; z is up.
pub(super) type World = [f64; 3];
/// A position in the picture; y is down.
pub(super) type Flat = [f64; 2];

/// The direction of the view.
#[derive(Clone, Copy, Debug)]
pub(super) struct Eye {
    right: World,
    up: World,
    /// Towards the eye.
    pub(super) towards: World,
    /// Units of the picture per metre.
    scale: f64,
}

impl Eye {
    /// From where the eye stands: its direction from the x axis towards y, and up, rad. `scale`: units per metre.
    pub(super) fn new(azimuth: f64, elevation: f64, scale: f64) -> Self {
        let ((sin, cos), (rise, run)) = (azimuth.sin_cos(), elevation.sin_cos());
        Self {
            right: [-sin, cos, 0.0],
            up: [-rise * cos, -rise * sin, run],
            towards: [run * cos, run * sin, rise],
            scale,
        }
    }

    /// The same with another scale.
    pub(super) fn scaled(self, scale: f64) -> Self {
        Self { scale, ..self }
    }

    /// Where a position is seen, or how a direction is seen.
    pub(super) fn flat(&self, at: World) -> Flat {
        [self.scale * inner(self.right, at), -self.scale * inner(self.up, at)]
    }

    /// A length along the plane of the picture.
    pub(super) fn length(&self, metres: f64) -> f64 {
        self.scale * metres
    }

    /// The direction in the world that is seen as this one.
    pub(super) fn lift(&self, [x, y]: Flat) -> World {
        along(self.right.map(|part| x * part), -y, self.up)
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

/// The vector product.
pub(super) fn cross(a: World, b: World) -> World {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_view_is_a_rotation() {
        let eye = Eye::new(-0.55, 0.28, 1.0);
        let Eye { right, up, towards, .. } = eye;
        let units = [(right, right, 1.0), (up, up, 1.0), (towards, towards, 1.0), (right, up, 0.0), (up, towards, 0.0)];
        for (a, b, expected) in units {
            assert!((inner(a, b) - expected).abs() < 1e-12);
        }
        assert!(inner(cross(right, up), towards) > 0.99, "right, up and towards the eye are a right-handed frame");
        assert!(eye.sees([0.0, 0.0, 1.0]) && eye.sees([0.0, -1.0, 0.0]));
        let [x, y] = eye.flat(eye.lift([0.3, -0.4]));
        assert!((x - 0.3).abs() < 1e-12 && (y + 0.4).abs() < 1e-12);
    }
}
