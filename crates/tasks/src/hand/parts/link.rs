//! Links: seen along the shaft they have the outline of their capsule; with the default stock they are 22 mm wide.

use super::super::description::HandDescription;
use super::super::solid::{Layer, disc, polygon, rectangle, slot};
use super::super::space::DESIGN_LEN;
use super::pulley::pins;
use super::stock::{FRAME, Stock};
use super::{between, is_distal};

/// More than any part is large, m.
const FAR: f64 = 1.0;

/// The link behind the joints of a kind.
pub(super) fn layers(hand: &HandDescription, design: &[f64; DESIGN_LEN], stock: &Stock, kind: usize) -> Vec<Layer> {
    let digit = if kind < 2 { &hand.thumb } else { &hand.fingers[0] };
    let distal = is_distal(kind);
    let link = if distal { &digit.distal } else { &digit.proximal };
    let (length, radius) = (link.length, link.radius);
    let setback = stock.setback(radius);
    // Where the whole width is.
    let body = [setback, if distal { length + radius } else { length - setback }];
    let below = rectangle([-FAR, FAR], [-FAR, body[0]]);
    let above = rectangle([-FAR, FAR], [body[1], FAR]);
    let (bore, tip) = (disc([0.0, 0.0], stock.bore()), [0.0, length]);
    let inner = (radius - FRAME).min(0.5 * (body[1] - body[0]) - FRAME);
    let window = slot(0.0, [body[0] + FRAME + inner, body[1] - FRAME - inner], inner);
    let (prong, prong_end, cheek) = (stock.prong(), stock.prong_end(), stock.cheek());

    let heights = [stock.channel(), prong, stock.pocket(), prong_end, cheek, stock.half_width()];
    let heights = heights.into_iter().flat_map(|height| [-height, height]).collect();
    let leaning = stop(digit.distal.radius, stock).map(|[y, z]| [y, length + z]);
    between(heights, |x| {
        let away = x.abs();
        let mut add = vec![slot(0.0, [0.0, length], radius)];
        let in_prong = (prong..prong_end).contains(&away);
        let mut cut = vec![window.clone()];
        if !in_prong {
            cut.push(below.clone());
        }
        if !distal && away < cheek {
            cut.push(above.clone());
        }
        if !distal && away < stock.channel() {
            cut.push(channel([design[kind], design[kind + 1]], length, radius, stock));
        }
        if in_prong {
            cut.push(bore.clone());
            let pocket = away > stock.pocket();
            if x > 0.0 {
                cut.push(if pocket {
                    disc([0.0, 0.0], stock.pocket_radius())
                } else {
                    disc([0.0, stock.leg_circle()], stock.leg_hole())
                });
            } else if distal {
                cut.extend(pins(stock).map(|pin| disc(pin, stock.leg_hole())));
                let end = [0.0, stock.line_end(design[kind])];
                cut.push(disc(end, if pocket { stock.knot() } else { stock.line_hole() }));
            }
        }
        if !distal && away > cheek {
            add.push(polygon(&leaning));
            cut.push(disc(tip, stock.bore()));
            if x > 0.0 {
                let [y, z] = fixed_leg(design[8 + kind + 1], stock);
                cut.push(disc([y, length + z], stock.leg_hole()));
            }
        }
        (add, cut)
    })
}

/// Where the leg that does not turn is, in the frame that the link behind the joint has with the hand open: from the other
/// leg, on the link's axis, back by the preload.
pub(super) fn fixed_leg(preload: f64, stock: &Stock) -> [f64; 2] {
    let (sin, cos) = (std::f64::consts::FRAC_PI_2 - preload).sin_cos();
    [stock.leg_circle() * cos, stock.leg_circle() * sin]
}

/// The stop of the open hand, in the frame of the open link: a part of both cheeks on which the whole width of that link leans,
/// away from the closing side.
pub(super) fn stop(radius: f64, stock: &Stock) -> [[f64; 2]; 4] {
    let (out, up) = (radius - 0.5 * FRAME, stock.setback(radius));
    [[0.0, 0.0], [out, 0.0], [out, up], [FRAME, up]]
}

/// The line's way from the proximal pulley to the distal one: along the tangent on the closing side. Where less than two walls are
/// left outside of it, it is open.
fn channel(pulleys: [f64; 2], length: f64, radius: f64, stock: &Stock) -> Vec<[f64; 2]> {
    let half = stock.channel();
    let sin = (pulleys[0] - pulleys[1]) / length;
    let normal = [-(1.0 - sin * sin).sqrt(), sin];
    let at = |pulley: usize, off: f64| {
        let reach = pulleys[pulley] + off;
        [normal[0] * reach, normal[1] * reach + if pulley == 0 { 0.0 } else { length }]
    };
    let (inner, outer) = ([at(0, -half), at(1, -half)], [at(0, half), at(1, half)]);
    if pulleys[0].max(pulleys[1]) + half + 2.0 * stock.wall > radius {
        let open = -radius - half;
        return polygon(&[inner[0], inner[1], [open, inner[1][1]], [open, inner[0][1]]]);
    }
    polygon(&[inner[0], inner[1], outer[1], outer[0]])
}
