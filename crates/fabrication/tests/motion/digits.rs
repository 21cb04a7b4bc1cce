//! Links, pulleys and palm.

use std::f64::consts::PI;

use hwasp_fabrication::{Workshop, parts};
use hwasp_tasks::hand::{DESIGN_LEN, HandDescription, PAPER_HWASP, SEARCHED};

use crate::sections::{Sections, TOUCH};
use crate::springs;

/// A point of a part that turned by an angle about a joint at `at`, closing: towards negative y.
fn turned_about(at: [f64; 2], angle: f64) -> impl Fn([f64; 2]) -> [f64; 2] {
    let (sin, cos) = angle.sin_cos();
    move |[y, z]| [at[0] + cos * y - sin * z, at[1] + sin * y + cos * z]
}

/// The largest common area of joined parts over 200 poses of every joint.
fn largest(design: &[f64; DESIGN_LEN], poses: &[f64]) -> (f64, String) {
    let hand = HandDescription::default();
    let made = parts(&hand, design, &springs(), &Workshop::default()).unwrap();
    let sections = |name: &str| Sections::of(made.iter().find(|part| part.name == name).unwrap(), 0);
    let palm = sections("palm");
    let mut worst = (0.0, String::new());
    let mut see = |shared: f64, what: String| {
        if shared > worst.0 {
            worst = (shared, what);
        }
    };
    for (digit, name) in [(&hand.thumb, "thumb"), (&hand.fingers[0], "finger"), (&hand.fingers[1], "finger")] {
        let part = |which: &str| sections(&format!("{name}_{which}"));
        let (proximal, distal) = (part("proximal_link"), part("distal_link"));
        let (first, second) = (part("proximal_pulley"), part("distal_pulley"));
        // In the palm's frame the link hangs; a digit that opens along y is turned about z.
        let hung = PI - hand.joint.rest_angle;
        let (of_link, of_pulley) =
            if digit.outward() > 0.0 { (proximal.turned(), first.turned()) } else { (proximal, first) };
        let side = -digit.outward();
        for &angle in poses {
            let place = turned_about([digit.base[1], 0.0], side * (hung + angle));
            see(of_link.shared(&palm, &place, digit.base[0]), format!("{name}_proximal_link and palm at {angle}"));
            if digit.base[0] <= 0.0 {
                let place = turned_about([0.0, digit.proximal.length], angle);
                let own = part_again(&of_link, digit.outward());
                see(distal.shared(&own, &place, 0.0), format!("{name}: links at {angle}"));
                see(second.shared(&own, &place, 0.0), format!("{name}_distal_pulley and proximal link at {angle}"));
                see(
                    of_pulley.shared(&of_link, turned_about([0.0; 2], angle), 0.0),
                    format!("{name}: pulley at {angle}"),
                );
            }
        }
        let place = turned_about([digit.base[1], 0.0], side * hung);
        see(of_pulley.shared(&palm, &place, digit.base[0]), format!("{name}_proximal_pulley and palm"));
        see(second.shared(&distal, |point| point, 0.0), format!("{name}_distal_pulley and its link"));
    }
    worst
}

/// The link in its own frame again.
fn part_again(link: &Sections, outward: f64) -> Sections {
    if outward > 0.0 { link.turned() } else { Sections { heights: link.heights.clone(), sides: link.sides.clone() } }
}

#[test]
fn joined_parts_have_room_in_200_poses() {
    for design in [PAPER_HWASP, SEARCHED] {
        let poses: Vec<f64> = (0..200).map(|pose| 1.57 * f64::from(pose) / 199.0).collect();
        let (area, what) = largest(&design, &poses);
        assert!(area < TOUCH, "{what}: {area} m²");
    }
}

/// Before the open hand every link is inside of its stop, which shows that what is shared is found.
#[test]
fn stops_hold_the_open_hand() {
    let (area, _) = largest(&SEARCHED, &[-0.02]);
    assert!(area > 20.0 * TOUCH, "{area} m²");
}
