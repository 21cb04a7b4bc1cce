//! Where the camera stands for some episodes, how it follows them, and the ground that they move on.

use hwasp_core::{Form, Solid};

use super::eye::{Eye, Flat, World, along, inner};
use super::order::{is_ground, seen_box};
use super::outline::{polygon, polyline};
use hwasp_scene::Take;

/// Where the eye stands where nothing moves along one line: from the x axis towards y, and up, rad.
const AZIMUTH: f64 = -0.55;
const ELEVATION: f64 = 0.28;
/// From above, for what moves on a table.
const HIGH: f64 = 0.9;
/// From the side of what moves along a line, so much is seen of its front, rad.
const ASIDE: f64 = 0.35;
/// Units of the picture across.
const WIDTH: f64 = 2000.0;
/// A picture is at most so many times as wide as it is high, and as high as it is wide.
const LONGEST: [f64; 2] = [2.2, 1.3];
/// What goes so many times its own size is followed.
const FOLLOWED: f64 = 3.0;
/// Moments before and after over which the camera's way is smoothed.
const SMOOTH: usize = 4;
/// The most lines of the ground in one direction.
const MOST_LINES: f64 = 60.0;

/// What all pictures of some episodes have in common.
pub(crate) struct Set {
    pub(super) eye: Eye,
    /// Width and height of the picture.
    pub(super) size: [f64; 2],
    /// For each episode and each of its moments, the upper left corner of the picture.
    pub(super) corners: Vec<Vec<[f64; 2]>>,
    /// Outline and lines of every plane, and lines of other ground.
    pub(super) ground: Vec<[String; 2]>,
    /// Distance between the lines of planes, m.
    pub(super) spacing: f64,
}

/// Left, top, right, bottom.
type Area = [f64; 4];

const NOWHERE: Area = [f64::INFINITY, f64::INFINITY, f64::NEG_INFINITY, f64::NEG_INFINITY];

fn joined(a: Area, b: Area) -> Area {
    [a[0].min(b[0]), a[1].min(b[1]), a[2].max(b[2]), a[3].max(b[3])]
}

/// Width and height.
fn extent(area: Area) -> [f64; 2] {
    [area[2] - area[0], area[3] - area[1]].map(|side| side.max(0.0))
}

/// What is neither ground nor at rest for ever.
fn moving(take: &Take, moment: usize) -> impl Iterator<Item = &Solid> {
    take.moments[moment].sight.solids.iter().filter(|solid| !solid.fixed && !is_ground(&solid.form))
}

/// What stands around at the first moment.
fn standing(take: &Take) -> impl Iterator<Item = &Solid> {
    let solids = take.moments.first().map_or(&[][..], |moment| &moment.sight.solids);
    solids.iter().filter(|solid| solid.fixed)
}

/// What moves at a moment.
fn area(eye: &Eye, take: &Take, i: usize) -> Area {
    let cords = take.moments[i].sight.cords.iter().flat_map(|cord| cord.parts.iter().flatten());
    let ends = cords.map(|&at| eye.flat(at)).map(|[x, y]| [x, y, x, y]);
    moving(take, i).map(|solid| seen_box(eye, solid)).chain(ends).fold(NOWHERE, joined)
}

/// What a picture shows, in the units of some view.
struct Window {
    size: [f64; 2],
    middle: [f64; 2],
    /// Whether it goes along with what moves, across and down.
    follows: [bool; 2],
}

impl Window {
    /// For what moves within `all`, never larger than `largest`, and things that stand around.
    fn new(all: Area, largest: f64, standing: impl Iterator<Item = Area>) -> Self {
        // What stands beside and is not much larger belongs to it.
        let near = |area: &Area| {
            let [wide, high] = extent(*area);
            let apart = (0..2).any(|k| area[k] > all[k + 2] + largest || area[k + 2] < all[k] - largest);
            largest == 0.0 || (wide.max(high) <= 2.0 * largest && !apart)
        };
        let whole = standing.filter(near).fold(all, joined);
        let follows = extent(all).map(|side| side > FOLLOWED * largest);
        let [wide, high] = extent(whole);
        let margin = 0.06 * largest.max(wide.min(high)).max(1e-3);
        let side = |follows: bool, whole: f64| 2.0 * margin + if follows { 2.0 * largest } else { whole };
        let [wide, high] = [side(follows[0], wide), side(follows[1], high)];
        let middle = [0, 1].map(|k| 0.5 * (whole[k] + whole[k + 2]));
        Self {
            size: [wide.max(high / LONGEST[1]), high.max(wide / LONGEST[0])],
            middle: middle.map(|at| if at.is_finite() { at } else { 0.0 }),
            follows,
        }
    }

    /// The upper left corner of the picture of a moment.
    fn corner(&self, areas: &[Area], i: usize) -> [f64; 2] {
        let near = &areas[i.saturating_sub(SMOOTH)..(i + SMOOTH + 1).min(areas.len())];
        let middle = |area: &Area, k: usize| 0.5 * (area[k] + area[k + 2]);
        // Smoothed, but never so much that it leaves the picture.
        let centre = |k: usize| {
            let (own, room) = (middle(&areas[i], k), 0.2 * self.size[k]);
            let smooth = near.iter().map(|area| middle(area, k)).sum::<f64>() / near.len() as f64;
            smooth.clamp(own - room, own + room)
        };
        [0, 1].map(|k| if self.follows[k] { centre(k) } else { self.middle[k] } - 0.5 * self.size[k])
    }
}

impl Set {
    /// For episodes of which each has a moment.
    pub(crate) fn new(takes: &[Take]) -> Self {
        let eye = direction(takes);
        let areas = |take: &Take| -> Vec<Area> { (0..take.moments.len()).map(|i| area(&eye, take, i)).collect() };
        let areas: Vec<Vec<Area>> = takes.iter().map(areas).collect();
        let all = areas.iter().flatten().copied().fold(NOWHERE, joined);
        let largest = areas.iter().flatten().flat_map(|&area| extent(area)).fold(0.0, f64::max);
        let standing_areas = takes.iter().flat_map(standing).filter(|solid| !is_ground(&solid.form));
        let window = Window::new(all, largest, standing_areas.map(|solid| seen_box(&eye, solid)));
        let scale = WIDTH / window.size[0];
        let scaled = |corner: [f64; 2]| corner.map(|at| (at * scale).round());
        let corners = |areas: &Vec<Area>| (0..areas.len()).map(|i| scaled(window.corner(areas, i))).collect();
        let spacing = round(window.size[0].min(window.size[1]) / 5.0);
        let eye = eye.scaled(scale);
        let grounds = takes.iter().take(1).flat_map(standing);
        Self {
            eye,
            size: [WIDTH, (window.size[1] * scale).round()],
            corners: areas.iter().map(corners).collect(),
            ground: grounds.filter_map(|solid| ground(&eye, solid, takes, (window.size[0], spacing))).collect(),
            spacing,
        }
    }
}

/// 1, 2 or 5 times a power of ten, not above a length.
fn round(length: f64) -> f64 {
    let power = 10_f64.powf(length.max(1e-9).log10().floor());
    [5.0, 2.0, 1.0].into_iter().map(|digit| digit * power).find(|&round| round <= length).unwrap_or(power)
}

/// From where episodes are seen best, a metre as long as a unit: what moves along a line, or in an upright plane, from the side.
fn direction(takes: &[Take]) -> Eye {
    let solids = || takes.iter().flat_map(|take| (0..take.moments.len()).flat_map(move |i| moving(take, i)));
    let count = solids().count().max(1) as f64;
    let mean: World = std::array::from_fn(|k| solids().map(|solid| solid.at[k]).sum::<f64>() / count);
    // The spread of everything that moves: of its places, and of long things along themselves.
    let mut spread = [[0.0; 3]; 3];
    for solid in solids() {
        let off = along(solid.at, -1.0, mean);
        let own: World =
            std::array::from_fn(|k| super::outline::reach(&Solid { at: [0.0; 3], ..solid.clone() }, solid.axes[k]));
        for i in 0..3 {
            for j in 0..3 {
                let inside = (0..3).map(|k| own[k] * own[k] * solid.axes[k][i] * solid.axes[k][j] / 3.0).sum::<f64>();
                spread[i][j] += (off[i] * off[j] + inside) / count;
            }
        }
    }
    let [xx, xy, yy] = [spread[0][0], spread[0][1], spread[1][1]];
    let (half, root) = (0.5 * (xx + yy), (0.25 * (xx - yy).powi(2) + xy * xy).sqrt());
    let (most, least) = (half + root, half - root);
    let elevation = if spread[2][2] < 0.1 * least { HIGH } else { ELEVATION };
    if most <= 2.0 * least {
        return Eye::new(AZIMUTH, elevation, 1.0);
    }
    // Along the line, the side from which x is to the right.
    let line = 0.5 * (2.0 * xy).atan2(xx - yy);
    let side = line - std::f64::consts::FRAC_PI_2;
    Eye::new(side + ASIDE, elevation, 1.0)
}

/// Outline and lines of ground; none where it is seen from below.
fn ground(eye: &Eye, solid: &Solid, takes: &[Take], (window, spacing): (f64, f64)) -> Option<[String; 2]> {
    let flat = |[x, y, z]: World| {
        let at = along(along(along(solid.at, x, solid.axes[0]), y, solid.axes[1]), z, solid.axes[2]);
        eye.flat(at)
    };
    match &solid.form {
        Form::Field(rows) => {
            let columns = rows.first().map_or(0, Vec::len);
            let lines = rows.iter().map(|row| row.iter().map(|&at| flat(at)).collect::<Vec<Flat>>());
            let across = (0..columns).map(|i| rows.iter().filter_map(|row| row.get(i)).map(|&at| flat(at)).collect());
            Some([String::new(), lines.chain(across).map(|line| polyline(&line)).collect()])
        }
        Form::Plane(half) if eye.sees(solid.axes[2]) => {
            // As much of it as things move over, and as a picture is wide.
            let mut area = NOWHERE;
            for take in takes {
                for at in (0..take.moments.len()).flat_map(|i| moving(take, i)).map(|thing| thing.at) {
                    let [x, y] = [0, 1].map(|k| inner(along(at, -1.0, solid.at), solid.axes[k]));
                    area = joined(area, [x, y, x, y]);
                }
            }
            if area[0] > area[2] {
                area = [0.0; 4];
            }
            let side = |k: usize| {
                let end = if half[k] > 0.0 { half[k] } else { f64::INFINITY };
                let snapped = |at: f64| (at / spacing).round() * spacing;
                [snapped(area[k] - 0.8 * window).max(-end), snapped(area[k + 2] + 0.8 * window).min(end)]
            };
            let [[left, right], [near, far]] = [side(0), side(1)];
            let corners = [[left, near], [right, near], [right, far], [left, far]].map(|[x, y]| flat([x, y, 0.0]));
            let lines = |from: f64, to: f64| {
                let step = spacing * ((to - from) / spacing / MOST_LINES).ceil().max(1.0);
                let first = (from / step).floor() as i64 + 1;
                (first..).map(move |i| i as f64 * step).take_while(move |&at| at < to)
            };
            let along_y = lines(left, right).map(|x| polyline(&[flat([x, near, 0.0]), flat([x, far, 0.0])]));
            let along_x = lines(near, far).map(|y| polyline(&[flat([left, y, 0.0]), flat([right, y, 0.0])]));
            Some([polygon(&corners), along_y.chain(along_x).collect()])
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::round;

    #[test]
    fn distances_are_round() {
        assert_eq!([0.3, 1.0, 7.9, 0.0499].map(round).map(|x| (x * 1e6).round() / 1e6), [0.2, 1.0, 5.0, 0.02]);
    }
}
