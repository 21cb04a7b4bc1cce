//! Surfaces of triangles.

use std::f64::consts::PI;

/// Directions in which the farthest points of a mesh are its corners.
const DIRECTIONS: usize = 64;

/// A surface of triangles in the frame of its solid.
#[derive(Clone, Debug, PartialEq)]
pub struct Mesh {
    points: Vec<[f64; 3]>,
    faces: Vec<[u32; 3]>,
    corners: Vec<[f64; 3]>,
}

impl Mesh {
    /// Points, m, and the three points of each triangle, counter-clockwise from outside.
    ///
    /// # Panics
    /// If a triangle names a point that is missing.
    pub fn new(points: Vec<[f64; 3]>, faces: Vec<[u32; 3]>) -> Self {
        let named = faces.iter().flatten().max();
        assert!(named.is_none_or(|&last| (last as usize) < points.len()), "every point of a triangle is there");
        let corners = corners(&points);
        Self { points, faces, corners }
    }

    /// Its points, m.
    pub fn points(&self) -> &[[f64; 3]] {
        &self.points
    }

    /// The points of each triangle.
    pub fn faces(&self) -> &[[u32; 3]] {
        &self.faces
    }

    /// A few points that lie farthest out, m: their convex hull is nearly that of all.
    pub fn corners(&self) -> &[[f64; 3]] {
        &self.corners
    }
}

/// The points that are farthest out in directions spread evenly over a sphere.
fn corners(points: &[[f64; 3]]) -> Vec<[f64; 3]> {
    let golden = PI * (3.0 - 5.0_f64.sqrt());
    let mut kept: Vec<usize> = Vec::new();
    for k in 0..DIRECTIONS {
        let z = 1.0 - (2 * k + 1) as f64 / DIRECTIONS as f64;
        let (sin, cos) = (golden * k as f64).sin_cos();
        let [x, y] = [cos * (1.0 - z * z).sqrt(), sin * (1.0 - z * z).sqrt()];
        let out = |i: &usize| x * points[*i][0] + y * points[*i][1] + z * points[*i][2];
        kept.extend((0..points.len()).max_by(|a, b| out(a).total_cmp(&out(b))));
    }
    kept.sort_unstable();
    kept.dedup();
    kept.into_iter().map(|i| points[i]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn corners_lie_outside() {
        let points = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.1; 3]];
        let mesh = Mesh::new(points.clone(), vec![[0, 2, 1]]);
        assert_eq!(mesh.corners(), &points[..4]);
    }

    #[test]
    #[should_panic(expected = "every point of a triangle is there")]
    fn triangles_have_points() {
        Mesh::new(vec![[0.0; 3]], vec![[0, 0, 1]]);
    }
}
