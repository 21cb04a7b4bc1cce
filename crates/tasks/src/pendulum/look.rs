//! How the rod looks in films: on a stand, with the wheel of its gear behind it and that of the motor below.

use hwasp_core::{Form, Sight, Solid};

use super::{LENGTH, wrapped};
use crate::paint::{BODY, DESIGN, DESIGN_TOO, MARK, MOTOR, STAND};

/// Between the axles of the two wheels, m.
const APART: f64 = 0.36;
/// So near to upright, rad, it counts as there.
const THERE: f64 = 0.1;

/// The rod at this angle, rad from upright and counter-clockwise, behind this gear.
pub(super) fn sight(angle: f64, gear: f64) -> Sight {
    let tip = [-LENGTH * angle.sin(), 0.0, LENGTH * angle.cos()];
    // Their radii are as the torques.
    let (wheel, pinion) = (APART * gear / (1.0 + gear), APART / (1.0 + gear));
    let across = |z: f64, from: f64, to: f64| [[0.0, from, z], [0.0, to, z]];
    // It turns the other way.
    let (sin, cos) = (gear * angle).sin_cos();
    let mark = [0.15, 0.85].map(|share| [share * pinion * sin, 0.05, share * pinion * cos - APART]);
    let off = wrapped(angle);
    Sight {
        solids: vec![
            Solid::new(Form::Plane([0.0; 2]), [0.0, 0.0, -1.2 * LENGTH], STAND).fixed(),
            Solid::new(Form::Box([0.05, 0.04, 0.66 * LENGTH]), [0.0, 0.2, -0.54 * LENGTH], STAND).fixed(),
            Solid::cylinder(across(-APART, 0.1, 0.3), 0.09, MOTOR).fixed(),
            Solid::cylinder(across(0.0, 0.06, 0.1), wheel, DESIGN),
            Solid::cylinder(across(-APART, 0.06, 0.1), pinion, DESIGN_TOO),
            Solid::rod(mark, 0.015, MOTOR),
            Solid::rod([[0.0; 3], tip], 0.055, BODY),
            Solid::cylinder(across(0.0, -0.075, 0.2), 0.03, MARK).fixed(),
        ],
        about: format!("gear {gear:.2}"),
        told: format!("{:.0}° from upright", off.abs().to_degrees()),
        moments: if off.abs() < THERE { vec!["upright"] } else { vec![] },
        ..Sight::default()
    }
}
