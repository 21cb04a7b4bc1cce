//! The palm: its box, with a pocket and two lugs for each digit, and a way for its line.

use super::super::description::{FingerDescription, HandDescription};
use super::super::solid::{Layer, Outline, disc, hole, polygon, rectangle};
use super::super::space::DESIGN_LEN;
use super::link::{fixed_legs, stop};
use super::{Layout, between};

pub(super) fn layers(hand: &HandDescription, design: &[f64; DESIGN_LEN], layout: &Layout<'_>) -> Vec<Layer> {
    let [half_x, half_y, half_z] = hand.palm.half_size;
    let body = rectangle([-half_y, half_y], [0.0, 2.0 * half_z]);
    let digits = || hand.digits().into_iter().zip([0, 2, 2]);
    // Where a lug ends on a side: at the side of the palm, where less than a wall would be left to that.
    let end = |digit: &FingerDescription, side: f64| {
        let rest = half_x - side * digit.base[0] - layout.half_width();
        layout.half_width() + if rest < layout.workshop.wall { rest } else { 0.0 }
    };
    let heights = digits().flat_map(|(digit, _)| {
        [-1.0, 1.0].into_iter().flat_map(move |side| {
            [layout.channel(), layout.cheek(), end(digit, side)].map(|height| digit.base[0] + side * height)
        })
    });
    between(heights.chain([-half_x, half_x]).collect(), |x| {
        let (mut add, mut cut) = (vec![body.clone()], Vec::new());
        for (digit, kind) in digits() {
            let (outward, from_digit) = (digit.outward(), x - digit.base[0]);
            let away = from_digit.abs();
            if away < layout.channel() {
                cut.push(shaft(digit, design[kind], hand, layout));
            }
            if away < layout.cheek() {
                cut.push(pocket(digit, hand, layout));
            } else if away < end(digit, from_digit.signum()) {
                let centre = [digit.base[1], 0.0];
                let (sin, cos) = hand.joint.rest_angle.sin_cos();
                // From the frame of the open link.
                let placed = |[y, z]: [f64; 2]| [centre[0] + outward * (cos * y + sin * z), sin * y - cos * z];
                add.push(disc(centre, layout.lug()));
                add.push(polygon(&stop(digit.proximal.radius, layout).map(placed)));
                cut.push(disc(centre, layout.bore()));
                // The link's x axis points along -x for digits that open along y.
                let springs = layout.workshop.sides()[usize::from(from_digit * outward > 0.0)];
                if springs > 0 {
                    cut.extend(fixed_legs(kind, layout).map(|leg| hole(placed(leg), layout.leg_hole(kind))));
                }
            }
        }
        (add, cut)
    })
}

/// What the proximal link and its pulley swing in.
fn pocket(digit: &FingerDescription, hand: &HandDescription, layout: &Layout<'_>) -> Outline {
    let reach = |tilt: f64| digit.outward() * layout.reach(hand, tilt);
    let (open, closed) = (reach(hand.joint.rest_angle), -reach(hand.joint.range[1] - hand.joint.rest_angle));
    let y = digit.base[1];
    rectangle([y + open.min(closed), y + open.max(closed)], [-layout.lug(), layout.setback(digit.proximal.radius)])
}

/// The line's way up, from the closing side of the pulley through the roof of the pocket; with room on both sides, for it may come
/// down at a slant.
fn shaft(digit: &FingerDescription, radius: f64, hand: &HandDescription, layout: &Layout<'_>) -> Outline {
    let y = digit.base[1] - digit.outward() * radius;
    let half = layout.channel() + layout.workshop.print_clearance;
    rectangle([y - half, y + half], [0.0, 2.0 * hand.palm.half_size[2] + half])
}
