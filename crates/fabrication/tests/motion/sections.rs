//! Sections of meshes, laid over each other.

use hwasp_fabrication::Part;

/// Between the rows of points that are held against both, m.
const PITCH: f64 = 2e-4;
/// What two parts may have in common in a section, m²: parts that lean on each other touch.
pub(crate) const TOUCH: f64 = 2e-8;

/// The sides of a section, from corner to corner.
type Sides = Vec<[[f64; 2]; 2]>;

/// The sections of a solid by their height along an axis, between the heights of its corners.
pub(crate) struct Sections {
    pub(crate) heights: Vec<f64>,
    pub(crate) sides: Vec<Sides>,
}

impl Sections {
    /// Of a part, across axis 0, 1 or 2; what is left of a point are the next two, in turn.
    pub(crate) fn of(part: &Part, axis: usize) -> Self {
        let mut heights: Vec<f64> = part.mesh.triangles().flatten().map(|corner| corner[axis]).collect();
        heights.sort_by(f64::total_cmp);
        heights.dedup_by(|a, b| (*a - *b).abs() < 1e-9);
        let sides = heights.windows(2).map(|pair| section(part, axis, 0.5 * (pair[0] + pair[1]))).collect();
        Self { heights, sides }
    }

    /// Of a box across its third axis.
    pub(crate) fn of_box([x0, x1]: [f64; 2], [y0, y1]: [f64; 2], z: [f64; 2]) -> Self {
        let corners = [[x0, y0], [x1, y0], [x1, y1], [x0, y1]];
        Self { heights: z.to_vec(), sides: vec![(0..4).map(|i| [corners[i], corners[(i + 1) % 4]]).collect()] }
    }

    /// Mirrored in x and y, as a digit is that opens along y.
    pub(crate) fn turned(&self) -> Self {
        let flip = |side: &[[f64; 2]; 2]| side.map(|[y, z]| [-y, z]);
        Self {
            heights: self.heights.iter().rev().map(|x| -x).collect(),
            sides: self.sides.iter().rev().map(|sides| sides.iter().map(flip).collect()).collect(),
        }
    }

    /// The largest area that the sections of both have in common, m², where this one is put at `place` and `angle` and `across`.
    pub(crate) fn shared(&self, other: &Self, place: impl Fn([f64; 2]) -> [f64; 2], across: f64) -> f64 {
        let mut largest = 0.0;
        for (i, pair) in self.heights.windows(2).enumerate() {
            let moved: Sides = self.sides[i].iter().map(|side| side.map(&place)).collect();
            for (k, beyond) in other.heights.windows(2).enumerate() {
                let common = (pair[1] + across).min(beyond[1]) - (pair[0] + across).max(beyond[0]);
                if common > 1e-9 {
                    largest = f64::max(largest, area(&moved, &other.sides[k]));
                }
            }
        }
        largest
    }
}

/// The sides of the section at a height.
fn section(part: &Part, axis: usize, height: f64) -> Sides {
    let cross = |corners: [[f64; 3]; 3]| {
        let points: Vec<[f64; 2]> = (0..3)
            .filter_map(|i| {
                let (a, b) = (corners[i], corners[(i + 1) % 3]);
                let at = (height - a[axis]) / (b[axis] - a[axis]);
                let point = [1, 2].map(|next| {
                    let j = (axis + next) % 3;
                    a[j] + at * (b[j] - a[j])
                });
                ((a[axis] > height) != (b[axis] > height)).then_some(point)
            })
            .collect();
        <[[f64; 2]; 2]>::try_from(points).ok()
    };
    part.mesh.triangles().filter_map(cross).collect()
}

/// The area that is inside of both, m², by rows.
fn area(one: &[[[f64; 2]; 2]], other: &[[[f64; 2]; 2]]) -> f64 {
    let span = |sides: &[[[f64; 2]; 2]]| {
        let zs = sides.iter().flatten().map(|point| point[1]);
        [zs.clone().fold(f64::INFINITY, f64::min), zs.fold(f64::NEG_INFINITY, f64::max)]
    };
    let (a, b) = (span(one), span(other));
    let (low, high) = (a[0].max(b[0]), a[1].min(b[1]));
    let rows = ((high - low) / PITCH).max(0.0) as u32;
    let inside = |sides: &[[[f64; 2]; 2]], z: f64| {
        let mut crossings: Vec<f64> = (sides.iter())
            .filter(|[from, to]| (from[1] > z) != (to[1] > z))
            .map(|[from, to]| from[0] + (to[0] - from[0]) * (z - from[1]) / (to[1] - from[1]))
            .collect();
        crossings.sort_by(f64::total_cmp);
        crossings
    };
    let common = |row: u32| -> f64 {
        let z = low + (f64::from(row) + 0.5) * PITCH;
        let (mine, theirs) = (inside(one, z), inside(other, z));
        let pairs = mine.chunks_exact(2).flat_map(|m| theirs.chunks_exact(2).map(move |t| (m, t)));
        pairs.map(|(m, t)| (m[1].min(t[1]) - m[0].max(t[0])).max(0.0)).sum()
    };
    (0..rows).map(|row| PITCH * common(row)).sum()
}
