//! How thick the walls of a stack are, measured in its mesh.

use super::layers::Axis;
use super::mesh::Mesh;

/// The thinnest wall of a part.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wall {
    /// How thick it is, m.
    pub thickness: f64,
    /// Where it is, m in the frame of the part.
    pub at: [f64; 3],
}

/// A piece of the edge of a section, and the direction out of the material.
struct Edge {
    from: [f64; 2],
    to: [f64; 2],
    out: [f64; 2],
}

/// The thinnest wall between two sides that face away from each other, in the middle between every two heights.
pub(crate) fn thinnest_across(mesh: &Mesh, axis: Axis) -> Wall {
    let triangles: Vec<[(f64, [f64; 2]); 3]> =
        mesh.triangles().map(|corners| corners.map(|corner| axis.split(corner))).collect();
    let mut heights: Vec<f64> = triangles.iter().flatten().map(|corner| corner.0).collect();
    heights.sort_by(f64::total_cmp);
    heights.dedup_by(|a, b| (*a - *b).abs() < 1e-9);
    let mut least = Wall { thickness: f64::INFINITY, at: [0.0; 3] };
    for pair in heights.windows(2) {
        let height = 0.5 * (pair[0] + pair[1]);
        let (thickness, at) = thinnest(&section(&triangles, height));
        if thickness < least.thickness {
            least = Wall { thickness, at: axis.point(height, at) };
        }
    }
    least
}

/// The edges of the section at a height.
fn section(triangles: &[[(f64, [f64; 2]); 3]], height: f64) -> Vec<Edge> {
    let mut edges = Vec::new();
    for corners in triangles {
        let crossings: Vec<[f64; 2]> = (0..3)
            .filter_map(|i| {
                let ((a, from), (b, to)) = (corners[i], corners[(i + 1) % 3]);
                let at = (height - a) / (b - a);
                ((a > height) != (b > height)).then_some([0, 1].map(|k| from[k] + at * (to[k] - from[k])))
            })
            .collect();
        let [from, to] = crossings[..] else { continue };
        // All that crosses a height stands upright: its normal has no part along the axis.
        let side = |i: usize| (corners[i].0 - corners[0].0, [0, 1].map(|k| corners[i].1[k] - corners[0].1[k]));
        let ((rise, u), (climb, v)) = (side(1), side(2));
        let normal = [u[1] * climb - rise * v[1], rise * v[0] - u[0] * climb];
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

#[cfg(test)]
mod tests {
    use super::super::layers::{Layer, stack};
    use super::super::outline::{disc, rectangle};
    use super::*;

    #[test]
    fn the_wall_beside_a_hole_is_found() {
        let layer = |heights, cut| Layer { heights, add: vec![rectangle([0.0, 0.02], [0.0, 0.01])], cut };
        let layers = [layer([0.0, 0.002], vec![]), layer([0.002, 0.005], vec![disc([0.010, 0.0032], 0.002)])];
        for axis in [Axis::X, Axis::Z] {
            let wall = thinnest_across(&stack(&layers, axis).unwrap(), axis);
            // The side of a polygon of 96 is 1 µm inside of its circle.
            assert!((wall.thickness - 0.0012).abs() < 3e-6, "{wall:?}");
            let (height, [a, _]) = axis.split(wall.at);
            assert!((height - 0.0035).abs() < 1e-9 && (a - 0.010).abs() < 5e-4, "{wall:?}");
        }
    }
}
