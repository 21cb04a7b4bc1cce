//! From layers to a mesh.
//!
//! The outlines of all layers are laid over each other and triangulated once, so that every triangle of the plane lies
//! inside or outside of each of them. Prisms over the triangles fill a layer; the faces between a filled prism and an empty
//! one are the surface. Neighbours share corners on every level, so that nothing gapes.

use std::collections::BTreeSet;

use spade::handles::FixedVertexHandle;
use spade::{ConstrainedDelaunayTriangulation, InsertionError, Point2, Triangulation};

use super::mesh::Mesh;
use super::outline::{Outline, contains};

/// Edges that are shorter become points, m.
const SHORTEST: f64 = 2e-6;

/// A layer between two heights along x, m: what is in an outline of `add`, and in none of `cut`.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::hand) struct Layer {
    pub(in crate::hand) heights: [f64; 2],
    pub(in crate::hand) add: Vec<Outline>,
    pub(in crate::hand) cut: Vec<Outline>,
}

/// The solid of layers that lie on each other, from low to high.
pub(in crate::hand) fn stack(layers: &[Layer]) -> Result<Mesh, InsertionError> {
    let mut outlines: Vec<&Outline> = Vec::new();
    for outline in layers.iter().flat_map(|layer| layer.add.iter().chain(&layer.cut)) {
        if !outlines.contains(&outline) {
            outlines.push(outline);
        }
    }
    let plane = triangulate(&outlines)?;
    // Which outlines a layer has, so that a point is held against each of them once.
    let place = |outline: &Outline| outlines.iter().position(|other| *other == outline);
    let places = |outlines: &[Outline]| outlines.iter().filter_map(place).collect::<Vec<usize>>();
    let made_of: Vec<_> = layers.iter().map(|layer| (places(&layer.add), places(&layer.cut))).collect();
    let filled: Vec<Vec<bool>> = plane
        .inner_faces()
        .map(|face| {
            let Point2 { x, y } = face.center();
            let inside: Vec<bool> = outlines.iter().map(|outline| contains(outline, [x, y])).collect();
            let any = |places: &[usize]| places.iter().any(|&place| inside[place]);
            made_of.iter().map(|(add, cut)| any(add) && !any(cut)).collect()
        })
        .collect();
    let levels = layers.first().map(|layer| layer.heights[0]).into_iter().chain(layers.iter().map(|l| l.heights[1]));
    let vertices: Vec<[f64; 3]> = levels
        .flat_map(|x| plane.vertices().map(move |vertex| [x, vertex.position().x, vertex.position().y]))
        .collect();
    Ok(Mesh::new(&vertices, &surface(&plane, &filled, layers.len())))
}

type Plane = ConstrainedDelaunayTriangulation<Point2<f64>>;

fn triangulate(outlines: &[&Outline]) -> Result<Plane, InsertionError> {
    let mut plane = Plane::new();
    for outline in outlines {
        let corners = outline
            .iter()
            .map(|&[y, z]| plane.insert(Point2::new(y, z)))
            .collect::<Result<Vec<FixedVertexHandle>, _>>()?;
        for (&from, &to) in corners.iter().zip(corners.iter().cycle().skip(1)) {
            plane.add_constraint_and_split(from, to, |crossing| crossing);
        }
    }
    Ok(plane)
}

/// The triangles between filled and empty, seen from outside counterclockwise. Corner `v` of the plane on level `l` is
/// vertex `l`·n + `v`.
fn surface(plane: &Plane, filled: &[Vec<bool>], layers: usize) -> Vec<[usize; 3]> {
    let corner_of = merged(plane);
    let at = |corner: usize, level: usize| level * plane.num_vertices() + corner;
    // The outer face is the first, and empty.
    let is_filled = |face: usize, layer: usize| face > 0 && filled[face - 1][layer];
    let mut triangles = Vec::new();
    let mut walls = BTreeSet::new();
    for face in plane.inner_faces() {
        let index = face.fix().index();
        let [a, b, c] = face.vertices().map(|vertex| corner_of[vertex.fix().index()]);
        for level in (0..=layers).filter(|_| a != b && b != c && c != a) {
            let below = level > 0 && is_filled(index, level - 1);
            let above = level < layers && is_filled(index, level);
            match (below, above) {
                (true, false) => triangles.push([at(a, level), at(b, level), at(c, level)]),
                (false, true) => triangles.push([at(a, level), at(c, level), at(b, level)]),
                _ => {}
            }
        }
        for edge in face.adjacent_edges() {
            let beyond = edge.rev().face().fix().index();
            let [from, to] = [edge.from(), edge.to()].map(|vertex| corner_of[vertex.fix().index()]);
            for layer in (0..layers).filter(|&layer| is_filled(index, layer) && !is_filled(beyond, layer)) {
                // Where a sliver was merged away, its two sides meet and leave nothing.
                if from != to && !walls.remove(&(layer, to, from)) {
                    walls.insert((layer, from, to));
                }
            }
        }
    }
    for (layer, from, to) in walls {
        let (low, high) = (layer, layer + 1);
        triangles.push([at(from, low), at(to, low), at(to, high)]);
        triangles.push([at(from, low), at(to, high), at(from, high)]);
    }
    triangles
}

/// For each vertex the one that stands for it: outlines that cross close to a corner leave edges too short for a file.
fn merged(plane: &Plane) -> Vec<usize> {
    let mut stands_for: Vec<usize> = (0..plane.num_vertices()).collect();
    for edge in plane.undirected_edges().filter(|edge| edge.length_2() < SHORTEST * SHORTEST) {
        let [a, b] = edge.vertices().map(|vertex| stands_for[vertex.fix().index()]);
        let (keep, drop) = (a.min(b), a.max(b));
        stands_for.iter_mut().filter(|vertex| **vertex == drop).for_each(|vertex| *vertex = keep);
    }
    stands_for
}

#[cfg(test)]
mod tests {
    use super::super::outline::{area, disc, rectangle};
    use super::*;

    #[test]
    fn a_plate_with_holes_and_a_boss() {
        let plate = rectangle([-0.02, 0.02], [-0.01, 0.01]);
        let (boss, bore) = (disc([0.005, 0.0], 0.006), disc([0.005, 0.0], 0.002));
        // Half of it is outside of the plate.
        let notch = disc([-0.02, 0.0], 0.003);
        let layers = [
            Layer { heights: [0.0, 0.003], add: vec![plate.clone()], cut: vec![bore.clone(), notch.clone()] },
            Layer { heights: [0.003, 0.010], add: vec![boss.clone()], cut: vec![bore.clone()] },
        ];
        let mesh = stack(&layers).unwrap();
        mesh.check().unwrap();
        let wanted = 0.003 * (area(&plate) - area(&bore) - 0.5 * area(&notch)) + 0.007 * (area(&boss) - area(&bore));
        assert!((mesh.volume() - wanted).abs() < 1e-12 * wanted, "{} of {wanted}", mesh.volume());
        let bounds = mesh.bounds();
        for (bound, wanted) in bounds.concat().iter().zip([0.0, -0.02, -0.01, 0.010, 0.02, 0.01]) {
            assert!((bound - wanted).abs() < 1e-12, "{bounds:?}");
        }
    }

    #[test]
    fn nothing_is_no_solid() {
        assert!(stack(&[]).unwrap().check().is_err());
        assert!(stack(&[Layer { heights: [0.0, 1.0], add: vec![vec![[f64::NAN; 2]; 3]], cut: vec![] }]).is_err());
    }
}
