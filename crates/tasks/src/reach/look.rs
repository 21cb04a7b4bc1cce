//! How the point looks in films: a carriage on a rail, pulled by a cord that the motor's drum winds.

use hwasp_core::{Cord, Form, Sight, Solid};

use crate::paint::{BODY, DESIGN, GOAL, MARK, MOTOR, STAND};

/// The radius of a drum is so many m for a gear of 1.
const DRUM: f64 = 0.09;
/// Where drum and pulley are, m from the middle of the rail.
const END: f64 = 1.45;
/// The upper side of the cord and of the rail, m.
const CORD: f64 = 0.14;
const RAIL: f64 = -0.21;
/// So near to the goal, m, it counts as there.
const THERE: f64 = 0.02;

/// The point at x, m, with this goal, m, and gear.
pub(super) fn sight(x: f64, goal: f64, gear: f64) -> Sight {
    let drum = DRUM * gear;
    let pulley = DRUM;
    let disk = |x: f64, radius: f64| {
        let z = CORD - radius;
        Solid::cylinder([[x, -0.04, z], [x, 0.04, z]], radius, if x < 0.0 { DESIGN } else { STAND })
    };
    let (sin, cos) = (x / drum).sin_cos();
    let centre = [-END, -0.06, CORD - drum];
    let spoke = [0.0, 0.8].map(|share| [centre[0] + share * drum * sin, centre[1], centre[2] + share * drum * cos]);
    let cord = [[-END, 0.0, CORD], [END, 0.0, CORD], [END, 0.0, CORD - 2.0 * pulley], [-END, 0.0, CORD - 2.0 * drum]];
    let off = x - goal;
    Sight {
        solids: vec![
            Solid::new(Form::Box([1.2, 0.08, 0.03]), [0.0, 0.0, RAIL - 0.03], STAND).fixed(),
            Solid::rod([[goal, 0.2, RAIL], [goal, 0.2, 0.5]], 0.02, GOAL).fixed(),
            Solid::new(Form::Box([0.18, 0.12, 0.19]), [x, 0.0, RAIL + 0.19], BODY),
            Solid::new(Form::Box([0.1, 0.12, 0.1]), [-END, 0.18, CORD - drum], MOTOR).fixed(),
            disk(-END, drum),
            disk(END, pulley),
            Solid::rod(spoke, 0.012, MOTOR),
        ],
        cords: vec![Cord::new(cord.to_vec(), MARK)],
        about: format!("gear {gear:.2}"),
        told: format!("{:.0} mm from the goal", 1e3 * off.abs()),
        moments: if off.abs() < THERE { vec!["at the goal"] } else { vec![] },
    }
}
