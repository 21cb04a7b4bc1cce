//! The cage around the motor, the plate between it and the robot's flange, and the ring that centres the plate.

use std::f64::consts::FRAC_1_SQRT_2;

use hwasp_tasks::hand::HandDescription;

use super::guide::screws;
use super::mount::{
    CENTRING, FLANGE_CIRCLE, FLANGE_PIN, FOOT, Levels, M6, M6_HEAD, MOTOR, MOTOR_AXIS, NUT, POSTS, SCREW,
};
use super::spool::HUB_RADIUS;
use super::{Layout, between};
use crate::solid::{Layer, Outline, disc, rectangle};

/// Walls of the cage, m.
const WALL: f64 = 3e-3;
/// More than any part is large, m.
const FAR: f64 = 0.2;
/// Of the flange plate and of the hole in the ring, m.
const PLATE_RADIUS: f64 = 0.033;
const RING_HOLE: f64 = 0.010;
/// How deep the ring sits in the plate, and how far it stands out, m.
const RING: f64 = 3e-3;
/// From the ends of the motor to the screws that hold the flange plate, m.
const FROM_END: f64 = 7e-3;

/// Half the width of the motor's room, and its ends: the motor's axis is in the middle of the hand, its case towards the thumb.
fn room(layout: &Layout<'_>) -> (f64, [f64; 2]) {
    let play = 0.75 * layout.workshop.print_clearance;
    (0.5 * MOTOR[0] + play, [MOTOR_AXIS - MOTOR[1] - play, MOTOR_AXIS + play])
}

/// Where the screws through the cage are, along y.
fn side_screws(layout: &Layout<'_>) -> [f64; 2] {
    let (_, ends) = room(layout);
    [ends[0] + FROM_END, ends[1] - FROM_END]
}

pub(super) fn cage(hand: &HandDescription, layout: &Layout<'_>) -> Vec<Layer> {
    let levels = Levels::new(hand, layout);
    let (half, ends) = room(layout);
    let outside = rectangle([-half - WALL, half + WALL], [ends[0] - WALL, ends[1] + WALL]);
    let [post_x, post_y] = POSTS;
    let feet = rectangle([-post_x - 5e-3, post_x + 5e-3], [-post_y - 5e-3, post_y + 5e-3]);
    let foot = levels.guide + FOOT;
    let windows = [levels.case + 6e-3, levels.tongue - 6e-3];
    let middle = 0.5 * (levels.tongue + levels.cage);
    let screw = 0.5 * SCREW;
    let heights =
        vec![levels.guide, foot, levels.case, windows[0], windows[1], middle - screw, middle + screw, levels.cage];
    between(heights, |z| {
        let mut add = vec![outside.clone()];
        let mut cut = Vec::new();
        if z < foot {
            add.push(feet.clone());
            cut.extend(screws());
        }
        if z < levels.case {
            cut.push(disc([0.0; 2], HUB_RADIUS + 1e-3));
            // What is under the motor's far end.
            cut.push(rectangle([-half + WALL, half - WALL], [ends[0] + WALL, -HUB_RADIUS - 1e-3 - WALL]));
        } else {
            cut.push(rectangle([-half, half], ends));
        }
        if (windows[0]..windows[1]).contains(&z) {
            cut.push(rectangle([-FAR, FAR], [ends[0] + FROM_END, ends[1] - FROM_END]));
            // The cables' way.
            cut.push(rectangle([-half + 5e-3, half - 5e-3], [-FAR, ends[0] + FROM_END]));
        }
        if (z - middle).abs() < screw {
            cut.extend(side_screws(layout).map(|y| rectangle([-FAR, FAR], [y - screw, y + screw])));
        }
        (add, cut)
    })
}

/// The plate on the robot's flange; its tongue presses on the motor and is screwed to the cage from the sides.
pub(super) fn plate(hand: &HandDescription, layout: &Layout<'_>) -> Vec<Layer> {
    let levels = Levels::new(hand, layout);
    let (half, ends) = room(layout);
    let play = layout.workshop.print_clearance;
    let tongue = rectangle([-half + play, half - play], [ends[0] + play, ends[1] - play]);
    let middle = 0.5 * (levels.tongue + levels.cage);
    let (screw, nut) = (0.5 * SCREW, 0.5 * NUT[0]);
    let heads = levels.cage + 6.2e-3;
    let ring = levels.plate - RING;
    let pin = levels.plate - 6.5e-3;
    let heights =
        vec![levels.tongue, middle - screw, middle + screw, middle + nut, levels.cage, heads, pin, ring, levels.plate];
    let corner = FLANGE_CIRCLE * FRAC_1_SQRT_2;
    let m6 = |radius: f64| {
        [-1.0, 1.0].into_iter().flat_map(move |x| [-1.0, 1.0].map(move |y| disc([x * corner, y * corner], radius)))
    };
    between(heights, |z| {
        let mut cut: Vec<Outline> = m6(if z < heads { M6_HEAD } else { M6 }).collect();
        if z > pin {
            cut.push(disc([0.0, FLANGE_CIRCLE], FLANGE_PIN));
        }
        if z > ring {
            cut.push(disc([0.0; 2], CENTRING + 0.5 * layout.workshop.print_clearance));
        }
        if z < levels.cage {
            for y in side_screws(layout) {
                if (z - middle).abs() < screw {
                    cut.push(rectangle([-FAR, FAR], [y - screw, y + screw]));
                }
                if z < middle + nut {
                    for side in [-1.0, 1.0] {
                        let inner = side * (half - play - 2.0e-3 - NUT[1]);
                        let outer = side * (half - play - 2.0e-3);
                        cut.push(rectangle([inner.min(outer), inner.max(outer)], [y - nut, y + nut]));
                    }
                }
            }
            // Between the nuts.
            let hollow = half - play - 2.0e-3 - NUT[1] - 2.0 * WALL;
            let [from, to] = side_screws(layout);
            cut.push(rectangle([-hollow, hollow], [from + screw + WALL, to - screw - WALL]));
        }
        let body = if z < levels.cage { tongue.clone() } else { disc([0.0; 2], PLATE_RADIUS) };
        (vec![body], cut)
    })
}

/// What centres the plate: in a recess of it and in that of the robot's flange.
pub(super) fn ring(hand: &HandDescription, layout: &Layout<'_>) -> Vec<Layer> {
    let top = Levels::new(hand, layout).plate;
    between(vec![top - RING, top + RING], |_| (vec![disc([0.0; 2], CENTRING)], vec![disc([0.0; 2], RING_HOLE)]))
}
