//! Links: seen along the axle they have the outline of their capsule; in the default workshop they are 23.6 mm wide.

use super::layout::FRAME;
use super::pulley::pins;
use super::{Layout, between, is_distal};
use crate::solid::{Layer, Outline, disc, hole, polygon, rectangle, shaved, slot};
use hwasp_tasks::hand::DESIGN_LEN;
use hwasp_tasks::hand::HandDescription;

/// More than any part is large, m.
const FAR: f64 = 1.0;

/// The link behind the joints of a kind.
pub(super) fn layers(
    hand: &HandDescription,
    design: &[f64; DESIGN_LEN],
    layout: &Layout<'_>,
    kind: usize,
) -> Vec<Layer> {
    let digit = if kind < 2 { &hand.thumb } else { &hand.fingers[0] };
    let distal = is_distal(kind);
    let link = if distal { &digit.distal } else { &digit.proximal };
    let (length, radius) = (link.length, link.radius);
    let setback = layout.setback(radius);
    // Where the whole width is.
    let body = [setback, if distal { length + radius } else { length - setback }];
    let below = rectangle([-FAR, FAR], [-FAR, body[0]]);
    let above = rectangle([-FAR, FAR], [body[1], FAR]);
    let tip = [0.0, length];
    let inner = (radius - FRAME).min(0.5 * (body[1] - body[0]) - FRAME);
    // The pads end where the simulated link does.
    let bare = radius - layout.workshop.pad;
    let window = slot(0.0, [body[0] + FRAME + inner, body[1] - FRAME - inner], inner);
    let (prong, prong_end, cheek) = (layout.prong(), layout.prong_end(), layout.cheek());
    let sides = layout.workshop.sides();

    let pockets = sides.map(|springs| layout.pocket(kind, springs));
    let heights = [layout.channel(), prong, layout.recess(), prong_end, cheek, layout.half_width()];
    let heights =
        heights.into_iter().chain(pockets.into_iter().flatten()).flat_map(|height| [-height, height]).collect();
    let leaning = stop(digit.distal.radius, layout).map(|[y, z]| [y, length + z]);
    between(heights, |x| {
        let (away, side) = (x.abs(), usize::from(x < 0.0));
        let mut add = vec![slot(0.0, [0.0, length], radius)];
        let in_prong = (prong..prong_end).contains(&away);
        let mut cut = vec![window.clone(), shaved(length, bare, body)];
        if !in_prong {
            cut.push(below.clone());
        }
        if !distal && away < cheek {
            cut.push(above.clone());
        }
        if !distal && away < layout.channel() {
            cut.push(channel([design[kind], design[kind + 1]], length, [bare, inner], layout));
        }
        if in_prong {
            cut.push(disc([0.0, 0.0], layout.bore()));
            let in_pocket = pockets[side].is_some_and(|pocket| away > pocket);
            if in_pocket {
                cut.push(disc([0.0, 0.0], layout.pocket_radius(kind)));
            } else if sides[side] > 0 {
                cut.push(hole([0.0, layout.leg_circle(kind)], layout.leg_hole(kind)));
            }
            if distal && x < 0.0 {
                let size = if away > layout.recess() { layout.knot() } else { layout.line_hole() };
                cut.push(line_end(layout.line_end(kind, design[kind]), size, radius - layout.workshop.wall));
                if !in_pocket {
                    cut.extend(pins(layout).map(|pin| disc(pin, layout.pin_hole())));
                }
            }
        }
        if !distal && away > cheek {
            add.push(polygon(&leaning));
            cut.push(disc(tip, layout.bore()));
            if sides[side] > 0 {
                let legs = fixed_legs(kind + 1, layout);
                cut.extend(legs.map(|[y, z]| hole([y, length + z], layout.leg_hole(kind + 1))));
            }
        }
        (add, cut)
    })
}

/// The holes for the legs that do not turn, in the frame that the link behind the joint has with the hand open. Hole 0 is where
/// the other leg is, on the link's axis; the others follow against the direction in which the joint closes.
pub(super) fn fixed_legs(kind: usize, layout: &Layout<'_>) -> impl Iterator<Item = [f64; 2]> {
    let (circle, pitch) = (layout.leg_circle(kind), layout.workshop.hole_pitch);
    (0..layout.workshop.holes()).map(move |hole| {
        let (sin, cos) = (f64::from(hole) * pitch).sin_cos();
        [circle * sin, circle * cos]
    })
}

/// The hole, or the recess of its knot, that a distal line ends in: a prong that goes as far as `edge` has it beyond the axle, seen
/// from the link. Where no wall would be left outside of it, it is open.
fn line_end(away: f64, size: f64, edge: f64) -> Outline {
    if away + size > edge { slot(0.0, [-FAR, -away], size) } else { disc([0.0, -away], size) }
}

/// The stop of the open hand, in the frame of the open link: a part of both cheeks on which the whole width of that link leans,
/// away from the closing side.
pub(super) fn stop(radius: f64, layout: &Layout<'_>) -> [[f64; 2]; 4] {
    let (out, up) = (radius - 0.5 * FRAME, layout.setback(radius));
    [[0.0, 0.0], [out, 0.0], [out, up], [FRAME, up]]
}

/// The line's way from the proximal pulley to the distal one: along the tangent on the closing side. Where less than two walls are
/// left outside of it, it is open; where less than a wall is left to the `window` (half of its width), it opens to that.
fn channel(pulleys: [f64; 2], length: f64, [radius, window]: [f64; 2], layout: &Layout<'_>) -> Vec<[f64; 2]> {
    let (half, wall) = (layout.channel(), layout.workshop.wall);
    let sin = (pulleys[0] - pulleys[1]) / length;
    let normal = [-(1.0 - sin * sin).sqrt(), sin];
    let at = |pulley: usize, off: f64| {
        let reach = pulleys[pulley] + off;
        [normal[0] * reach, normal[1] * reach + if pulley == 0 { 0.0 } else { length }]
    };
    let (mut inner, outer) = ([at(0, -half), at(1, -half)], [at(0, half), at(1, half)]);
    let left = inner.map(|[y, _]| -y - window);
    if left[0].min(left[1]) < wall {
        inner = inner.map(|[y, z]| [y.max(wall - window), z]);
    }
    if pulleys[0].max(pulleys[1]) + half + 2.0 * wall > radius {
        let open = -radius - half;
        return polygon(&[inner[0], inner[1], [open, inner[1][1]], [open, inner[0][1]]]);
    }
    polygon(&[inner[0], inner[1], outer[1], outer[0]])
}
