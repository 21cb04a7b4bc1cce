//! Outlines of solids as paths.

use std::fmt::Write;

use hwasp_core::{Form, Solid};

use super::eye::{Eye, Flat, World, along, inner};

/// A broken line through positions of the picture, closed.
pub(super) fn polygon(corners: &[Flat]) -> String {
    polyline(corners) + "z"
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

/// What is seen of a solid, edges between its faces included; empty for ground, which is drawn apart.
pub(super) fn outline(eye: &Eye, solid: &Solid) -> String {
    let Solid { at, axes, .. } = solid;
    let end = |half_length: f64| along(*at, half_length, axes[2]);
    match &solid.form {
        Form::Plane(_) | Form::Field(_) => String::new(),
        Form::Ellipsoid(radii) => {
            let half_axes: [World; 3] = std::array::from_fn(|i| axes[i].map(|part| radii[i] * part));
            Ellipse::seen(eye, *at, &half_axes).path()
        }
        Form::Capsule { radius, half_length } => {
            let ends = [end(*half_length), end(-half_length)].map(|end| eye.flat(end));
            capsule(ends, eye.length(*radius))
        }
        Form::Cylinder { radius, half_length } => {
            let disk: [World; 2] = std::array::from_fn(|i| axes[i].map(|part| radius * part));
            let side = if eye.sees(axes[2]) { *half_length } else { -half_length };
            let [near, far] = [end(side), end(-side)].map(|end| Ellipse::seen(eye, end, &disk));
            cylinder(&near, &far)
        }
        Form::Box(half) => faces(eye, *at, axes, *half).concat(),
        Form::Mesh(mesh) => {
            let seen = |point: &World| eye.flat((0..3).fold(*at, |sum, i| along(sum, point[i], axes[i])));
            polygon(&hull(mesh.corners().iter().map(seen).collect()))
        }
    }
}

/// How far a solid reaches in a direction, from the world's origin.
pub(super) fn reach(solid: &Solid, direction: World) -> f64 {
    let own: World = std::array::from_fn(|i| inner(direction, solid.axes[i]));
    let length = |parts: &[f64]| parts.iter().map(|part| part * part).sum::<f64>().sqrt();
    let out = match &solid.form {
        Form::Plane(_) | Form::Field(_) => 0.0,
        Form::Ellipsoid([a, b, c]) => length(&[a * own[0], b * own[1], c * own[2]]),
        Form::Capsule { radius, half_length } => radius * length(&own) + half_length * own[2].abs(),
        Form::Cylinder { radius, half_length } => radius * length(&own[..2]) + half_length * own[2].abs(),
        Form::Box(half) => (0..3).map(|i| half[i] * own[i].abs()).sum(),
        Form::Mesh(mesh) => mesh.corners().iter().map(|&point| inner(point, own)).fold(f64::NEG_INFINITY, f64::max),
    };
    inner(direction, solid.at) + out
}

/// A radius for half an ellipse between rounded ends: a little too short, so that it is stretched to fit exactly. One that is too
/// long would be a smaller part of the ellipse.
fn short(radius: f64) -> f64 {
    (radius - 1.0).floor().max(1.0)
}

/// Two circles and what is between them.
fn capsule([from, to]: [Flat; 2], radius: f64) -> String {
    let [dx, dy] = [to[0] - from[0], to[1] - from[1]];
    let length = dx.hypot(dy);
    if length < 1.0 {
        return Ellipse { centre: from, matrix: [radius * radius, 0.0, radius * radius] }.path();
    }
    let across = [dy / length * radius, -dx / length * radius];
    let corner = |end: Flat, side: f64| [end[0] + side * across[0], end[1] + side * across[1]];
    let corners =
        [corner(from, 1.0), corner(to, 1.0), corner(to, -1.0), corner(from, -1.0)].map(|at| at.map(f64::round));
    let step = |a: usize, b: usize| pair([corners[b][0] - corners[a][0], corners[b][1] - corners[a][1]]);
    let radius = short(radius);
    let arc = |a, b| format!("a{radius} {radius} 0 0 1 {}", step(a, b));
    format!("M{}l{}{}l{}{}z", pair(corners[0]), step(0, 1), arc(1, 2), step(2, 3), arc(3, 0))
}

/// The near end, and the side with half of the far end's edge.
fn cylinder(near: &Ellipse, far: &Ellipse) -> String {
    let [x, y] = [far.centre[0] - near.centre[0], far.centre[1] - near.centre[1]];
    if x.hypot(y) < 1.0 {
        return near.path();
    }
    let (across, back) = ([y, -x], [-y, x]);
    let corners = [near.support(across), far.support(across), far.support(back), near.support(back)];
    let corners = corners.map(|at| at.map(f64::round));
    let step = |a: usize, b: usize| pair([corners[b][0] - corners[a][0], corners[b][1] - corners[a][1]]);
    let (start, to, arc) = (pair(corners[0]), step(0, 1), far.arc(&step(1, 2)));
    // Not closed: the near end has an edge of its own there.
    format!("M{start}l{to}{arc}l{}{}", step(2, 3), near.path())
}

/// An ellipse: every c + M^(1/2)·(cos t, sin t), where M is the sum of the outer products of some directions with themselves.
/// That is what is seen of an ellipsoid with these half axes, and of a disk with two.
#[derive(Clone, Copy, Debug)]
struct Ellipse {
    centre: Flat,
    matrix: [f64; 3],
}

impl Ellipse {
    fn seen(eye: &Eye, centre: World, half_axes: &[World]) -> Self {
        let mut matrix = [0.0; 3];
        for [x, y] in half_axes.iter().map(|&axis| eye.flat(axis)) {
            matrix[0] += x * x;
            matrix[1] += x * y;
            matrix[2] += y * y;
        }
        Self { centre: eye.flat(centre), matrix }
    }

    /// Half its axes, and the angle of the first, rad.
    fn axes(&self) -> (f64, f64, f64) {
        let [a, b, d] = self.matrix;
        let (mean, spread) = (0.5 * (a + d), (0.25 * (a - d) * (a - d) + b * b).sqrt());
        let angle = 0.5 * (2.0 * b).atan2(a - d);
        ((mean + spread).sqrt(), (mean - spread).max(0.0).sqrt(), angle)
    }

    /// Half of it by a step, clockwise.
    fn arc(&self, step: &str) -> String {
        let (major, minor, angle) = self.axes();
        let across = short(major);
        // The ratio counts: tenths of it are seen where an ellipse is flat.
        let radii = pair([across, (10.0 * across * minor / major.max(f64::MIN_POSITIVE)).round() / 10.0]);
        // A circle looks the same however it is turned.
        let turn = if major - minor < 0.5 { 0.0 } else { angle.to_degrees().round() + 0.0 };
        format!("a{radii} {turn} 0 1 {step}")
    }

    /// Its outline.
    fn path(&self) -> String {
        let (major, minor, angle) = self.axes();
        let angle = if major - minor < 0.5 { 0.0 } else { angle };
        let [x, y] = self.centre;
        let [dx, dy] = [major * angle.cos(), major * angle.sin()];
        let (from, to) = ([x - dx, y - dy].map(f64::round), [x + dx, y + dy].map(f64::round));
        let arc = |way: f64| self.arc(&pair([way * (to[0] - from[0]), way * (to[1] - from[1])]));
        format!("M{}{}{}", pair(from), arc(1.0), arc(-1.0))
    }

    /// The farthest point in a direction of the picture.
    fn support(&self, [x, y]: Flat) -> Flat {
        let [a, b, d] = self.matrix;
        let (mx, my) = (a * x + b * y, b * x + d * y);
        let norm = (x * mx + y * my).sqrt().max(f64::MIN_POSITIVE);
        [self.centre[0] + mx / norm, self.centre[1] + my / norm]
    }
}

/// The faces of a box that are seen, one for each of its axes.
fn faces(eye: &Eye, centre: World, axes: &[World; 3], half: World) -> [String; 3] {
    std::array::from_fn(|i| {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        let side = if eye.sees(axes[i]) { half[i] } else { -half[i] };
        let middle = along(centre, side, axes[i]);
        let corner = |(a, b): (f64, f64)| eye.flat(along(along(middle, a * half[j], axes[j]), b * half[k], axes[k]));
        polygon(&[(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(corner))
    })
}

/// The corners of the convex hull of points, in order.
fn hull(mut points: Vec<Flat>) -> Vec<Flat> {
    for point in &mut points {
        *point = point.map(f64::round);
    }
    points.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    points.dedup();
    if points.len() < 3 {
        return points;
    }
    let turns = |a: Flat, b: Flat, c: Flat| (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    let half = |points: &mut dyn Iterator<Item = Flat>| {
        let mut chain: Vec<Flat> = Vec::new();
        for point in points {
            while chain.len() > 1 && turns(chain[chain.len() - 2], chain[chain.len() - 1], point) <= 0.0 {
                chain.pop();
            }
            chain.push(point);
        }
        chain.pop();
        chain
    };
    let mut corners = half(&mut points.iter().copied());
    corners.extend(half(&mut points.iter().rev().copied()));
    corners
}

#[cfg(test)]
mod tests {
    use hwasp_core::Mesh;

    use super::*;

    /// From the south, level: x is to the right, and a metre is 1000 units.
    fn south() -> Eye {
        Eye::new(-std::f64::consts::FRAC_PI_2, 0.0, 1000.0)
    }

    fn solid(form: Form) -> Solid {
        Solid::new(form, [0.0; 3], [0; 3])
    }

    /// Of an outline only the points matter.
    fn mesh(points: &[World]) -> Form {
        Form::Mesh(Mesh::new(points.to_vec(), Vec::new()).into())
    }

    #[test]
    fn paths_by_hand() {
        assert_eq!(polygon(&[[0.4, -3.0], [10.6, 2.0], [-0.2, 2.2]]), "M0-3l11 5l-11 0z");
        let seen = |form| outline(&south(), &solid(form));
        assert_eq!(seen(Form::Ellipsoid([0.1; 3])), "M-100 0a99 99 0 0 1 200 0a99 99 0 0 1 -200 0");
        // From its upper left corner down, around the lower end, and back.
        let capsule = Form::Capsule { radius: 0.05, half_length: 0.1 };
        assert_eq!(seen(capsule), "M50-100l0 200a49 49 0 0 1 -100 0l0-200a49 49 0 0 1 100 0z");
        let points = [[0.1, 0.0, 0.0], [-0.1, 0.3, 0.0], [0.0, 0.0, 0.1], [0.0, 0.2, 0.02]];
        assert_eq!(seen(mesh(&points)), "M-100 0l100-100l100 100z");
        assert!(seen(Form::Plane([0.0; 2])).is_empty());
    }

    #[test]
    fn a_cube_from_above_and_aside_shows_three_faces() {
        let eye = Eye::new(-0.55, 0.28, 1000.0);
        let seen = outline(&eye, &solid(Form::Box([0.02; 3])));
        assert_eq!((seen.matches('M').count(), seen.matches('l').count()), (3, 9), "{seen}");
    }

    /// Every form lies within what it reaches to, and touches it: a turned one in a slanting direction.
    #[test]
    fn solids_reach_to_their_farthest_point() {
        let root = 0.5_f64.sqrt();
        let forms = [
            (Form::Ellipsoid([0.3, 0.1, 0.2]), (0.3_f64 * 0.3 * 0.5 + 0.1 * 0.1 * 0.5).sqrt()),
            (Form::Capsule { radius: 0.1, half_length: 0.4 }, 0.1),
            (Form::Cylinder { radius: 0.2, half_length: 0.4 }, 0.2),
            (Form::Box([0.3, 0.1, 0.2]), root * 0.4),
            (mesh(&[[0.3, 0.3, 0.0], [-1.0, 0.0, 0.0]]), root * 0.6),
        ];
        for (form, expected) in forms {
            let far = reach(&Solid { at: [0.0, 0.0, 5.0], ..solid(form.clone()) }, [root, root, 0.0]);
            assert!((far - expected).abs() < 1e-12, "{form:?}: {far}");
        }
    }
}
