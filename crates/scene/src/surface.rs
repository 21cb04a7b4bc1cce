//! Surfaces as a page holds them: few triangles, in short numbers.

use std::collections::BTreeMap;

use hwasp_core::Form;
use serde::Serialize;

use crate::numbers::{counts, reals};

/// The most triangles of a surface; a larger one is made coarser.
const MOST_FACES: usize = 1500;
/// Cells along the longest side with which that begins, and by how much they become fewer.
const CELLS: f64 = 48.0;
const FEWER: f64 = 0.85;

/// Triangles as text.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct Surface {
    /// Three numbers a point, m.
    points: String,
    /// Three points a triangle.
    faces: String,
}

/// Surfaces by what they were made of: each is there once.
#[derive(Debug, Default)]
pub(crate) struct Surfaces(Vec<(Form, Surface)>);

impl Surfaces {
    /// The number of a form's surface; none of forms that need none.
    pub(crate) fn number(&mut self, form: &Form) -> Option<usize> {
        if let Some(known) = self.0.iter().position(|(of, _)| of == form) {
            return Some(known);
        }
        let (points, faces) = match form {
            Form::Mesh(mesh) => (mesh.points().to_vec(), mesh.faces().to_vec()),
            Form::Field(rows) => (rows.iter().flatten().copied().collect(), field(rows)),
            _ => return None,
        };
        let (points, faces) = coarser(&points, &faces);
        let points = reals(points.into_iter().flatten().map(|part| part as f32));
        self.0.push((form.clone(), Surface { points, faces: counts(faces.into_iter().flatten()) }));
        Some(self.0.len() - 1)
    }

    /// All of them, in the order of their numbers.
    pub(crate) fn all(self) -> Vec<Surface> {
        self.0.into_iter().map(|(_, surface)| surface).collect()
    }
}

/// The triangles of points in rows.
fn field(rows: &[Vec<[f64; 3]>]) -> Vec<[u32; 3]> {
    let mut faces = Vec::new();
    let mut first = 0;
    for pair in rows.windows(2) {
        let next = first + pair[0].len() as u32;
        for i in 1..pair[0].len().min(pair[1].len()) as u32 {
            let [a, b, c, d] = [first + i - 1, first + i, next + i - 1, next + i];
            faces.extend([[a, b, d], [a, d, c]]);
        }
        first = next;
    }
    faces
}

/// At most [`MOST_FACES`] triangles: points that share a cell of a grid become one. A surface with fewer stays as it is, but for
/// points that no triangle has.
fn coarser(points: &[[f64; 3]], faces: &[[u32; 3]]) -> (Vec<[f64; 3]>, Vec<[u16; 3]>) {
    let used = || faces.iter().flatten().map(|&point| points[point as usize]);
    let edge = |k: usize, end: fn(f64, f64) -> f64| used().map(|point| point[k]).reduce(end).unwrap_or_default();
    let longest = (0..3).map(|k| edge(k, f64::max) - edge(k, f64::min)).fold(0.0, f64::max);
    let mut cells = if faces.len() > MOST_FACES { CELLS } else { f64::INFINITY };
    loop {
        let side = longest / cells;
        let cell = |point: [f64; 3]| {
            // Points in the same place are one in any case.
            if side > 0.0 { point.map(|at| (at / side).round() as i64) } else { point.map(|at| at.to_bits() as i64) }
        };
        let mut numbers = BTreeMap::new();
        let mut sums: Vec<([f64; 3], f64)> = Vec::new();
        let mut number = |&point: &u32| {
            let point = points[point as usize];
            let next = numbers.len();
            let number = *numbers.entry(cell(point)).or_insert(next);
            if number == sums.len() {
                sums.push(([0.0; 3], 0.0));
            }
            let (sum, count) = &mut sums[number];
            (0..3).for_each(|k| sum[k] += point[k]);
            *count += 1.0;
            number
        };
        let mut kept: Vec<[usize; 3]> = Vec::new();
        for [a, b, c] in faces {
            let face = [number(a), number(b), number(c)];
            if face[0] != face[1] && face[1] != face[2] && face[2] != face[0] {
                kept.push(face);
            }
        }
        if kept.len() <= MOST_FACES {
            let points = sums.into_iter().map(|(sum, count)| sum.map(|part| part / count)).collect();
            // Fewer than three times as many points as triangles.
            return (points, kept.into_iter().map(|face| face.map(|point| point as u16)).collect());
        }
        cells *= FEWER;
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use hwasp_core::Mesh;

    use super::*;

    /// A ball of rings.
    fn ball(rings: u32) -> (Vec<[f64; 3]>, Vec<[u32; 3]>) {
        let points = (0..=rings).flat_map(|i| {
            let (sin, cos) = (std::f64::consts::PI * f64::from(i) / f64::from(rings)).sin_cos();
            (0..2 * rings).map(move |j| {
                let (y, x) = (std::f64::consts::PI * f64::from(j) / f64::from(rings)).sin_cos();
                [sin * x, sin * y, cos]
            })
        });
        let across = 2 * rings;
        let faces = (0..rings).flat_map(|i| {
            (0..across).flat_map(move |j| {
                let [a, b] = [i * across + j, i * across + (j + 1) % across];
                [[a, a + across, b], [b, a + across, b + across]]
            })
        });
        (points.collect(), faces.collect())
    }

    #[test]
    fn large_surfaces_become_coarse_and_keep_their_place() {
        let (points, faces) = ball(60);
        assert_eq!(faces.len(), 14_400);
        let (coarse, kept) = coarser(&points, &faces);
        assert!((700..=MOST_FACES).contains(&kept.len()), "{}", kept.len());
        let off = |point: &[f64; 3]| (point.iter().map(|part| part * part).sum::<f64>().sqrt() - 1.0).abs();
        assert!(coarse.iter().all(|point| off(point) < 0.03));
        // A tetrahedron stays, without the point that belongs to nothing.
        let points = [[0.0; 3], [9.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let (same, faces) = coarser(&points, &[[0, 3, 2], [0, 2, 4], [0, 4, 3], [2, 3, 4]]);
        assert_eq!(same, [points[0], points[3], points[2], points[4]]);
        assert_eq!(faces, [[0, 1, 2], [0, 2, 3], [0, 3, 1], [2, 1, 3]]);
    }

    #[test]
    fn equal_surfaces_are_one() {
        let (points, faces) = ball(4);
        let form = || Form::Mesh(Arc::new(Mesh::new(points.clone(), faces.clone())));
        let hill = Form::Field(vec![vec![[0.0; 3], [1.0, 0.0, 0.0]], vec![[0.0, 1.0, 0.0], [1.0, 1.0, 0.5]]].into());
        let mut surfaces = Surfaces::default();
        let numbers = [form(), hill.clone(), form(), hill, Form::Box([1.0; 3])].map(|form| surfaces.number(&form));
        assert_eq!(numbers, [Some(0), Some(1), Some(0), Some(1), None]);
        assert_eq!(surfaces.all()[1].faces, counts([0, 1, 2, 0, 2, 3]));
    }
}
