//! Closed surfaces of triangles.

use std::collections::HashMap;

use thiserror::Error;

/// The least height of a triangle, m: what numbers of an STL file resolve at 100 mm.
const LEAST_HEIGHT: f64 = 1e-8;

/// Why a mesh bounds no solid.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum MeshError {
    /// It has no triangles.
    #[error("the mesh has no triangles")]
    Empty,
    /// Edges that are not shared by exactly two triangles that agree about the outside.
    #[error("{edges} edges of the mesh are not shared by two triangles in opposite directions")]
    Open {
        /// How many.
        edges: usize,
    },
    /// Triangles that are but lines.
    #[error("triangle {triangle} is {height:e} m high")]
    Degenerate {
        /// Which.
        triangle: usize,
        /// Its least height, m.
        height: f64,
    },
    /// Inside out.
    #[error("the mesh encloses {volume:e} m³")]
    InsideOut {
        /// What it encloses, m³.
        volume: f64,
    },
}

/// A surface of triangles whose corners are counterclockwise as seen from outside. Lengths in m.
#[derive(Clone, Debug, PartialEq)]
pub struct Mesh {
    vertices: Vec<[f64; 3]>,
    triangles: Vec<[usize; 3]>,
}

impl Mesh {
    /// Of triangles by the indices of their corners; vertices that none of them has are dropped.
    pub(super) fn new(vertices: &[[f64; 3]], triangles: &[[usize; 3]]) -> Self {
        let mut place = vec![None; vertices.len()];
        let mut used = Vec::new();
        let triangles = triangles.iter().map(|corners| {
            corners.map(|corner| {
                *place[corner].get_or_insert_with(|| {
                    used.push(vertices[corner]);
                    used.len() - 1
                })
            })
        });
        let triangles = triangles.collect();
        Self { vertices: used, triangles }
    }

    /// The corners of every triangle, m.
    pub fn triangles(&self) -> impl ExactSizeIterator<Item = [[f64; 3]; 3]> + '_ {
        self.triangles.iter().map(|corners| corners.map(|corner| self.vertices[corner]))
    }

    /// Vertices, m, and the indices of the corners of every triangle.
    pub(super) fn indexed(&self) -> (&[[f64; 3]], &[[usize; 3]]) {
        (&self.vertices, &self.triangles)
    }

    /// The enclosed volume, m³: the tetrahedra from the origin to every triangle.
    pub fn volume(&self) -> f64 {
        self.triangles().map(|[a, b, c]| dot(a, cross(b, c)) / 6.0).sum()
    }

    /// The middle of what is enclosed, m.
    pub fn centre(&self) -> [f64; 3] {
        let mut sum = [0.0; 3];
        for [a, b, c] in self.triangles() {
            let volume = dot(a, cross(b, c)) / 6.0;
            sum = [0, 1, 2].map(|i| sum[i] + volume * (a[i] + b[i] + c[i]) / 4.0);
        }
        let whole = self.volume();
        sum.map(|sum| sum / whole)
    }

    /// The least and the greatest coordinates, m.
    pub fn bounds(&self) -> [[f64; 3]; 2] {
        let along = |pick: fn(f64, f64) -> f64, start| {
            self.vertices.iter().fold([start; 3], |so_far, vertex| [0, 1, 2].map(|i| pick(so_far[i], vertex[i])))
        };
        [along(f64::min, f64::INFINITY), along(f64::max, f64::NEG_INFINITY)]
    }

    /// Whether the surface, as [`stl`](Self::stl) rounds it, is that of a solid: every edge in exactly two triangles, once in each
    /// direction; no triangle that is but a line; a positive volume.
    pub fn check(&self) -> Result<(), MeshError> {
        if self.triangles.is_empty() {
            return Err(MeshError::Empty);
        }
        let mut uses: HashMap<[[u32; 3]; 2], i32> = HashMap::new();
        for (triangle, corners) in self.triangles().enumerate() {
            let [a, b, c] = corners;
            let longest = [minus(a, b), minus(b, c), minus(c, a)].map(norm).into_iter().fold(0.0, f64::max);
            let height = norm(normal(corners)) / longest;
            if height.is_nan() || height < LEAST_HEIGHT {
                return Err(MeshError::Degenerate { triangle, height });
            }
            let [a, b, c] = corners.map(|corner| millimetres(corner).map(f32::to_bits));
            for edge in [[a, b], [b, c], [c, a]] {
                *uses.entry(edge).or_default() += 1;
            }
        }
        let edges = uses.iter().filter(|&(&[a, b], &n)| n != 1 || uses.get(&[b, a]) != Some(&1)).count();
        if edges > 0 {
            return Err(MeshError::Open { edges });
        }
        let volume = self.volume();
        if volume > 0.0 { Ok(()) } else { Err(MeshError::InsideOut { volume }) }
    }

    /// The mesh as a binary STL file in millimetres. `name` goes into its header of 80 bytes; readers take one that
    /// begins with `solid` for text.
    pub fn stl(&self, name: &str) -> Vec<u8> {
        let mut bytes = vec![b' '; 80];
        for (place, letter) in bytes.iter_mut().zip(format!("{name}, millimetres").bytes()) {
            *place = letter;
        }
        bytes.extend((self.triangles.len() as u32).to_le_bytes());
        for corners in self.triangles() {
            let direction = normal(corners);
            let length = norm(direction);
            let facing = direction.map(|component| (component / length) as f32);
            for number in [facing, millimetres(corners[0]), millimetres(corners[1]), millimetres(corners[2])].concat() {
                bytes.extend(number.to_le_bytes());
            }
            bytes.extend([0, 0]);
        }
        bytes
    }
}

/// As the file has it; with one zero only.
fn millimetres(point: [f64; 3]) -> [f32; 3] {
    point.map(|metres| (1e3 * metres) as f32 + 0.0)
}

/// Across a triangle, outward, of twice its area.
fn normal([a, b, c]: [[f64; 3]; 3]) -> [f64; 3] {
    cross(minus(b, a), minus(c, a))
}

fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|i| a[i] - b[i])
}

fn cross([ax, ay, az]: [f64; 3], [bx, by, bz]: [f64; 3]) -> [f64; 3] {
    [ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx]
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn norm(a: [f64; 3]) -> f64 {
    dot(a, a).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tetrahedron() -> (Vec<[f64; 3]>, Vec<[usize; 3]>) {
        let corners = vec![[0.0; 3], [0.006, 0.0, 0.0], [0.0, 0.006, 0.0], [0.0, 0.0, 0.006], [9.0; 3]];
        (corners, vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])
    }

    #[test]
    fn a_tetrahedron_is_sound() {
        let (corners, triangles) = tetrahedron();
        let mesh = Mesh::new(&corners, &triangles);
        mesh.check().unwrap();
        assert!((mesh.volume() - 36e-9).abs() < 1e-20);
        assert_eq!(mesh.bounds(), [[0.0; 3], [0.006; 3]]);
        assert!(mesh.centre().iter().all(|middle| (middle - 0.0015).abs() < 1e-12));
    }

    #[test]
    fn holes_turned_triangles_and_slivers_are_found() {
        let (corners, triangles) = tetrahedron();
        let check = |corners: &[[f64; 3]], triangles: &[[usize; 3]]| Mesh::new(corners, triangles).check();
        assert_eq!(check(&corners, &triangles[..3]), Err(MeshError::Open { edges: 3 }));
        let mut turned = triangles.clone();
        turned[0].swap(1, 2);
        assert!(matches!(check(&corners, &turned), Err(MeshError::Open { .. })));
        let inside_out: Vec<_> = triangles.iter().map(|&[a, b, c]| [a, c, b]).collect();
        assert!(matches!(check(&corners, &inside_out), Err(MeshError::InsideOut { volume }) if volume < 0.0));
        let mut flat = corners.clone();
        flat[3] = [0.003, 0.0, 0.0];
        assert!(matches!(check(&flat, &triangles), Err(MeshError::Degenerate { triangle: 1, .. })));
        // Twice the same solid: every edge is in four triangles.
        assert_eq!(check(&corners, &[triangles.clone(), triangles].concat()), Err(MeshError::Open { edges: 12 }));
        assert_eq!(check(&corners, &[]), Err(MeshError::Empty));
    }

    #[test]
    fn stl_files_are_in_millimetres() {
        let (corners, triangles) = tetrahedron();
        let bytes = Mesh::new(&corners, &triangles).stl("tetrahedron");
        assert_eq!(bytes.len(), 84 + 4 * 50);
        assert!(bytes.starts_with(b"tetrahedron, millimetres "));
        assert_eq!(bytes[80..84], 4u32.to_le_bytes());
        let number = |at: usize| f32::from_le_bytes(bytes[at..at + 4].try_into().unwrap());
        // The second triangle lies in the plane y = 0 and faces away from y.
        let second: Vec<f32> = (0..12).map(|i| number(84 + 50 + 4 * i)).collect();
        assert_eq!(second, [0.0, -1.0, 0.0, 0.0, 0.0, 0.0, 6.0, 0.0, 0.0, 0.0, 0.0, 6.0]);
    }
}
