//! Pictures of parts in their places, in a parallel projection, what is nearer drawn later.

use std::fmt::Write;

use crate::parts::Part;
use crate::solid::faces;

/// A part in its place.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Placed<'a> {
    /// The part.
    pub(crate) part: &'a Part,
    /// Turned about x by this angle, rad.
    pub(crate) angle: f64,
    /// Moved by this then, m.
    pub(crate) at: [f64; 3],
}

impl Placed<'_> {
    fn point(&self, [x, y, z]: [f64; 3]) -> [f64; 3] {
        let (sin, cos) = self.angle.sin_cos();
        [x + self.at[0], cos * y - sin * z + self.at[1], sin * y + cos * z + self.at[2]]
    }

    fn direction(&self, [x, y, z]: [f64; 3]) -> [f64; 3] {
        let (sin, cos) = self.angle.sin_cos();
        [x, cos * y - sin * z, sin * y + cos * z]
    }
}

/// From where it is seen: to the right, up and towards the eye.
const VIEW: [[f64; 3]; 3] = [[0.819, -0.574, 0.0], [0.246, 0.351, 0.904], [-0.518, -0.740, 0.428]];
/// Where light comes from.
const LIGHT: [f64; 3] = [-0.30, -0.55, 0.78];
/// Colours of parts, by their order: red, green and blue.
const COLOURS: [[f64; 3]; 6] = [
    [0.62, 0.66, 0.72],
    [0.88, 0.48, 0.36],
    [0.40, 0.62, 0.86],
    [0.93, 0.75, 0.35],
    [0.50, 0.75, 0.52],
    [0.72, 0.58, 0.80],
];
/// Pixels per m.
const SCALE: f64 = 6000.0;
const MARGIN: f64 = 20.0;

/// A picture of parts, each named beside it.
pub(crate) fn picture(placed: &[Placed<'_>], title: &str) -> String {
    let dot = |a: [f64; 3], b: [f64; 3]| (0..3).map(|i| a[i] * b[i]).sum::<f64>();
    let screen = |point: [f64; 3]| [SCALE * dot(point, VIEW[0]), -SCALE * dot(point, VIEW[1])];
    let mut shapes: Vec<(f64, String)> = Vec::new();
    let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
    let mut names = Vec::new();
    for (order, it) in placed.iter().enumerate() {
        let (all, vertices) = faces(&it.part.mesh);
        let seen: Vec<[f64; 2]> = vertices.iter().map(|&vertex| screen(it.point(vertex))).collect();
        for point in &seen {
            low = [0, 1].map(|i| f64::min(low[i], point[i]));
            high = [0, 1].map(|i| f64::max(high[i], point[i]));
        }
        let right = seen.iter().map(|point| point[0]).fold(f64::NEG_INFINITY, f64::max);
        let middle = seen.iter().map(|point| point[1]).sum::<f64>() / seen.len().max(1) as f64;
        names.push((it.part.name, [right + 8.0, middle]));
        for face in all {
            let normal = it.direction(face.normal);
            if dot(normal, VIEW[2]) <= 1e-6 {
                continue;
            }
            let light = 0.45 + 0.55 * dot(normal, LIGHT).max(0.0);
            let [r, g, b] = COLOURS[order % COLOURS.len()].map(|part| (255.0 * part * light) as u8);
            let mut path = String::new();
            let (mut depth, mut corners) = (0.0, 0.0);
            for chain in &face.loops {
                for (i, &index) in chain.iter().enumerate() {
                    let [x, y] = seen[index];
                    // Writing to a string cannot fail.
                    let _ = write!(path, "{}{x:.1} {y:.1}", if i == 0 { "M" } else { "L" });
                    depth += dot(it.point(vertices[index]), VIEW[2]);
                    corners += 1.0;
                }
                path.push('Z');
            }
            let colour = format!("#{r:02x}{g:02x}{b:02x}");
            let shape = format!("<path d=\"{path}\" fill=\"{colour}\" stroke=\"{colour}\"/>\n");
            shapes.push((depth / f64::max(corners, 1.0), shape));
        }
    }
    shapes.sort_by(|a, b| a.0.total_cmp(&b.0));
    if placed.is_empty() {
        (low, high) = ([0.0; 2], [0.0; 2]);
    }
    let corner = [low[0] - MARGIN, low[1] - 2.5 * MARGIN];
    let size = [high[0] - low[0] + 2.0 * MARGIN + 190.0, high[1] - low[1] + 3.5 * MARGIN];
    let mut text = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{2:.0}\" height=\"{3:.0}\" viewBox=\"{0:.1} {1:.1} {2:.1} {3:.1}\" \
         font-family=\"sans-serif\" stroke-width=\".5\" fill-rule=\"evenodd\">\n<rect x=\"{0:.1}\" y=\"{1:.1}\" width=\"100%\" \
         height=\"100%\" fill=\"#fff\"/>\n<text x=\"{4:.1}\" y=\"{5:.1}\" font-size=\"16\">{6}</text>\n",
        corner[0],
        corner[1],
        size[0],
        size[1],
        corner[0] + 0.5 * MARGIN,
        corner[1] + MARGIN,
        title.replace('&', "&amp;").replace('<', "&lt;")
    );
    for (_, shape) in &shapes {
        text.push_str(shape);
    }
    // Names one under the other where they would lie on each other.
    names.sort_by(|a, b| a.1[1].total_cmp(&b.1[1]));
    let mut least = f64::NEG_INFINITY;
    for (name, [x, y]) in names {
        let y = y.max(least);
        least = y + 14.0;
        let _ = writeln!(text, "<text x=\"{x:.1}\" y=\"{y:.1}\" font-size=\"12\">{name}</text>");
    }
    text.push_str("</svg>\n");
    text
}
