//! What is on the palm, with the motor in it, while the spool turns.

use std::f64::consts::TAU;

use hwasp_fabrication::{Workshop, parts};
use hwasp_tasks::hand::{HandDescription, PAPER_HWASP, SEARCHED};

use crate::sections::{Sections, TOUCH};
use crate::springs;

const POSES: u32 = 200;

/// A point of what turns with the motor.
fn turned(angle: f64) -> impl Fn([f64; 2]) -> [f64; 2] {
    let (sin, cos) = angle.sin_cos();
    move |[x, y]| [cos * x - sin * y, sin * x + cos * y]
}

/// The case of the XM430-W210 and its horn, over a hub that ends at this height, m (ROBOTIS' drawing of the X430 series: 28.5 by 46.5 by
/// 34 mm with the horn of 2.5 mm, whose axis is 11.25 mm from an end).
fn motor(horn: f64) -> (Sections, Sections) {
    let case = Sections::of_box([-0.014_25, 0.014_25], [0.011_25 - 0.0465, 0.011_25], [horn + 2.5e-3, horn + 0.034]);
    let corners: Vec<[f64; 2]> = (0..60).map(|i| turned(TAU * f64::from(i) / 60.0)([0.0095, 0.0])).collect();
    let sides = (0..60).map(|i| [corners[i], corners[(i + 1) % 60]]).collect();
    (case, Sections { heights: vec![horn, horn + 2.5e-3], sides: vec![sides] })
}

#[test]
fn the_spool_turns_freely_and_the_motor_has_its_room() {
    for design in [PAPER_HWASP, SEARCHED] {
        let made = parts(&HandDescription::default(), &design, &springs(), &Workshop::default()).unwrap();
        let named =
            |name: &&'static str| (*name, Sections::of(made.iter().find(|part| part.name == *name).unwrap(), 2));
        let still: Vec<_> =
            ["palm", "line_guide", "motor_cage", "flange_plate", "centring_ring"].iter().map(named).collect();
        let turning: Vec<_> = ["spool_drum", "spool_hub"].iter().map(named).collect();
        let (case, horn) = motor(*turning[1].1.heights.last().unwrap());
        let apart = |one: &Sections, other: &Sections, angle: f64, what: &str| {
            let shared = one.shared(other, turned(angle), 0.0);
            assert!(shared < TOUCH, "{what} at {angle} rad: {shared} m²");
        };
        for (i, (name, part)) in still.iter().enumerate() {
            apart(&case, part, 0.0, &format!("motor and {name}"));
            apart(&horn, part, 0.0, &format!("horn and {name}"));
            for (other, beside) in &still[i + 1..] {
                apart(part, beside, 0.0, &format!("{name} and {other}"));
            }
            for pose in 0..POSES {
                let angle = TAU * f64::from(pose) / f64::from(POSES);
                for (other, spool) in &turning {
                    apart(spool, part, angle, &format!("{other} and {name}"));
                }
            }
        }
        apart(&turning[0].1, &turning[1].1, 0.0, "drum and hub");
        for (name, part) in &turning {
            apart(part, &case, 0.0, &format!("{name} and motor"));
        }
    }
}

/// A spool that stood 12 mm to the side would touch what is around it: what is shared is found.
#[test]
fn a_spool_beside_its_place_is_found() {
    let made = parts(&HandDescription::default(), &SEARCHED, &springs(), &Workshop::default()).unwrap();
    let named = |name: &str| Sections::of(made.iter().find(|part| part.name == name).unwrap(), 2);
    let shared = named("spool_drum").shared(&named("line_guide"), |[x, y]| [x + 12e-3, y], 0.0);
    assert!(shared > 20.0 * TOUCH, "{shared} m²");
}
