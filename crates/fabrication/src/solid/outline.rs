//! Closed outlines in the plane of y and z, m.

/// Corners in counterclockwise order.
pub(crate) type Outline = Vec<[f64; 2]>;

/// Segments of a full circle. Of 12 mm radius it is 6 µm off in the middle of a segment.
pub(crate) const SEGMENTS: usize = 96;

/// Segments of a hole for a wire. Of 1 mm radius it is 9 µm off in the middle of a segment.
pub(crate) const HOLE_SEGMENTS: usize = 24;

/// The regular polygon with its corners on a circle.
pub(crate) fn disc(centre: [f64; 2], radius: f64) -> Outline {
    arc(centre, radius, 0.0, SEGMENTS, SEGMENTS).collect()
}

/// The same of fewer segments, for small holes of which there are many.
pub(crate) fn hole(centre: [f64; 2], radius: f64) -> Outline {
    arc(centre, radius, 0.0, HOLE_SEGMENTS, HOLE_SEGMENTS).collect()
}

/// The radius of a disc whose straight sides keep outside of a circle.
pub(crate) fn around(radius: f64) -> f64 {
    radius / (std::f64::consts::PI / SEGMENTS as f64).cos()
}

/// Everything within `radius` of the segment from `low` up to `high`, along z.
pub(crate) fn slot(y: f64, [low, high]: [f64; 2], radius: f64) -> Outline {
    let half = SEGMENTS / 2;
    let arc = |z: f64, start: f64| arc([y, z], radius, start, half, SEGMENTS);
    arc(low, std::f64::consts::PI).chain(arc(high, 0.0)).collect()
}

/// From `low` to `high` in y and z.
pub(crate) fn rectangle(y: [f64; 2], z: [f64; 2]) -> Outline {
    vec![[y[0], z[0]], [y[1], z[0]], [y[1], z[1]], [y[0], z[1]]]
}

/// Everything within `half` of the segment between two points, with straight ends.
pub(crate) fn band(from: [f64; 2], to: [f64; 2], half: f64) -> Outline {
    let along = [to[0] - from[0], to[1] - from[1]];
    let length = along[0].hypot(along[1]);
    let across = [-along[1] / length * half, along[0] / length * half];
    let beside = |[a, b]: [f64; 2], side: f64| [a + side * across[0], b + side * across[1]];
    polygon(&[beside(from, -1.0), beside(to, -1.0), beside(to, 1.0), beside(from, 1.0)])
}

/// What lies outside of [`slot`] with this radius about y = 0, on the side of negative y, between two heights: to be cut where a pad
/// goes. `high` is the middle of the slot's upper end.
pub(crate) fn shaved(high: f64, radius: f64, [from, to]: [f64; 2]) -> Outline {
    let far = 0.1;
    let step = std::f64::consts::TAU / SEGMENTS as f64;
    if to <= high {
        return rectangle([-far, -radius * (0.5 * step).cos()], [from, to]);
    }
    let quarter = SEGMENTS / 4;
    let arc = arc([0.0, high], radius, std::f64::consts::FRAC_PI_2, quarter, SEGMENTS);
    // The straight side of the polygon is inside of its circle.
    let side = -radius * (0.5 * step).cos();
    let corners: Vec<[f64; 2]> = [[-far, from], [-far, far], [0.0, far], [0.0, high - side]]
        .into_iter()
        .chain(arc)
        .chain([[side, high], [side, from]])
        .collect();
    polygon(&corners)
}

/// Corners in counterclockwise order, whatever order they are given in.
pub(crate) fn polygon(corners: &[[f64; 2]]) -> Outline {
    let mut outline = corners.to_vec();
    if area(&outline) < 0.0 {
        outline.reverse();
    }
    outline
}

/// Corners at the middles of `count` of the `segments` of a circle from `start` on, rad, so that no corner lies on an axis, where
/// lines of other outlines are.
fn arc([y, z]: [f64; 2], radius: f64, start: f64, count: usize, segments: usize) -> impl Iterator<Item = [f64; 2]> {
    let step = std::f64::consts::TAU / segments as f64;
    (0..count).map(move |i| {
        let (sin, cos) = (start + (i as f64 + 0.5) * step).sin_cos();
        [y + radius * cos, z + radius * sin]
    })
}

/// A round outline turned about its middle by an angle, rad; one of few corners stays as it is.
pub(super) fn turned(outline: &Outline, angle: f64) -> Outline {
    if angle == 0.0 || outline.len() < HOLE_SEGMENTS {
        return outline.clone();
    }
    let middle = [0, 1].map(|k| outline.iter().map(|corner| corner[k]).sum::<f64>() / outline.len() as f64);
    let (sin, cos) = angle.sin_cos();
    let turn = |&[y, z]: &[f64; 2]| {
        let [y, z] = [y - middle[0], z - middle[1]];
        [middle[0] + cos * y - sin * z, middle[1] + sin * y + cos * z]
    };
    outline.iter().map(turn).collect()
}

/// Positive for a counterclockwise order.
pub(super) fn area(outline: &[[f64; 2]]) -> f64 {
    edges(outline).map(|([ay, az], [by, bz])| 0.5 * (ay * bz - az * by)).sum()
}

/// Whether a point is inside, by the edges that a ray from it crosses.
pub(super) fn contains(outline: &[[f64; 2]], [y, z]: [f64; 2]) -> bool {
    edges(outline)
        .filter(|&([ay, az], [by, bz])| (az > z) != (bz > z) && y < ay + (by - ay) * (z - az) / (bz - az))
        .count()
        % 2
        == 1
}

/// The sides, from corner to corner.
pub(super) fn edges(outline: &[[f64; 2]]) -> impl Iterator<Item = ([f64; 2], [f64; 2])> {
    outline.iter().copied().zip(outline.iter().copied().cycle().skip(1))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn outlines_have_their_areas_and_insides() {
        let round = SEGMENTS as f64 / 2.0 * (std::f64::consts::TAU / SEGMENTS as f64).sin();
        assert!((area(&disc([1.0, -2.0], 3.0)) - 9.0 * round).abs() < 1e-12);
        assert!((area(&rectangle([0.0, 2.0], [1.0, 4.0])) - 6.0).abs() < 1e-12);
        assert_eq!(area(&polygon(&[[0.0, 0.0], [0.0, 1.0], [1.0, 0.0]])), 0.5);
        let slot = slot(0.0, [0.0, 5.0], 1.0);
        assert!((area(&slot) - (10.0 + std::f64::consts::PI)).abs() < 0.01, "{}", area(&slot));
        for (point, inside) in [([0.0, 5.9], true), ([0.9, 2.5], true), ([0.9, 5.9], false), ([0.0, -1.1], false)] {
            assert_eq!(contains(&slot, point), inside, "{point:?}");
        }
    }
}
