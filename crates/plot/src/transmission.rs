//! The transmission of a hand, drawn to scale: links, pulleys as large as they are designed, and the ways of the tendons.

use hwasp_tasks::hand::{DESIGN_LEN, FingerDescription, HandDescription};

use crate::panel::{GREY, INK, colour};
use crate::svg::{Anchor, Svg};

/// Pixels of a millimetre, and the text.
const SCALE: f64 = 2.6;
const TEXT: f64 = 11.0;
/// Room for the figures of a joint beside a digit, and above the palm, px.
const ASIDE: f64 = 128.0;
const ABOVE: f64 = 26.0;
/// The scale below, mm.
const RULER: f64 = 20.0;
const LINK: &str = "stroke=\"#e6e6e6\" stroke-linecap=\"round\"";

type Point = (f64, f64);

/// One digit in the plane in which it closes, mm: y to the right, z up.
struct Digit {
    /// Which way it opens: 1 or -1.
    outward: f64,
    joints: [Point; 2],
    tip: Point,
    /// Radius of the links, of their pulleys.
    thick: f64,
    pulleys: [f64; 2],
    /// Its place among the kinds of joints: 0 the thumb, 2 a finger.
    kind: usize,
}

impl Digit {
    /// Open.
    fn new(hand: &HandDescription, digit: &FingerDescription, design: &[f64; DESIGN_LEN], kind: usize) -> Self {
        let (outward, rest) = (digit.outward(), hand.joint.rest_angle);
        let end = |(y, z): Point, length: f64| (y + outward * 1e3 * length * rest.sin(), z - 1e3 * length * rest.cos());
        let base = (1e3 * digit.base[1], 1e3 * digit.base[2]);
        let distal = end(base, digit.proximal.length);
        Self {
            outward,
            joints: [base, distal],
            tip: end(distal, digit.distal.length),
            thick: 1e3 * digit.proximal.radius,
            pulleys: [0, 1].map(|joint| 1e3 * design[kind + joint]),
            kind,
        }
    }

    /// The way of the tendon from the spool: round the inner side of both pulleys, and to the fingertip.
    fn tendon(&self, spool: (Point, f64)) -> Vec<Point> {
        let circles = [spool, (self.joints[0], self.pulleys[0]), (self.joints[1], self.pulleys[1]), (self.tip, 0.0)];
        let pairs = circles.windows(2).flat_map(|pair| tangent(pair[0], pair[1], self.outward));
        pairs.collect()
    }
}

/// Where a line touches two circles on the same side, the inner one of a digit that opens `outward`.
fn tangent((a, r): (Point, f64), (b, s): (Point, f64), outward: f64) -> [Point; 2] {
    let (dy, dz) = (b.0 - a.0, b.1 - a.1);
    let length = dy.hypot(dz).max(1e-9);
    let along = (dy / length, dz / length);
    // Across, to the side on which the digit closes.
    let across = (outward * along.1, -outward * along.0);
    let cos = ((r - s) / length).clamp(-1.0, 1.0);
    let sin = (1.0 - cos * cos).sqrt();
    let normal = (along.0 * cos + across.0 * sin, along.1 * cos + across.1 * sin);
    [(a.0 + r * normal.0, a.1 + r * normal.1), (b.0 + s * normal.0, b.1 + s * normal.1)]
}

/// Draws a hand with a `design` (SI) from the side, open, palm down. The two fingers are one behind the other.
pub fn transmission(hand: &HandDescription, design: &[f64; DESIGN_LEN]) -> String {
    let digits = [Digit::new(hand, &hand.thumb, design, 0), Digit::new(hand, &hand.fingers[0], design, 2)];
    let [_, half, thick] = hand.palm.half_size.map(|half| 1e3 * half);
    let spool = ((0.0, thick), 1e3 * hand.transmission.spool_radius);
    let reach = digits.iter().map(|digit| digit.tip.0.abs() + digit.thick).fold(half, f64::max);
    let low = digits.iter().map(|digit| digit.tip.1 - digit.thick).fold(0.0, f64::min);
    let (width, height) = (2.0 * (ASIDE + SCALE * reach), ABOVE + SCALE * (2.0 * thick - low) + 40.0);
    let at = |(y, z): Point| (width / 2.0 + SCALE * y, ABOVE + SCALE * (2.0 * thick - z));
    let mut svg = Svg::new(width, height, "the transmission");
    let (left, top) = at((-half, 2.0 * thick));
    svg.rectangle(
        (left, top),
        (2.0 * SCALE * half, 2.0 * SCALE * thick),
        "fill=\"#ffffff\" stroke=\"#666666\" stroke-width=\"0.9\"",
    );
    for digit in &digits {
        let ends = [digit.joints[0], digit.joints[1], digit.tip].map(at);
        let links = format!("{LINK} stroke-width=\"{:.1}\"", 2.0 * SCALE * digit.thick);
        svg.polyline(&ends, &links);
    }
    for (place, digit) in digits.iter().enumerate() {
        let paint = colour(place);
        for (joint, (&centre, &radius)) in digit.joints.iter().zip(&digit.pulleys).enumerate() {
            let style = format!("fill=\"#ffffff\" stroke=\"{paint}\" stroke-width=\"1.4\"");
            svg.dot(at(centre), SCALE * radius, &style);
            svg.dot(at(centre), 2.0, &format!("fill=\"{INK}\""));
            let kind = digit.kind + joint;
            let [radius, stiffness, preload] = [1e3 * design[kind], 1e3 * design[4 + kind], design[8 + kind]];
            let lines = [
                format!(
                    "{} {}",
                    if place == 0 { "thumb" } else { "finger" },
                    if joint == 0 { "proximal" } else { "distal" }
                ),
                format!("pulley r {radius:.2} mm"),
                format!("spring {stiffness:.2} N·mm/rad"),
                format!("preload {preload:.2} rad"),
            ];
            let anchor = if digit.outward > 0.0 { Anchor::Start } else { Anchor::End };
            // Beside the link, level with the joint.
            let (x, y) = at((centre.0 + digit.outward * (digit.thick + 5.0), centre.1));
            for (row, line) in lines.iter().enumerate() {
                let ink = if row == 0 { INK } else { GREY };
                svg.text((x + digit.outward * 4.0, y - 18.0 + 14.0 * row as f64), TEXT, anchor, ink, line);
            }
        }
        let way: Vec<Point> = digit.tendon(spool).into_iter().map(at).collect();
        svg.polyline(&way, &format!("stroke=\"{paint}\" stroke-width=\"1.8\""));
        svg.dot(at(digit.tip), 3.0, &format!("fill=\"{paint}\""));
    }
    svg.dot(at(spool.0), SCALE * spool.1, "fill=\"#ffffff\" stroke=\"#262626\" stroke-width=\"1.4\"");
    let motor = format!("spool r {:.1} mm, three tendons", spool.1);
    svg.text((width / 2.0, ABOVE - 10.0), TEXT, Anchor::Middle, INK, &motor);
    let (ruler, end) = (height - 14.0, 12.0 + SCALE * RULER);
    svg.line((12.0, ruler), (end, ruler), "stroke=\"#262626\" stroke-width=\"1.4\"");
    svg.text((end + 8.0, ruler + 4.0), TEXT, Anchor::Start, INK, &format!("{RULER:.0} mm"));
    svg.finish()
}

#[cfg(test)]
mod tests {
    use hwasp_tasks::hand::PAPER_HWASP;

    use super::*;

    /// Circles of radius 3 and 1 that are 10 apart: the line that touches both on one side, by hand.
    #[test]
    fn a_tangent_touches_both_circles() {
        for outward in [1.0, -1.0] {
            let [p, q] = tangent(((0.0, 0.0), 3.0), ((0.0, -10.0), 1.0), outward);
            let way = (q.0 - p.0, q.1 - p.1);
            // Across to both radii.
            assert!((way.0 * p.0 + way.1 * p.1).abs() < 1e-9, "{p:?} {q:?}");
            assert!((way.0 * q.0 + way.1 * (q.1 + 10.0)).abs() < 1e-9, "{p:?} {q:?}");
            assert!((p.0.hypot(p.1) - 3.0).abs() < 1e-9 && (way.0.hypot(way.1) - 96f64.sqrt()).abs() < 1e-9);
            // A digit that opens to the right closes to the left.
            assert!(p.0 * outward < 0.0 && q.0 * outward < 0.0, "{p:?} {q:?}");
        }
    }

    #[test]
    fn pulleys_are_as_large_as_they_are_designed() {
        let svg = transmission(&HandDescription::default(), &PAPER_HWASP);
        for kind in 0..4 {
            let radius = SCALE * 1e3 * PAPER_HWASP[kind];
            assert!(svg.contains(&format!("r=\"{}\"", (radius * 100.0).round() / 100.0)), "{radius}: {svg}");
        }
        assert!(svg.contains("pulley r 10.00 mm") && svg.matches("<polyline").count() == 4, "{svg}");
    }
}
