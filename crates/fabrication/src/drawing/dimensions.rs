//! What a drawing says in numbers: holes and levels.

use crate::parts::Part;
use crate::solid::{HOLE_SEGMENTS, Outline, SEGMENTS};

/// A round hole or edge of a part.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Round {
    /// In the plane of the layers, m.
    pub(super) middle: [f64; 2],
    /// m.
    pub(super) radius: f64,
    /// From and to along the axis, m.
    pub(super) span: [f64; 2],
}

/// Middle and radius of an outline that is a circle's polygon.
fn round(outline: &Outline) -> Option<([f64; 2], f64)> {
    if ![SEGMENTS, HOLE_SEGMENTS].contains(&outline.len()) {
        return None;
    }
    let corners = outline.len() as f64;
    let middle = [0, 1].map(|i| outline.iter().map(|corner| corner[i]).sum::<f64>() / corners);
    let away = |corner: &[f64; 2]| (corner[0] - middle[0]).hypot(corner[1] - middle[1]);
    let radius = away(&outline[0]);
    outline.iter().all(|corner| (away(corner) - radius).abs() < 1e-9).then_some((middle, radius))
}

/// The round holes of a part (`cut`) or its round outsides, one for each run of layers.
pub(super) fn rounds(part: &Part, cut: bool) -> Vec<Round> {
    let mut found: Vec<Round> = Vec::new();
    for layer in &part.layers {
        let outlines = if cut { &layer.cut } else { &layer.add };
        for (middle, radius) in outlines.iter().filter_map(round) {
            let [from, to] = layer.heights;
            let same = |it: &&mut Round| {
                let off = [it.middle[0] - middle[0], it.middle[1] - middle[1], it.radius - radius, it.span[1] - from];
                off.iter().all(|off| off.abs() < 1e-9)
            };
            match found.iter_mut().find(same) {
                Some(it) => it.span[1] = to,
                None => found.push(Round { middle, radius, span: [from, to] }),
            }
        }
    }
    found
}

/// The heights at which the section of a part changes, m.
pub(super) fn levels(part: &Part) -> Vec<f64> {
    let first = part.layers.first().map(|layer| layer.heights[0]);
    first.into_iter().chain(part.layers.iter().map(|layer| layer.heights[1])).collect()
}
