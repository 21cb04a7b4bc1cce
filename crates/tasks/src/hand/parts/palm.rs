//! The palm: its box, with a pocket and two lugs for each digit, and a way for its line.

use super::super::description::{FingerDescription, HandDescription};
use super::super::solid::{Layer, Outline, disc, polygon, rectangle};
use super::super::space::DESIGN_LEN;
use super::link::{fixed_leg, stop};
use super::{Stock, between};

pub(super) fn layers(hand: &HandDescription, design: &[f64; DESIGN_LEN], stock: &Stock) -> Vec<Layer> {
    let [half_x, half_y, half_z] = hand.palm.half_size;
    let body = rectangle([-half_y, half_y], [0.0, 2.0 * half_z]);
    let digits = || hand.digits().into_iter().zip([0, 2, 2]);
    let heights = digits().flat_map(|(digit, _)| {
        [stock.channel(), stock.cheek(), stock.half_width()]
            .into_iter()
            .flat_map(|height| [digit.base[0] - height, digit.base[0] + height])
    });
    between(heights.chain([-half_x, half_x]).collect(), |x| {
        let (mut add, mut cut) = (vec![body.clone()], Vec::new());
        for (digit, kind) in digits() {
            let (outward, from_digit) = (digit.outward(), x - digit.base[0]);
            let away = from_digit.abs();
            if away < stock.channel() {
                cut.push(shaft(digit, design[kind], hand, stock));
            }
            if away < stock.cheek() {
                cut.push(pocket(digit, hand, stock));
            } else if away < stock.half_width() {
                let centre = [digit.base[1], 0.0];
                let (sin, cos) = hand.joint.rest_angle.sin_cos();
                // From the frame of the open link.
                let placed = |[y, z]: [f64; 2]| [centre[0] + outward * (cos * y + sin * z), sin * y - cos * z];
                add.push(disc(centre, stock.lug()));
                add.push(polygon(&stop(digit.proximal.radius, stock).map(placed)));
                cut.push(disc(centre, stock.bore()));
                // The link's x axis points along -x for digits that open along y.
                if from_digit * outward < 0.0 {
                    cut.push(disc(placed(fixed_leg(design[8 + kind], stock)), stock.leg_hole()));
                }
            }
        }
        (add, cut)
    })
}

/// What the proximal link and its pulley swing in.
fn pocket(digit: &FingerDescription, hand: &HandDescription, stock: &Stock) -> Outline {
    let reach = |tilt: f64| digit.outward() * stock.reach(hand, tilt);
    let (open, closed) = (reach(hand.joint.rest_angle), -reach(hand.joint.range[1] - hand.joint.rest_angle));
    let y = digit.base[1];
    rectangle([y + open.min(closed), y + open.max(closed)], [-stock.lug(), stock.setback(digit.proximal.radius)])
}

/// The line's way up, from the closing side of the pulley through the roof of the pocket.
fn shaft(digit: &FingerDescription, radius: f64, hand: &HandDescription, stock: &Stock) -> Outline {
    let (y, half) = (digit.base[1] - digit.outward() * radius, stock.channel());
    rectangle([y - half, y + half], [0.0, 2.0 * hand.palm.half_size[2] + half])
}
