//! A stack seen from above through a fine grid: what of it is shell, what is core, and how thick it is along its axis.

use super::layers::Layer;
use super::outline::{Outline, edges};

/// Between the points of the grid, m.
const PITCH: f64 = 2.5e-4;

/// What of a stack lies at least a shell's thickness inside: from its sides within each layer, and from what is open above and below,
/// as slicers have it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Core {
    /// Its volume, m³.
    pub(crate) volume: f64,
    /// The middle of it, along the axis and in the plane, m.
    pub(crate) middle: (f64, [f64; 2]),
}

/// The points over which a stack stands, row by row.
struct Grid {
    low: [f64; 2],
    size: [usize; 2],
}

impl Grid {
    fn over(layers: &[Layer]) -> Self {
        let corners = layers.iter().flat_map(|layer| layer.add.iter().flatten());
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for corner in corners {
            low = [0, 1].map(|i| low[i].min(corner[i]));
            high = [0, 1].map(|i| high[i].max(corner[i]));
        }
        // A point beyond on every side; and none on a side that stands at a round number.
        let low = low.map(|low| low - 1.0317 * PITCH);
        let size = [0, 1].map(|i| ((high[i] - low[i]) / PITCH).max(0.0) as usize + 2);
        Self { low, size }
    }

    fn len(&self) -> usize {
        self.size[0] * self.size[1]
    }

    fn at(&self, index: usize) -> [f64; 2] {
        let place = [index % self.size[0], index / self.size[0]];
        [0, 1].map(|i| self.low[i] + place[i] as f64 * PITCH)
    }

    /// Marks what is inside of an outline.
    fn mark(&self, outline: &Outline, inside: bool, marks: &mut [bool]) {
        for row in 0..self.size[1] {
            let b = self.low[1] + row as f64 * PITCH;
            let mut crossings: Vec<f64> = edges(outline)
                .filter(|([_, from], [_, to])| (*from > b) != (*to > b))
                .map(|(from, to)| from[0] + (to[0] - from[0]) * (b - from[1]) / (to[1] - from[1]))
                .collect();
            crossings.sort_by(f64::total_cmp);
            for pair in crossings.chunks_exact(2) {
                let place = |a: f64| ((a - self.low[0]) / PITCH).ceil().clamp(0.0, self.size[0] as f64) as usize;
                marks[row * self.size[0]..][place(pair[0])..place(pair[1])].fill(inside);
            }
        }
    }

    fn filled(&self, layer: &Layer) -> Vec<bool> {
        let mut marks = vec![false; self.len()];
        layer.add.iter().for_each(|outline| self.mark(outline, true, &mut marks));
        layer.cut.iter().for_each(|outline| self.mark(outline, false, &mut marks));
        marks
    }

    /// Which points have no empty one nearer than `distance`.
    fn eroded(&self, filled: &[bool], distance: f64) -> Vec<bool> {
        // An empty point is half a pitch beyond the side, on average.
        let reach = distance / PITCH + 0.5;
        let whole = reach as i64;
        let near: Vec<i64> = (-whole..=whole)
            .flat_map(|row| (-whole..=whole).map(move |column| (row, column)))
            .filter(|&(row, column)| (row * row + column * column) as f64 <= reach * reach)
            .map(|(row, column)| row * self.size[0] as i64 + column)
            .collect();
        let is_filled = |index: i64| usize::try_from(index).ok().and_then(|i| filled.get(i)).is_some_and(|&it| it);
        (0..filled.len()).map(|index| filled[index] && near.iter().all(|off| is_filled(index as i64 + off))).collect()
    }
}

/// The core of a stack under a shell of this thickness, m.
pub(crate) fn core(layers: &[Layer], shell: f64) -> Core {
    let grid = Grid::over(layers);
    let filled: Vec<Vec<bool>> = layers.iter().map(|layer| grid.filled(layer)).collect();
    let inner: Vec<Vec<bool>> = filled.iter().map(|filled| grid.eroded(filled, shell)).collect();
    let (mut volume, mut height, mut place) = (0.0, 0.0, [0.0; 2]);
    for index in 0..grid.len() {
        for [first, last] in runs(&filled, index) {
            let ends = [layers[first].heights[0] + shell, layers[last].heights[1] - shell];
            for (layer, _) in (first..=last).map(|i| (&layers[i], &inner[i])).filter(|(_, inner)| inner[index]) {
                let from = layer.heights[0].max(ends[0]);
                let to = layer.heights[1].min(ends[1]);
                let part = (to - from).max(0.0) * PITCH * PITCH;
                volume += part;
                height += part * 0.5 * (from + to);
                place = [0, 1].map(|i| place[i] + part * grid.at(index)[i]);
            }
        }
    }
    let whole = f64::max(volume, f64::MIN_POSITIVE);
    Core { volume, middle: (height / whole, place.map(|sum| sum / whole)) }
}

/// Where a stack is thinnest along its axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Floor {
    /// How thick it is there, m.
    pub(crate) thickness: f64,
    /// Where: half way along the axis, and in the plane, m.
    pub(crate) at: (f64, [f64; 2]),
}

/// How thick a stack is along its axis where it is thinnest.
pub(crate) fn thinnest_along(layers: &[Layer]) -> Floor {
    let grid = Grid::over(layers);
    let filled: Vec<Vec<bool>> = layers.iter().map(|layer| grid.filled(layer)).collect();
    let mut least = Floor { thickness: f64::INFINITY, at: (0.0, [0.0; 2]) };
    for index in 0..grid.len() {
        for [first, last] in runs(&filled, index) {
            let [from, to] = [layers[first].heights[0], layers[last].heights[1]];
            if to - from < least.thickness {
                least = Floor { thickness: to - from, at: (0.5 * (from + to), grid.at(index)) };
            }
        }
    }
    least
}

/// The layers from and to which a point is filled without a gap.
fn runs(filled: &[Vec<bool>], index: usize) -> Vec<[usize; 2]> {
    let mut runs: Vec<[usize; 2]> = Vec::new();
    for layer in (0..filled.len()).filter(|&layer| filled[layer][index]) {
        match runs.last_mut() {
            Some(run) if run[1] + 1 == layer => run[1] = layer,
            _ => runs.push([layer, layer]),
        }
    }
    runs
}

#[cfg(test)]
mod tests {
    use super::super::outline::{disc, rectangle};
    use super::*;

    /// A block of 20 × 10 × 6 mm with a shell of 1 mm has a core of 18 × 8 × 4 mm; a hole of 4 mm takes 6 mm out of it.
    #[test]
    fn the_core_of_a_block() {
        let body = rectangle([0.0, 0.020], [0.0, 0.010]);
        let bored = disc([0.014, 0.005], 0.002);
        let block = |cut: Vec<Outline>| {
            let layer = |heights| Layer { heights, add: vec![body.clone()], cut: cut.clone() };
            [layer([0.0, 0.002]), layer([0.002, 0.006])]
        };
        let whole = core(&block(vec![]), 0.001);
        assert!((whole.volume / (18e-3 * 8e-3 * 4e-3) - 1.0).abs() < 0.02, "{whole:?}");
        assert!((whole.middle.0 - 0.003).abs() < 1e-6, "{whole:?}");
        assert!((whole.middle.1[0] - 0.010).abs() < PITCH && (whole.middle.1[1] - 0.005).abs() < PITCH, "{whole:?}");
        let bored = core(&block(vec![bored]), 0.001);
        let hole = std::f64::consts::PI * 0.003 * 0.003 * 0.004;
        assert!(((whole.volume - bored.volume) / hole - 1.0).abs() < 0.06, "{bored:?}");
        assert!(bored.middle.1[0] < 0.010);
        assert_eq!(core(&block(vec![]), 0.0031).volume, 0.0);
    }

    #[test]
    fn the_thinnest_floor() {
        let body = rectangle([0.0, 0.020], [0.0, 0.010]);
        let pocket = disc([0.010, 0.005], 0.003);
        let layers = [
            Layer { heights: [0.0, 0.0012], add: vec![body.clone()], cut: vec![] },
            Layer { heights: [0.0012, 0.006], add: vec![body], cut: vec![pocket] },
        ];
        assert!((thinnest_along(&layers).thickness - 0.0012).abs() < 1e-12);
    }
}
