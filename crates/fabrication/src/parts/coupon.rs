//! The test coupon: a plate with the holes, walls and seats of the hand.

use super::mount::{FLANGE_PIN, NUT, SCREW, TURN_PIN};
use super::spool::horn_screws;
use super::{Layout, between};
use crate::solid::{Layer, Outline, disc, hole, rectangle};

/// Half of the plate, its thickness and the height of what stands on it, m.
const HALF: [f64; 2] = [0.032, 0.019];
const PLATE: f64 = 3e-3;
const HIGH: f64 = 9e-3;
/// Between neighbouring holes, m.
const PITCH: f64 = 7e-3;
/// What the bores of the row are wider than those of the hand, m in diameter.
const WIDER: [f64; 5] = [-0.1e-3, 0.0, 0.1e-3, 0.2e-3, 0.3e-3];

/// From low y to high: the horn's circle, square hole and nut seat, seats of pins; holes for legs; axle bores from narrow to wide. On the
/// plate stand walls of one, one and a half and two times the thinnest, and two ribs a print clearance apart.
pub(super) fn layers(layout: &Layout<'_>) -> Vec<Layer> {
    let at = |column: i32, row: f64| [f64::from(column) * PITCH, row];
    let workshop = layout.workshop;
    let wall = workshop.wall;
    between(vec![0.0, PLATE - 1e-3, PLATE, HIGH], |z| {
        if z > PLATE {
            let ribs = [1.0, 1.5, 2.0].map(|times| wall * times);
            let mut add: Vec<Outline> = (ribs.into_iter().zip([-0.028, -0.022, -0.016]))
                .map(|(thick, x)| rectangle([x, x + thick], [-0.016, -0.004]))
                .collect();
            let gap = 0.5 * workshop.print_clearance;
            for side in [-1.0, 1.0] {
                let (near, far) = (0.022 + side * gap, 0.022 + side * (gap + 2e-3));
                add.push(rectangle([near.min(far), near.max(far)], [-0.016, -0.004]));
            }
            return (add, vec![]);
        }
        let mut cut: Vec<Outline> = horn_screws(0.5 * 2.4e-3).map(|screw| shifted(&screw, [0.0, -7e-3])).collect();
        for (column, wider) in (-2..).zip(WIDER) {
            cut.push(disc(at(column, 0.014), layout.bore() + 0.5 * wider));
        }
        for (column, kind) in (-2..).zip(0..4) {
            cut.push(hole(at(column, 0.007), layout.leg_hole(kind)));
        }
        cut.push(disc(at(2, 0.007), layout.pin_hole()));
        cut.push(disc(at(3, 0.007), FLANGE_PIN));
        cut.push(rectangle([0.0215 - 0.5 * SCREW, 0.0215 + 0.5 * SCREW].map(|x| x + 7e-3), [0.012, 0.012 + SCREW]));
        if z > PLATE - 1e-3 {
            // Seats that are not deep: of a square nut, and of a pin that turns a line.
            cut.push(rectangle([-0.029, -0.029 + NUT[0]], [0.004, 0.004 + NUT[0]]));
            cut.push(rectangle([-0.029, -0.029 + 2.0 * TURN_PIN[1]], [0.0125, 0.0125 + 2.0 * TURN_PIN[0] + 1e-4]));
        }
        (vec![rectangle([-HALF[0], HALF[0]], [-HALF[1], HALF[1]])], cut)
    })
}

fn shifted(outline: &Outline, by: [f64; 2]) -> Outline {
    outline.iter().map(|corner| [corner[0] + by[0], corner[1] + by[1]]).collect()
}
