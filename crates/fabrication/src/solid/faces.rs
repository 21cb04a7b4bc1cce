//! The flat faces of a mesh: triangles that lie in one plane, put together.

use std::collections::HashMap;

use super::mesh::Mesh;

/// How much normals of one plane may differ.
const PARALLEL: f64 = 1e-7;

/// A flat face: loops of vertices, counterclockwise around material as seen from outside, clockwise around holes.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Face {
    /// Out of the material, of length 1.
    pub(crate) normal: [f64; 3],
    /// Indices of vertices.
    pub(crate) loops: Vec<Vec<usize>>,
}

/// The faces of a closed mesh, and the vertices that they speak of, m.
pub(crate) fn faces(mesh: &Mesh) -> (Vec<Face>, &[[f64; 3]]) {
    let (vertices, triangles) = mesh.indexed();
    let normals: Vec<[f64; 3]> =
        triangles.iter().map(|corners| unit_normal(corners.map(|corner| vertices[corner]))).collect();
    let mut owner: HashMap<[usize; 2], usize> = HashMap::new();
    for (index, &[a, b, c]) in triangles.iter().enumerate() {
        owner.extend([[a, b], [b, c], [c, a]].map(|edge| (edge, index)));
    }
    let mut group: Vec<usize> = (0..triangles.len()).collect();
    for (&[from, to], &index) in &owner {
        let Some(&other) = owner.get(&[to, from]) else { continue };
        let along: f64 = (0..3).map(|i| normals[index][i] * normals[other][i]).sum();
        if along > 1.0 - PARALLEL {
            let (a, b) = (root(&mut group, index), root(&mut group, other));
            group[a.max(b)] = a.min(b);
        }
    }
    let mut sides: HashMap<usize, Vec<[usize; 2]>> = HashMap::new();
    for (index, &[a, b, c]) in triangles.iter().enumerate() {
        let own = root(&mut group, index);
        for [from, to] in [[a, b], [b, c], [c, a]] {
            let beyond = owner.get(&[to, from]).map(|&other| root(&mut group, other));
            if beyond != Some(own) {
                sides.entry(own).or_default().push([from, to]);
            }
        }
    }
    let mut faces: Vec<(usize, Face)> = sides
        .into_iter()
        .map(|(own, sides)| {
            let normal = normals[own];
            (own, Face { normal, loops: loops(sides, vertices, normal) })
        })
        .collect();
    // The order of a table of hashes is nobody's.
    faces.sort_by_key(|(own, _)| *own);
    (faces.into_iter().map(|(_, face)| face).collect(), vertices)
}

fn root(group: &mut [usize], mut index: usize) -> usize {
    while group[index] != index {
        group[index] = group[group[index]];
        index = group[index];
    }
    index
}

/// Sides put together to loops. Where several go on from a vertex, the one that turns right most: loops that touch stay apart.
fn loops(mut sides: Vec<[usize; 2]>, vertices: &[[f64; 3]], normal: [f64; 3]) -> Vec<Vec<usize>> {
    sides.sort_unstable();
    let mut next: HashMap<usize, Vec<usize>> = HashMap::new();
    for &[from, to] in &sides {
        next.entry(from).or_default().push(to);
    }
    let mut loops = Vec::new();
    for &[start, _] in &sides {
        let Some(mut to) = next.get_mut(&start).and_then(Vec::pop) else { continue };
        let mut chain = vec![start];
        while to != start {
            let from = chain[chain.len() - 1];
            chain.push(to);
            let Some(choices) = next.get_mut(&to).filter(|choices| !choices.is_empty()) else { break };
            let turn = |&beyond: &usize| turning(vertices[from], vertices[to], vertices[beyond], normal);
            let best = (0..choices.len()).min_by(|&a, &b| turn(&choices[a]).total_cmp(&turn(&choices[b])));
            to = choices.swap_remove(best.unwrap_or(0));
        }
        loops.push(chain);
    }
    loops
}

/// The angle by which a way turns left at `at`, seen against the normal, rad.
fn turning(from: [f64; 3], at: [f64; 3], to: [f64; 3], normal: [f64; 3]) -> f64 {
    let [before, after] = [minus(at, from), minus(to, at)];
    let across = cross(before, after);
    let sin: f64 = (0..3).map(|i| across[i] * normal[i]).sum();
    let cos: f64 = (0..3).map(|i| before[i] * after[i]).sum();
    sin.atan2(cos)
}

fn unit_normal([a, b, c]: [[f64; 3]; 3]) -> [f64; 3] {
    let across = cross(minus(b, a), minus(c, a));
    let length = across.iter().map(|part| part * part).sum::<f64>().sqrt();
    across.map(|part| part / length)
}

fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|i| a[i] - b[i])
}

fn cross([ax, ay, az]: [f64; 3], [bx, by, bz]: [f64; 3]) -> [f64; 3] {
    [ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx]
}

#[cfg(test)]
mod tests {
    use super::super::layers::{Axis, Layer, stack};
    use super::super::outline::{disc, rectangle};
    use super::*;

    /// A plate with a hole has two faces with a hole each, four sides, and one face for each side of the hole's polygon.
    #[test]
    fn a_plate_with_a_hole() {
        let bore = disc([0.005, 0.005], 0.002);
        let layer = Layer { heights: [0.0, 0.002], add: vec![rectangle([0.0, 0.01], [0.0, 0.01])], cut: vec![bore] };
        let mesh = stack(&[layer], Axis::Z).unwrap();
        let (faces, vertices) = faces(&mesh);
        assert_eq!(faces.len(), 2 + 4 + 96);
        let flat: Vec<&Face> = faces.iter().filter(|face| face.normal[2].abs() > 0.5).collect();
        assert_eq!(flat.len(), 2);
        for face in flat {
            let mut sizes: Vec<usize> = face.loops.iter().map(Vec::len).collect();
            sizes.sort_unstable();
            assert_eq!(sizes, [4, 96]);
        }
        // Every side of a loop is that of another face, the other way round.
        let mut uses: HashMap<[usize; 2], usize> = HashMap::new();
        for chain in faces.iter().flat_map(|face| &face.loops) {
            for i in 0..chain.len() {
                *uses.entry([chain[i], chain[(i + 1) % chain.len()]]).or_default() += 1;
            }
        }
        assert!(uses.iter().all(|(&[a, b], &count)| count == 1 && uses.get(&[b, a]) == Some(&1)));
        assert_eq!(vertices.len(), 2 * (4 + 96));
    }
}
