//! Outlines of convex bodies as paths.

use std::fmt::Write;

use super::view::{Flat, View, World, along};

/// A broken line through positions of the picture, closed.
pub(super) fn polygon(corners: &[Flat]) -> String {
    polyline(corners) + "z"
}

/// A straight line.
pub(super) fn line(from: Flat, to: Flat) -> String {
    polyline(&[from, to])
}

/// A dot, for a pen with a round tip.
pub(super) fn dot(place: Flat) -> String {
    format!("M{}h0", pair(place.map(f64::round)))
}

/// A broken line, by the steps from corner to corner, which are short numbers.
pub(super) fn polyline(corners: &[Flat]) -> String {
    let mut path = String::new();
    let mut from = [0.0; 2];
    for (i, corner) in corners.iter().enumerate() {
        // Steps between rounded places: errors do not add up.
        let to = corner.map(f64::round);
        let _ = write!(path, "{}{}", if i == 0 { 'M' } else { 'l' }, pair([to[0] - from[0], to[1] - from[1]]));
        from = to;
    }
    path
}

/// Two whole numbers; a minus parts them as well as a space.
fn pair([x, y]: Flat) -> String {
    let gap = if y < 0.0 { "" } else { " " };
    // There is no minus before nothing.
    format!("{}{gap}{}", x + 0.0, y + 0.0)
}

/// An ellipse: every c + M^(1/2)·(cos t, sin t), where M is the sum of the outer products of some directions with themselves.
/// That is what is seen of an ellipsoid with these half axes, and of a disk with two.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ellipse {
    centre: Flat,
    matrix: [f64; 3],
}

impl Ellipse {
    pub(super) fn seen(view: &View, centre: World, half_axes: &[World]) -> Self {
        let mut matrix = [0.0; 3];
        for [x, y] in half_axes.iter().map(|&axis| view.flat(axis)) {
            matrix[0] += x * x;
            matrix[1] += x * y;
            matrix[2] += y * y;
        }
        Self { centre: view.flat(centre), matrix }
    }

    /// Half its axes, and the angle of the first, rad.
    fn axes(&self) -> (f64, f64, f64) {
        let [a, b, d] = self.matrix;
        let (mean, spread) = (0.5 * (a + d), (0.25 * (a - d) * (a - d) + b * b).sqrt());
        let angle = 0.5 * (2.0 * b).atan2(a - d);
        ((mean + spread).sqrt(), (mean - spread).max(0.0).sqrt(), angle)
    }

    /// Its outline, shrunk about its centre and shifted.
    pub(super) fn path(&self, scale: f64, shift: Flat) -> String {
        let (major, minor, angle) = self.axes();
        let [x, y] = [self.centre[0] + shift[0], self.centre[1] + shift[1]];
        let [dx, dy] = [scale * major * angle.cos(), scale * major * angle.sin()];
        let (radii, turn) = (pair([scale * major, scale * minor].map(f64::round)), angle.to_degrees().round() + 0.0);
        let (from, to) = ([x - dx, y - dy].map(f64::round), [x + dx, y + dy].map(f64::round));
        let arc =
            |way: f64| format!("a{radii} {turn} 1 0 {}", pair([way * (to[0] - from[0]), way * (to[1] - from[1])]));
        format!("M{}{}{}", pair(from), arc(1.0), arc(-1.0))
    }

    /// The farthest point in a direction of the picture.
    pub(super) fn support(&self, [x, y]: Flat) -> Flat {
        let [a, b, d] = self.matrix;
        let (mx, my) = (a * x + b * y, b * x + d * y);
        let norm = (x * mx + y * my).sqrt().max(f64::MIN_POSITIVE);
        [self.centre[0] + mx / norm, self.centre[1] + my / norm]
    }
}

/// The faces of a box that are seen, one for each of its axes: empty for one that is seen from its edge.
pub(super) fn faces(view: &View, centre: World, axes: &[World; 3], half: World) -> [String; 3] {
    std::array::from_fn(|i| {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        let side = if view.sees(axes[i]) { half[i] } else { -half[i] };
        let middle = along(centre, side, axes[i]);
        let corner = |(a, b): (f64, f64)| view.flat(along(along(middle, a * half[j], axes[j]), b * half[k], axes[k]));
        polygon(&[(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(corner))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ball_is_a_circle_of_its_size() {
        let axes = [[0.03, 0.0, 0.0], [0.0, 0.03, 0.0], [0.0, 0.0, 0.03]];
        let ball = Ellipse::seen(&View::default(), [0.0; 3], &axes);
        let (major, minor, _) = ball.axes();
        assert!((major - 300.0).abs() < 1e-9 && (minor - 300.0).abs() < 1e-9);
        let [x, y] = ball.support([0.0, -2.0]);
        assert!(x.abs() < 1e-9 && (y + 300.0).abs() < 1e-9);
    }

    #[test]
    fn paths_by_hand() {
        assert_eq!(polygon(&[[0.4, -3.0], [10.6, 2.0], [-0.2, 2.2]]), "M0-3l11 5l-11 0z");
        assert_eq!((line([1.0, 2.0], [3.0, -4.0]), dot([-0.4, 7.0])), ("M1 2l2-6".into(), "M0 7h0".into()));
    }

    #[test]
    fn a_cube_from_above_and_aside_shows_three_faces() {
        let axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let seen = faces(&View::default(), [0.0; 3], &axes, [0.02; 3]);
        assert!(seen.iter().all(|face| face.starts_with('M') && face.matches('l').count() == 3), "{seen:?}");
    }
}
