//! The palm: its box, hollowed, with a pocket and two lugs for each digit, a way for each line, and what is screwed on it.

use hwasp_tasks::hand::{DESIGN_LEN, FingerDescription, HandDescription};

use super::link::{fixed_legs, stop};
use super::mount::{CLIP_ROOM, NUT, NUT_UNDER, POSTS, SCREW, WELL};
use super::{Layout, between};
use crate::solid::{Layer, Outline, disc, hole, polygon, rectangle};

/// Between the palm's outside and its hollows, and between these and pockets, m.
const SKIN: f64 = 3e-3;
/// More than any part is large, m.
const FAR: f64 = 1.0;

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
    let hollows = hollows(hand, layout);
    let of_hollows = hollows.iter().flat_map(|hollow| hollow.x.into_iter().flat_map(|x| [-x, x]));
    let heights = heights.chain(of_hollows).filter(|x| x.abs() < half_x).chain([-half_x, half_x]);
    between(heights.collect(), |x| {
        let (mut add, mut cut) = (vec![body.clone()], Vec::new());
        cut.extend(hollows.iter().filter(|hollow| hollow.has(x)).map(|hollow| rectangle(hollow.y, hollow.z)));
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

/// A part of the palm that is left out, on both sides of its middle: a block.
pub(super) struct Hollow {
    /// Between these distances from the middle.
    pub(super) x: [f64; 2],
    pub(super) y: [f64; 2],
    pub(super) z: [f64; 2],
}

impl Hollow {
    fn has(&self, x: f64) -> bool {
        (self.x[0]..self.x[1]).contains(&x.abs())
    }
}

/// What saves weight, and what lets a hand and a screwdriver in: the well to the spool, troughs beside lugs through which axles and
/// clips go in, screws and their square nuts.
pub(super) fn hollows(hand: &HandDescription, layout: &Layout<'_>) -> Vec<Hollow> {
    let [half_x, half_y, half_z] = hand.palm.half_size;
    let (top, bottom) = (2.0 * half_z, 0.0);
    let hollow = |x: [f64; 2], y: [f64; 2], z: [f64; 2]| Hollow { x, y, z };
    // Pockets of the digits, on the sides of thumb and fingers.
    let inward = layout.reach(hand, hand.joint.range[1] - hand.joint.rest_angle);
    let (thumb, finger) = (hand.thumb.base, hand.fingers[0].base);
    let inside = [thumb[1] + inward, finger[1] - inward];
    let lugs = layout.half_width();
    // Beside the thumb's lugs, and between those of the fingers.
    let (beside, gap) = (lugs + SKIN, finger[0] - lugs - SKIN);
    let posts = POSTS[0] - 0.5 * NUT[0] - SKIN;
    let cells = [SKIN, top - SKIN];
    // Above the troughs.
    let low = CLIP_ROOM + SKIN;
    let mut hollows = vec![
        hollow([0.0, WELL], [-WELL, WELL], [-FAR, FAR]),
        hollow([0.0, beside], [inside[0] + SKIN, inside[1] - SKIN], cells),
        hollow([beside, posts], [inside[0], inside[1] - SKIN], cells),
        hollow([beside, half_x], [-half_y + SKIN, inside[0]], [low, top - SKIN]),
        hollow([0.0, gap], [inside[1] - SKIN, half_y - SKIN], [low, top - SKIN]),
        hollow([lugs, half_x], [thumb[1] - CLIP_ROOM, thumb[1] + CLIP_ROOM], [-FAR, CLIP_ROOM]),
        hollow([0.0, finger[0] - lugs], [finger[1] - CLIP_ROOM, finger[1] + CLIP_ROOM], [-FAR, CLIP_ROOM]),
    ];
    for side in [-1.0, 1.0] {
        let (screw, nut) = (0.5 * SCREW, 0.5 * NUT[0]);
        let y = side * POSTS[1];
        let under = top - NUT_UNDER;
        hollows.push(hollow([POSTS[0] - screw, POSTS[0] + screw], [y - screw, y + screw], [bottom + SKIN, FAR]));
        hollows.push(hollow([POSTS[0] - nut, half_x], [y - nut, y + nut], [under - NUT[1], under]));
    }
    hollows
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
