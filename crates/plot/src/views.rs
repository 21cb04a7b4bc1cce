//! What shows itself, drawn from three sides to one scale, with its measures.

use hwasp_core::{Form, Sight, Solid};

use crate::panel::{GREY, INK};
use crate::svg::{Anchor, Svg, text_width};

type Point = [f64; 3];
type Flat = (f64, f64);
/// The colour of a cord, and its way.
type Line = ([u8; 3], Vec<Flat>);

/// Room for all views together, px, and between them.
const ROOM: (f64, f64) = (860.0, 300.0);
const GAP: f64 = 56.0;
const TEXT: f64 = 11.0;
/// Room above for the names, and below for the measures.
const ABOVE: f64 = 30.0;
const BELOW: f64 = 34.0;
/// Points of a circle.
const ROUND: usize = 24;

/// From where it is seen: what it is called, the axes to the right and up, and towards the eye.
const SIDES: [(&str, usize, usize, (usize, f64)); 3] =
    [("from the front", 0, 2, (1, -1.0)), ("from the right", 1, 2, (0, 1.0)), ("from above", 0, 1, (2, 1.0))];

/// An outline in a view, m, and how near it is.
struct Shape {
    outline: Vec<Flat>,
    nearness: f64,
    colour: [u8; 3],
    opacity: f32,
}

/// Draws the solids and cords of a sight, without the ground; none where there is nothing else.
pub fn views(sight: &Sight) -> Option<String> {
    let views = SIDES.map(|(_, right, up, towards)| shapes(sight, right, up, towards));
    let cords = |right: usize, up: usize| -> Vec<Line> {
        let flat = |part: &Vec<Point>| part.iter().map(|at| (at[right], at[up])).collect();
        sight.cords.iter().flat_map(|cord| cord.parts.iter().map(|part| (cord.colour, flat(part)))).collect()
    };
    let cords = SIDES.map(|(_, right, up, _)| cords(right, up));
    let points = |(shapes, cords): (&Vec<Shape>, &Vec<Line>)| {
        bounds(shapes.iter().map(|shape| &shape.outline).chain(cords.iter().map(|(_, line)| line)).flatten())
    };
    let boxes: Vec<[f64; 4]> = views.iter().zip(&cords).map(points).collect();
    if boxes.iter().any(|[left, low, right, high]| !(right > left && high > low)) {
        return None;
    }
    let wide: f64 = boxes.iter().map(|[left, _, right, _]| right - left).sum();
    let high = boxes.iter().map(|[_, low, _, high]| high - low).fold(0.0, f64::max);
    let scale = (ROOM.0 / wide).min(ROOM.1 / high);
    // A view has as much room as its name takes, at least.
    let rooms: Vec<f64> = (SIDES.iter().zip(&boxes))
        .map(|((name, ..), [left, _, right, _])| (scale * (right - left)).max(text_width(name, TEXT)))
        .collect();
    let (width, height) = (rooms.iter().sum::<f64>() + GAP * rooms.len() as f64, ABOVE + scale * high + BELOW);
    let mut svg = Svg::new(width, height, "the mechanism from three sides");
    let mut x = GAP / 2.0;
    for (((name, ..), shapes), ((cords, area), room)) in
        SIDES.iter().zip(&views).zip(cords.iter().zip(&boxes).zip(&rooms))
    {
        let [left, low, right, top] = *area;
        let at = |(h, v): Flat| (x + scale * (h - left), ABOVE + scale * (high - (v - low)));
        svg.text((x, 16.0), TEXT, Anchor::Start, INK, name);
        for Shape { outline, colour: [r, g, b], opacity, .. } in shapes {
            let style = format!(
                "fill=\"#{r:02x}{g:02x}{b:02x}\" fill-opacity=\"{opacity:.2}\" stroke=\"#666666\" stroke-width=\"0.9\""
            );
            svg.polygon(outline.iter().map(|&point| at(point)), &style);
        }
        for ([r, g, b], line) in cords {
            let points: Vec<Flat> = line.iter().map(|&point| at(point)).collect();
            svg.polyline(&points, &format!("stroke=\"#{r:02x}{g:02x}{b:02x}\" stroke-width=\"1.6\""));
        }
        let (start, end, y) = (at((left, low)), at((right, low)), ABOVE + scale * high + 10.0);
        measure(&mut svg, (start.0, y), (end.0, y));
        svg.text((f64::midpoint(start.0, end.0), y + 16.0), TEXT, Anchor::Middle, GREY, &length(right - left));
        let (foot, head, side) = (at((left, low)).1, at((left, top)).1, end.0 + 10.0);
        measure(&mut svg, (side, foot), (side, head));
        svg.upward_text((side + 14.0, f64::midpoint(foot, head)), TEXT, GREY, &length(top - low));
        x += room + GAP;
    }
    Some(svg.finish())
}

/// A line with ends.
fn measure(svg: &mut Svg, (x1, y1): Flat, (x2, y2): Flat) {
    let style = "stroke=\"#666666\" stroke-width=\"0.8\"";
    svg.line((x1, y1), (x2, y2), style);
    let (across, down) = if (y1 - y2).abs() < 1e-9 { (0.0, 4.0) } else { (4.0, 0.0) };
    for (x, y) in [(x1, y1), (x2, y2)] {
        svg.line((x - across, y - down), (x + across, y + down), style);
    }
}

fn length(metres: f64) -> String {
    if metres < 1.0 { format!("{:.0} mm", 1e3 * metres) } else { format!("{metres:.2} m") }
}

/// What is seen from a side, the farthest first.
fn shapes(sight: &Sight, right: usize, up: usize, (depth, towards): (usize, f64)) -> Vec<Shape> {
    let shape = |solid: &Solid| {
        let outline = hull(surface(solid).into_iter().map(|at| (at[right], at[up])).collect());
        (outline.len() > 2).then(|| Shape {
            outline,
            nearness: towards * solid.at[depth],
            colour: solid.colour,
            opacity: solid.opacity,
        })
    };
    let mut shapes: Vec<Shape> = sight.solids.iter().filter_map(shape).collect();
    shapes.sort_by(|a, b| a.nearness.total_cmp(&b.nearness));
    shapes
}

/// Points on the surface of a solid whose hull it is, near enough, in the world's frame; none of ground.
fn surface(solid: &Solid) -> Vec<Point> {
    let circle = |radius: f64, z: f64| {
        (0..ROUND).map(move |i| {
            let angle = std::f64::consts::TAU * i as f64 / ROUND as f64;
            [radius * angle.cos(), radius * angle.sin(), z]
        })
    };
    let ball = |radius: f64, z: f64| {
        (0..=ROUND / 2).flat_map(move |i| {
            let angle = std::f64::consts::PI * i as f64 / (ROUND / 2) as f64;
            circle(radius * angle.sin(), z + radius * angle.cos())
        })
    };
    let own: Vec<Point> = match &solid.form {
        Form::Plane(_) | Form::Field(_) => Vec::new(),
        Form::Ellipsoid(half) => ball(1.0, 0.0).map(|at| std::array::from_fn(|k| half[k] * at[k])).collect(),
        Form::Capsule { radius, half_length } => {
            ball(*radius, -half_length).chain(ball(*radius, *half_length)).collect()
        }
        Form::Cylinder { radius, half_length } => {
            circle(*radius, -half_length).chain(circle(*radius, *half_length)).collect()
        }
        Form::Box(half) => (0..8)
            .map(|corner| std::array::from_fn(|k| if corner >> k & 1 == 0 { -half[k] } else { half[k] }))
            .collect(),
        Form::Mesh(mesh) => mesh.corners().to_vec(),
    };
    let placed =
        |at: Point| std::array::from_fn(|i| solid.at[i] + (0..3).map(|k| at[k] * solid.axes[k][i]).sum::<f64>());
    own.into_iter().map(placed).collect()
}

/// The convex hull of points, counter-clockwise (Andrew's monotone chain).
fn hull(mut points: Vec<Flat>) -> Vec<Flat> {
    points.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
    points.dedup();
    let turns = |a: Flat, b: Flat, c: Flat| (b.0 - a.0) * (c.1 - a.1) - (b.1 - a.1) * (c.0 - a.0) > 0.0;
    let half = |points: &mut dyn Iterator<Item = Flat>| {
        let mut chain: Vec<Flat> = Vec::new();
        for point in points {
            while chain.len() > 1 && !turns(chain[chain.len() - 2], chain[chain.len() - 1], point) {
                chain.pop();
            }
            chain.push(point);
        }
        chain.pop();
        chain
    };
    let mut lower = half(&mut points.iter().copied());
    lower.extend(half(&mut points.iter().rev().copied()));
    lower
}

/// Left, low, right, high.
fn bounds<'p>(points: impl Iterator<Item = &'p Flat>) -> [f64; 4] {
    points.fold([f64::INFINITY, f64::INFINITY, f64::NEG_INFINITY, f64::NEG_INFINITY], |[l, b, r, t], &(x, y)| {
        [l.min(x), b.min(y), r.max(x), t.max(y)]
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_hull_by_hand() {
        let points = vec![(0.0, 0.0), (2.0, 0.0), (1.0, 0.5), (2.0, 2.0), (0.0, 2.0), (1.0, 0.0), (0.0, 0.0)];
        assert_eq!(hull(points), [(0.0, 0.0), (2.0, 0.0), (2.0, 2.0), (0.0, 2.0)]);
    }

    /// A box of 40 × 60 × 200 mm with a ball of 50 mm on it, over a floor.
    #[test]
    fn measures_are_those_of_what_is_no_ground() {
        let solids = vec![
            Solid::new(Form::Plane([0.0; 2]), [0.0; 3], [200; 3]),
            Solid::new(Form::Box([0.02, 0.03, 0.1]), [0.0, 0.0, 0.1], [10, 20, 30]),
            Solid::new(Form::Ellipsoid([0.025; 3]), [0.0, 0.0, 0.225], [40, 50, 60]),
        ];
        let svg = views(&Sight { solids, ..Sight::default() }).unwrap();
        for text in [">50 mm<", ">60 mm<", ">250 mm<", ">from above<"] {
            assert!(svg.contains(text), "{text} is not in {svg}");
        }
        assert_eq!(svg.matches("<polygon").count(), 6);
        assert!(views(&Sight::default()).is_none());
        let floor = vec![Solid::new(Form::Plane([0.0; 2]), [0.0; 3], [200; 3])];
        assert!(views(&Sight { solids: floor, ..Sight::default() }).is_none());
    }
}
