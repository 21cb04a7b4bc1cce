//! Parts that are joined have room at every angle: sections of their meshes, laid over each other in 200 poses.

#![allow(clippy::unwrap_used)] // a panic is how a test fails

use std::f64::consts::PI;

use hwasp_fabrication::{Axis, Part, SeatedSpring, Workshop, parts};
use hwasp_tasks::hand::{DESIGN_LEN, HandDescription, PAPER_HWASP, SEARCHED};

/// Between the rows of points that are held against both, m.
const PITCH: f64 = 2e-4;
/// What two parts may have in common in a section, m²: parts that lean on each other touch.
const TOUCH: f64 = 2e-8;

/// The sections of a part that is a stack along x, by height.
struct Sections {
    heights: Vec<f64>,
    /// The sides of each section.
    sides: Vec<Vec<[[f64; 2]; 2]>>,
}

impl Sections {
    fn of(part: &Part) -> Self {
        assert_eq!(part.axis, Axis::X, "{}", part.name);
        let mut heights: Vec<f64> = part.mesh.triangles().flatten().map(|corner| corner[0]).collect();
        heights.sort_by(f64::total_cmp);
        heights.dedup_by(|a, b| (*a - *b).abs() < 1e-9);
        let sides = heights.windows(2).map(|pair| section(part, 0.5 * (pair[0] + pair[1]))).collect();
        Self { heights, sides }
    }

    /// Mirrored in x and y, as a digit is that opens along y.
    fn turned(&self) -> Self {
        let flip = |side: &[[f64; 2]; 2]| side.map(|[y, z]| [-y, z]);
        Self {
            heights: self.heights.iter().rev().map(|x| -x).collect(),
            sides: self.sides.iter().rev().map(|sides| sides.iter().map(flip).collect()).collect(),
        }
    }

    /// The largest area that the sections of both have in common, m², where this one is put at `place` and `angle` and `across`.
    fn shared(&self, other: &Self, place: impl Fn([f64; 2]) -> [f64; 2], across: f64) -> f64 {
        let mut largest = 0.0;
        for (i, pair) in self.heights.windows(2).enumerate() {
            let moved: Vec<[[f64; 2]; 2]> = self.sides[i].iter().map(|side| side.map(&place)).collect();
            for (k, beyond) in other.heights.windows(2).enumerate() {
                let common = (pair[1] + across).min(beyond[1]) - (pair[0] + across).max(beyond[0]);
                if common > 1e-9 {
                    largest = f64::max(largest, area(&moved, &other.sides[k]));
                }
            }
        }
        largest
    }
}

/// The sides of the section at a height.
fn section(part: &Part, x: f64) -> Vec<[[f64; 2]; 2]> {
    let cross = |corners: [[f64; 3]; 3]| {
        let points: Vec<[f64; 2]> = (0..3)
            .filter_map(|i| {
                let ([ax, ay, az], [bx, by, bz]) = (corners[i], corners[(i + 1) % 3]);
                let at = (x - ax) / (bx - ax);
                ((ax > x) != (bx > x)).then_some([ay + at * (by - ay), az + at * (bz - az)])
            })
            .collect();
        <[[f64; 2]; 2]>::try_from(points).ok()
    };
    part.mesh.triangles().filter_map(cross).collect()
}

/// The area that is inside of both, m², by rows.
fn area(one: &[[[f64; 2]; 2]], other: &[[[f64; 2]; 2]]) -> f64 {
    let span = |sides: &[[[f64; 2]; 2]]| {
        let zs = sides.iter().flatten().map(|point| point[1]);
        [zs.clone().fold(f64::INFINITY, f64::min), zs.fold(f64::NEG_INFINITY, f64::max)]
    };
    let (a, b) = (span(one), span(other));
    let (low, high) = (a[0].max(b[0]), a[1].min(b[1]));
    let rows = ((high - low) / PITCH).max(0.0) as u32;
    let inside = |sides: &[[[f64; 2]; 2]], z: f64| {
        let mut crossings: Vec<f64> = (sides.iter())
            .filter(|[from, to]| (from[1] > z) != (to[1] > z))
            .map(|[from, to]| from[0] + (to[0] - from[0]) * (z - from[1]) / (to[1] - from[1]))
            .collect();
        crossings.sort_by(f64::total_cmp);
        crossings
    };
    let common = |row: u32| -> f64 {
        let z = low + (f64::from(row) + 0.5) * PITCH;
        let (mine, theirs) = (inside(one, z), inside(other, z));
        let pairs = mine.chunks_exact(2).flat_map(|m| theirs.chunks_exact(2).map(move |t| (m, t)));
        pairs.map(|(m, t)| (m[1].min(t[1]) - m[0].max(t[0])).max(0.0)).sum()
    };
    (0..rows).map(|row| PITCH * common(row)).sum()
}

/// A point of a part that turned by an angle about a joint at `at`, closing: towards negative y.
fn turned_about(at: [f64; 2], angle: f64) -> impl Fn([f64; 2]) -> [f64; 2] {
    let (sin, cos) = angle.sin_cos();
    move |[y, z]| [at[0] + cos * y - sin * z, at[1] + sin * y + cos * z]
}

fn springs() -> [SeatedSpring; 4] {
    [(0.38e-3, 5.26e-3, 2.60e-3), (0.36e-3, 6.72e-3, 2.45e-3), (0.45e-3, 6.90e-3, 3.17e-3), (0.38e-3, 6.76e-3, 3.07e-3)]
        .map(|(wire, outer, length)| SeatedSpring { wire, outer, length })
}

/// The largest common area of joined parts over 200 poses of every joint.
fn largest(design: &[f64; DESIGN_LEN], poses: &[f64]) -> (f64, String) {
    let hand = HandDescription::default();
    let made = parts(&hand, design, &springs(), &Workshop::default()).unwrap();
    let sections = |name: &str| Sections::of(made.iter().find(|part| part.name == name).unwrap());
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
