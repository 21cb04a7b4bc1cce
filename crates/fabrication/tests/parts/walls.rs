//! How thick walls are, measured in the meshes: through every part between every two heights.

use super::*;

/// A piece of the edge of a section, and the direction out of the material.
struct Edge {
    from: [f64; 2],
    to: [f64; 2],
    out: [f64; 2],
}

/// The edges of the section at a height.
fn section(mesh: &Mesh, x: f64) -> Vec<Edge> {
    let mut edges = Vec::new();
    for corners in mesh.triangles() {
        let crossings: Vec<[f64; 2]> = (0..3)
            .filter_map(|i| {
                let ([ax, ay, az], [bx, by, bz]) = (corners[i], corners[(i + 1) % 3]);
                let at = (x - ax) / (bx - ax);
                ((ax > x) != (bx > x)).then_some([ay + at * (by - ay), az + at * (bz - az)])
            })
            .collect();
        let [from, to] = crossings[..] else { continue };
        // All that crosses a height stands upright: its normal has no part along x.
        let [a, b, c] = corners;
        let side = |p: [f64; 3], q: [f64; 3]| [p[0] - q[0], p[1] - q[1], p[2] - q[2]];
        let (u, v) = (side(b, a), side(c, a));
        let normal = [u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
        let length = normal[0].hypot(normal[1]);
        edges.push(Edge { from, to, out: normal.map(|n| n / length) });
    }
    edges
}

/// The thinnest wall of a section: between two edges that face away from each other, seen from the middle of the one.
fn thinnest(edges: &[Edge]) -> (f64, [f64; 2]) {
    let mut least = (f64::INFINITY, [0.0; 2]);
    for edge in edges {
        let middle = [0, 1].map(|i| 0.5 * (edge.from[i] + edge.to[i]));
        let inward = edge.out.map(|n| -n);
        let mut nearest = (f64::INFINITY, 0.0);
        for other in edges {
            let along = [other.to[0] - other.from[0], other.to[1] - other.from[1]];
            let gap = [other.from[0] - middle[0], other.from[1] - middle[1]];
            let det = along[0] * inward[1] - along[1] * inward[0];
            if det.abs() < 1e-15 {
                continue;
            }
            let distance = (along[0] * gap[1] - along[1] * gap[0]) / det;
            let share = (inward[0] * gap[1] - inward[1] * gap[0]) / det;
            if distance > 1e-7 && (0.0..=1.0).contains(&share) && distance < nearest.0 {
                nearest = (distance, edge.out[0] * other.out[0] + edge.out[1] * other.out[1]);
            }
        }
        // Edges that meet at an angle are a corner, and no wall.
        if nearest.1 < -0.98 && nearest.0 < least.0 {
            least = (nearest.0, middle);
        }
    }
    least
}

/// "At least 0.6 mm" was 0.41 to 0.44 mm beyond the hole that the line of a distal pulley ends in: the flange stood twice a clearance
/// beyond it, and not a wall. So every wall of every part is measured.
#[test]
fn every_wall_is_as_thick_as_the_workshop_says() {
    let workshop = Workshop::default();
    let mut wide = SEARCHED;
    // At limits, and where the channel comes near the window.
    wide[..4].copy_from_slice(&[0.012, 0.0021, 0.0092, 0.0091]);
    let mut edge = SEARCHED;
    edge[..4].copy_from_slice(&[0.0105, 0.0112, 0.0021, 0.012]);
    let large = [SeatedSpring { wire: 0.6e-3, outer: 0.014, length: 0.006 }; 4];
    let mut least = f64::INFINITY;
    for (design, springs) in [(SEARCHED, SPRINGS), (wide, SPRINGS), (edge, SPRINGS), (wide, large)] {
        for Part { name, mesh, .. } in parts(&HandDescription::default(), &design, &springs, &workshop).unwrap() {
            let mut heights: Vec<f64> = mesh.triangles().flatten().map(|corner| corner[0]).collect();
            heights.sort_by(f64::total_cmp);
            heights.dedup_by(|a, b| (*a - *b).abs() < 1e-9);
            for pair in heights.windows(2) {
                let (thin, [y, z]) = thinnest(&section(&mesh, 0.5 * (pair[0] + pair[1])));
                assert!(
                    thin > workshop.wall - 1e-6,
                    "{name}: {:.3} mm at x from {:.2} to {:.2}, y {:.2}, z {:.2} mm",
                    1e3 * thin,
                    1e3 * pair[0],
                    1e3 * pair[1],
                    1e3 * y,
                    1e3 * z
                );
                least = least.min(thin);
            }
        }
    }
    // Some are just so thick, which shows that they are measured.
    assert!(least < 1.01 * workshop.wall, "{least}");
}

/// Along the axle: flanges, cheeks, floors of pockets. Through points all over a part, how much material there is between entering and
/// leaving it.
#[test]
fn walls_across_the_axle_are_as_thick_too() {
    let workshop = Workshop::default();
    let longest = [SeatedSpring { wire: 0.6e-3, outer: 0.014, length: 0.006 }; 4];
    let mut least = f64::INFINITY;
    for Part { name, mesh, .. } in parts(&HandDescription::default(), &SEARCHED, &longest, &workshop).unwrap() {
        let flat = |corners: &[[f64; 3]; 3]| corners.iter().all(|corner| (corner[0] - corners[0][0]).abs() < 1e-12);
        let faces: Vec<_> = mesh.triangles().filter(flat).collect();
        let [low, high] = mesh.bounds();
        for (i, j) in (0..48).flat_map(|i| (0..48).map(move |j| (i, j))) {
            let at = |axis: usize, k: u32| low[axis] + (high[axis] - low[axis]) * (f64::from(k) + 0.3217) / 48.0;
            let point = [at(1, i), at(2, j)];
            let mut crossed: Vec<f64> =
                faces.iter().filter(|face| is_over(face, point)).map(|face| face[0][0]).collect();
            crossed.sort_by(f64::total_cmp);
            assert!(crossed.len().is_multiple_of(2), "{name}: open at {point:?}");
            for pair in crossed.chunks(2) {
                assert!(pair[1] - pair[0] > workshop.wall - 1e-9, "{name}: {pair:?} at {point:?}");
                least = least.min(pair[1] - pair[0]);
            }
        }
    }
    // The floor behind the longest springs, and flanges: 1 mm.
    assert!((least - 0.001).abs() < 1e-9, "{least}");
}

/// Whether a triangle that stands across the axle has a point of the plane inside.
fn is_over(face: &[[f64; 3]; 3], [y, z]: [f64; 2]) -> bool {
    let turn = |a: [f64; 3], b: [f64; 3]| (b[1] - a[1]) * (z - a[2]) - (b[2] - a[2]) * (y - a[1]) > 0.0;
    let [a, b, c] = *face;
    turn(a, b) == turn(b, c) && turn(b, c) == turn(c, a)
}
