//! From layers to a mesh.
//!
//! The outlines of all layers are laid over each other and triangulated once, so that every triangle of the plane lies
//! inside or outside of each of them. Prisms over the triangles fill a layer; the faces between a filled prism and an empty
//! one are the surface. Neighbours share corners on every level, so that nothing gapes.

use std::collections::{BTreeSet, HashMap};

use spade::handles::FixedVertexHandle;
use spade::{ConstrainedDelaunayTriangulation, InsertionError, Point2, Triangulation};

use super::mesh::Mesh;
use super::outline::{Outline, contains, turned};

/// Edges that are shorter become points, m.
const SHORTEST: f64 = 2e-6;
/// Triangles that are lower become lines, m: well above what a file resolves.
const LOWEST: f64 = 5e-8;

/// The axis of its frame along which a solid is stacked. It is upright in the printer, so that no layer hangs over another one by more
/// than a bridge.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Axis {
    /// Outlines lie in y and z.
    X,
    /// Outlines lie in x and y.
    Z,
}

impl Axis {
    /// The point at a height over a point of the plane.
    pub(crate) fn point(self, height: f64, [a, b]: [f64; 2]) -> [f64; 3] {
        match self {
            Self::X => [height, a, b],
            Self::Z => [a, b, height],
        }
    }

    /// The height of a point, and where it is in the plane.
    pub(crate) fn split(self, [x, y, z]: [f64; 3]) -> (f64, [f64; 2]) {
        match self {
            Self::X => (x, [y, z]),
            Self::Z => (z, [x, y]),
        }
    }

    /// The name of the axis and of those of the plane.
    pub fn names(self) -> [&'static str; 3] {
        match self {
            Self::X => ["x", "y", "z"],
            Self::Z => ["z", "x", "y"],
        }
    }
}

/// A layer between two heights along the axis of its stack, m: what is in an outline of `add`, and in none of `cut`.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Layer {
    pub(crate) heights: [f64; 2],
    pub(crate) add: Vec<Outline>,
    pub(crate) cut: Vec<Outline>,
}

impl Layer {
    /// The same with its round outlines turned about their middles by an angle, rad.
    pub(crate) fn turned(&self, angle: f64) -> Self {
        let all = |outlines: &[Outline]| outlines.iter().map(|outline| turned(outline, angle)).collect();
        Self { heights: self.heights, add: all(&self.add), cut: all(&self.cut) }
    }
}

/// The solid of layers that lie on each other, from low to high.
pub(crate) fn stack(layers: &[Layer], axis: Axis) -> Result<Mesh, InsertionError> {
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
        .flat_map(|x| plane.vertices().map(move |vertex| axis.point(x, [vertex.position().x, vertex.position().y])))
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
    let faces = faces(plane);
    let at = |corner: usize, level: usize| level * plane.num_vertices() + corner;
    let owner: HashMap<[usize; 2], usize> =
        faces.iter().flat_map(|face| edges(face.corners).map(|edge| (edge, face.index))).collect();
    let mut triangles = Vec::new();
    let mut walls = BTreeSet::new();
    for &Face { corners: [a, b, c], index } in &faces {
        for level in 0..=layers {
            let below = level > 0 && filled[index][level - 1];
            let above = level < layers && filled[index][level];
            match (below, above) {
                (true, false) => triangles.push([at(a, level), at(b, level), at(c, level)]),
                (false, true) => triangles.push([at(a, level), at(c, level), at(b, level)]),
                _ => {}
            }
        }
        for [from, to] in edges([a, b, c]) {
            let beyond = owner.get(&[to, from]);
            let open = |&layer: &usize| filled[index][layer] && beyond.is_none_or(|&other| !filled[other][layer]);
            walls.extend((0..layers).filter(open).map(|layer| (layer, from, to)));
        }
    }
    for (layer, from, to) in walls {
        let (low, high) = (layer, layer + 1);
        triangles.push([at(from, low), at(to, low), at(to, high)]);
        triangles.push([at(from, low), at(to, high), at(from, high)]);
    }
    triangles
}

/// A triangle of the plane.
#[derive(Clone, Copy)]
struct Face {
    corners: [usize; 3],
    /// The face of the triangulation that it is, or was a part of.
    index: usize,
}

fn edges([a, b, c]: [usize; 3]) -> [[usize; 2]; 3] {
    [[a, b], [b, c], [c, a]]
}

/// The triangles of the plane that are more than points and lines. Where a corner lies almost on an edge, the triangle between
/// them is left out, and the one beyond the edge is divided at the corner.
fn faces(plane: &Plane) -> Vec<Face> {
    let corner_of = merged(plane);
    let position: Vec<Point2<f64>> = plane.vertices().map(|vertex| vertex.position()).collect();
    let mut faces: Vec<Face> = plane
        .inner_faces()
        .enumerate()
        .map(|(index, face)| Face { corners: face.vertices().map(|vertex| corner_of[vertex.fix().index()]), index })
        .filter(|Face { corners: [a, b, c], .. }| a != b && b != c && c != a)
        .collect();
    // Each turn leaves out one triangle and adds one, of which the next turn is no worse in the end.
    for _ in 0..faces.len() {
        let Some((sliver, apex)) = faces.iter().enumerate().find_map(|(i, face)| Some((i, apex(&position, face)?)))
        else {
            break;
        };
        let Face { corners, .. } = faces.swap_remove(sliver);
        let [v, p, q] = [0, 1, 2].map(|k| corners[(apex + k) % 3]);
        let beyond = faces.iter().position(|face| edges(face.corners).contains(&[q, p]));
        if let Some(beyond) = beyond {
            let Face { corners, index } = faces[beyond];
            let w = corners.into_iter().find(|&corner| corner != p && corner != q).unwrap_or(v);
            faces[beyond].corners = [q, v, w];
            faces.push(Face { corners: [v, p, w], index });
        }
    }
    faces
}

/// Which corner of a triangle lies almost on the edge opposite to it, its longest.
fn apex(position: &[Point2<f64>], face: &Face) -> Option<usize> {
    let at = face.corners.map(|corner| position[corner]);
    let length = |k: usize| {
        let [from, to] = [at[(k + 1) % 3], at[(k + 2) % 3]];
        (to.x - from.x).hypot(to.y - from.y)
    };
    let longest = (0..3).max_by(|&i, &k| length(i).total_cmp(&length(k)))?;
    let [a, b, c] = at;
    let twice_area = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
    (twice_area.abs() < LOWEST * length(longest)).then_some(longest)
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
    use super::super::outline::{area, disc, polygon, rectangle};
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
        let mesh = stack(&layers, Axis::X).unwrap();
        mesh.check().unwrap();
        let wanted = 0.003 * (area(&plate) - area(&bore) - 0.5 * area(&notch)) + 0.007 * (area(&boss) - area(&bore));
        assert!((mesh.volume() - wanted).abs() < 1e-12 * wanted, "{} of {wanted}", mesh.volume());
        let bounds = mesh.bounds();
        for (bound, wanted) in bounds.concat().iter().zip([0.0, -0.02, -0.01, 0.010, 0.02, 0.01]) {
            assert!((bound - wanted).abs() < 1e-12, "{bounds:?}");
        }
    }

    /// Outlines that almost touch left triangles too low for a file, and the hand of some designs could not be printed.
    #[test]
    fn a_corner_almost_on_an_edge() {
        let plate = rectangle([-0.02, 0.02], [-0.01, 0.01]);
        for off in [1e-9, 9e-9, 3e-8, -9e-9] {
            // Its tip is so far from the upper side.
            let tip = polygon(&[[-0.004, 0.0], [0.004, 0.0], [0.0003, 0.01 - off]]);
            let layers = [
                Layer { heights: [0.0, 0.003], add: vec![plate.clone(), tip.clone()], cut: vec![] },
                Layer { heights: [0.003, 0.005], add: vec![tip.clone()], cut: vec![] },
            ];
            let mesh = stack(&layers, Axis::X).unwrap();
            mesh.check().unwrap_or_else(|error| panic!("{off}: {error}"));
            let wanted = 0.003 * area(&plate) + 0.002 * area(&tip);
            assert!((mesh.volume() / wanted - 1.0).abs() < 1e-5, "{off}: {} of {wanted}", mesh.volume());
        }
    }

    #[test]
    fn nothing_is_no_solid() {
        assert!(stack(&[], Axis::X).unwrap().check().is_err());
        assert!(
            stack(&[Layer { heights: [0.0, 1.0], add: vec![vec![[f64::NAN; 2]; 3]], cut: vec![] }], Axis::Z).is_err()
        );
    }
}
