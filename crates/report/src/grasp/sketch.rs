//! One picture: paths from the back to the front.
//!
//! A picture has the same slots at every moment, so that a film only has to change the paths in them. Links have two slots,
//! behind the object and before it, one of which is empty.

use hwasp_mujoco::grasp::ShapeKind;
use maud::{Markup, html};

use super::pose::{Pose, Poses};
use super::shape::{Ellipse, dot, faces, line, polygon, polyline};
use super::view::{Flat, View, World, along, inner, minus};

/// The order in which links are painted: second finger, first finger, thumb, of each the proximal link first.
const ORDER: [usize; 6] = [4, 5, 2, 3, 0, 1];
/// What the links are called in the style.
const LINKS: [&str; 6] = ["thumb", "thumb tip", "finger", "finger tip", "finger", "finger tip"];
/// The edge of the floor's squares, m.
const SQUARE: f64 = 0.05;
/// Room around everything, m.
const MARGIN: f64 = 0.008;

/// The paths of a moment: shadow of the object; links and joints behind it; its own three; links and joints before it; the
/// palm's three.
#[derive(Clone, Debug, Default)]
pub(super) struct Frame {
    kind: &'static str,
    pub(super) slots: Vec<String>,
    /// Height of the object above the floor, mm.
    pub(super) height: i32,
}

/// What all pictures of some episodes have in common.
pub(super) struct Sketch {
    view: View,
    /// Left, top, width, height.
    frame: [f64; 4],
    floor: String,
    grid: String,
    link: f64,
}

impl Sketch {
    /// One that shows all of these episodes.
    pub(super) fn new(episodes: &[Poses]) -> Self {
        let view = View::default();
        // As much of the floor as objects and palms are above, at least two squares to each side.
        let places = episodes.iter().flat_map(|poses| &poses.moments).flat_map(|pose| [pose.object, pose.palm]);
        let reach = places.flat_map(|[x, y, _]| [x.abs(), y.abs()]).fold(0.0, f64::max) + SQUARE;
        let squares = (reach / SQUARE).ceil().clamp(2.0, 10.0) as i32;
        let floor = SQUARE * f64::from(squares);
        let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(|(x, y)| [floor * x, floor * y, 0.0]);
        let mut seen: Vec<Flat> = corners.map(|corner| view.flat(corner)).to_vec();
        for (poses, pose) in episodes.iter().flat_map(|poses| poses.moments.iter().map(move |pose| (poses, pose))) {
            seen.push(view.flat(along(pose.palm, poses.hand.palm.half_size[2] * 2.0 + 0.02, [0.0, 0.0, 1.0])));
            let reach = poses.half.iter().fold(0.0, |sum, half| half.hypot(sum));
            let [x, y] = view.flat(pose.object);
            let reach = View::length(reach);
            seen.extend([[x - reach, y - reach], [x + reach, y]]);
            seen.extend(pose.links.iter().flatten().map(|&end| view.flat(end)));
        }
        let edge =
            |axis: usize, pick: fn(f64, f64) -> f64, from: f64| seen.iter().fold(from, |e, at| pick(e, at[axis]));
        let margin = View::length(MARGIN);
        let (left, top) = (edge(0, f64::min, f64::INFINITY) - margin, edge(1, f64::min, f64::INFINITY) - margin);
        let (right, bottom) =
            (edge(0, f64::max, f64::NEG_INFINITY) + margin, edge(1, f64::max, f64::NEG_INFINITY) + margin);
        let grid = (1 - squares..squares).map(|i| SQUARE * f64::from(i)).flat_map(|at| {
            let along_x = line(view.flat([-floor, at, 0.0]), view.flat([floor, at, 0.0]));
            [along_x, line(view.flat([at, -floor, 0.0]), view.flat([at, floor, 0.0]))]
        });
        let radius = episodes.first().map_or(0.0, |poses| poses.hand.thumb.distal.radius);
        Self {
            view,
            frame: [left, top, right - left, bottom - top].map(f64::round),
            floor: polygon(&corners.map(|corner| view.flat(corner))),
            grid: grid.collect(),
            link: 2.0 * View::length(radius),
        }
    }

    /// The paths at a step.
    pub(super) fn frame(&self, poses: &Poses, step: usize) -> Frame {
        let Some(pose) = poses.moments.get(step) else { return Frame::default() };
        let flat = pose.links.map(|link| link.map(|end| self.view.flat(end)));
        let before: [bool; 6] = std::array::from_fn(|i| self.before(poses, pose, pose.links[i]));
        let mut slots = vec![self.shadow(poses, pose)];
        for front in [false, true] {
            let shown = |i: &usize| before[*i] == front;
            slots.extend(ORDER.iter().map(|&i| if shown(&i) { line(flat[i][0], flat[i][1]) } else { String::new() }));
            slots.push((0..6).filter(shown).map(|i| dot(flat[i][0])).collect());
            if !front {
                slots.extend(self.object(poses, pose));
            }
        }
        let [.., height] = poses.hand.palm.half_size;
        let palm = along(pose.palm, height, [0.0, 0.0, 1.0]);
        let world = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        slots.extend(faces(&self.view, palm, &world, poses.hand.palm.half_size));
        let height = (1e3 * pose.clearance).round().max(0.0) as i32;
        Frame { kind: poses.kind.name(), slots, height }
    }

    /// What is seen of the object.
    fn object(&self, poses: &Poses, pose: &Pose) -> [String; 3] {
        let (view, half) = (&self.view, poses.half);
        let stretched: [World; 3] = std::array::from_fn(|i| pose.axes[i].map(|part| half[i] * part));
        match poses.kind {
            ShapeKind::Box => faces(view, pose.object, &pose.axes, half),
            ShapeKind::Sphere | ShapeKind::Ellipsoid => {
                let outline = Ellipse::seen(view, pose.object, &stretched);
                let shift = View::length(0.22 * half[2]);
                [outline.path(1.0, [0.0; 2]), outline.path(0.55, [-0.5 * shift, -shift]), String::new()]
            }
            ShapeKind::Cylinder => {
                let end = |side: f64| along(pose.object, side, stretched[2]);
                let (near, far) = if view.sees(stretched[2]) { (end(1.0), end(-1.0)) } else { (end(-1.0), end(1.0)) };
                let [near, far] = [near, far].map(|end| Ellipse::seen(view, end, &stretched[..2]));
                let [x, y] = view.flat(stretched[2]);
                let (across, back) = ([-y, x], [y, -x]);
                // Open towards the far end, where only the ellipse has an edge; the near one lies over the other end.
                let side =
                    polyline(&[far.support(across), near.support(across), near.support(back), far.support(back)]);
                [far.path(1.0, [0.0; 2]), side, near.path(1.0, [0.0; 2])]
            }
        }
    }

    /// The object's shadow under a sun at the zenith: an ellipse as wide as it is.
    fn shadow(&self, poses: &Poses, pose: &Pose) -> String {
        let on_floor = |axis: World, half: f64| [half * axis[0], half * axis[1], 0.0];
        let axes: Vec<World> = (0..3).map(|i| on_floor(pose.axes[i], poses.half[i])).collect();
        Ellipse::seen(&self.view, [pose.object[0], pose.object[1], 0.0], &axes).path(1.0, [0.0; 2])
    }

    /// Whether a link lies before the object: whether the eye sees the side of the object's surface that it is nearest to.
    fn before(&self, poses: &Poses, pose: &Pose, [from, to]: [World; 2]) -> bool {
        let along_link = minus(to, from);
        let nearest =
            inner(minus(pose.object, from), along_link) / inner(along_link, along_link).max(f64::MIN_POSITIVE);
        let off = minus(along(from, nearest.clamp(0.0, 1.0), along_link), pose.object);
        let own: World = std::array::from_fn(|i| inner(off, pose.axes[i]) / poses.half[i]);
        let normal: World = match poses.kind {
            ShapeKind::Sphere | ShapeKind::Ellipsoid => std::array::from_fn(|i| own[i] / poses.half[i]),
            ShapeKind::Cylinder if own[2].abs() < own[0].hypot(own[1]) => [own[0], own[1], 0.0],
            ShapeKind::Cylinder => [0.0, 0.0, own[2]],
            ShapeKind::Box => {
                let most = own.iter().fold(0.0, |most: f64, part| most.max(part.abs()));
                own.map(|part| if part.abs() == most { part } else { 0.0 })
            }
        };
        let normal = (0..3).fold([0.0; 3], |sum, i| along(sum, normal[i], pose.axes[i]));
        self.view.sees(normal)
    }

    /// A picture with its name; `id` is its own. That of a `film` has all its slots, numbered, for the paths to come.
    pub(super) fn svg(&self, frame: &Frame, film: bool, [id, title, about]: [&str; 3]) -> Markup {
        let [left, top, width, height] = self.frame;
        let (outer, inner) = (self.link, self.link - View::length(0.0024));
        let path = |slot: usize, class: Option<&str>, pen: Option<f64>| {
            let path = frame.slots.get(slot).map_or("", String::as_str);
            html! {
                @if film || !path.is_empty() {
                    path class=[class] data-slot=[film.then_some(slot)] stroke-width=[pen] d=(path) {}
                }
            }
        };
        let links = |from: usize| {
            html! {
                @for (i, &link) in ORDER.iter().enumerate() {
                    (path(from + i, Some("edge"), Some(outer))) (path(from + i, Some(LINKS[link]), Some(inner)))
                }
                (path(from + 6, Some("joint"), Some(0.34 * self.link)))
            }
        };
        html! {
            svg.sketch viewBox={ (left) " " (top) " " (width) " " (height) } role="img" aria-labelledby={ (id) "-t " (id) "-d" } {
                title id={ (id) "-t" } { (title) }
                desc id={ (id) "-d" } { (about) }
                path.floor d=(self.floor) {}
                path.grid d=(self.grid) {}
                (path(0, Some("shadow"), None))
                (links(1))
                g.object data-kind=(frame.kind) { @for i in 8..11 { (path(i, None, None)) } }
                (links(11))
                g.palm { @for i in 18..21 { (path(i, None, None)) } }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use hwasp_tasks::hand::HandDescription;

    use super::*;

    /// A ball on the floor between a link in front of it and one behind.
    #[test]
    fn links_are_painted_on_the_side_on_which_they_are() {
        let [thumb, finger] = [-0.05, 0.05].map(|y| [[0.0, y, 0.08], [0.0, y, 0.03]]);
        let pose = Pose {
            palm: [0.0, 0.0, 0.1],
            links: [thumb, thumb, finger, finger, finger, finger],
            object: [0.0, 0.0, 0.03],
            axes: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
            clearance: 0.0126,
        };
        for &(_, kind) in ShapeKind::ALL {
            let moments = vec![pose.clone()];
            let poses = Poses { kind, half: [0.03; 3], hand: HandDescription::default(), moments };
            let sketch = Sketch::new(std::slice::from_ref(&poses));
            let frame = sketch.frame(&poses, 0);
            assert_eq!((frame.slots.len(), frame.height, frame.kind), (1 + 7 + 3 + 7 + 3, 13, kind.name()));
            let (behind, before) = (&frame.slots[1..7], &frame.slots[11..17]);
            let there = |slots: &[String]| slots.iter().map(|slot| !slot.is_empty()).collect::<Vec<_>>();
            assert_eq!(there(behind), [true, true, true, true, false, false], "{kind:?}");
            assert_eq!(there(before), [false, false, false, false, true, true], "{kind:?}");
            assert!(frame.slots[8].starts_with('M') && frame.slots[20].ends_with('z'));
        }
        let poses = Poses { kind: ShapeKind::Box, half: [0.03; 3], hand: HandDescription::default(), moments: vec![] };
        assert!(Sketch::new(&[]).frame(&poses, 0).slots.is_empty());
    }
}
