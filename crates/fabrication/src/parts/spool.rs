//! The spool: a drum with a groove for each line, on a hub that is screwed on the motor's horn.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, TAU};

use hwasp_tasks::hand::HandDescription;

use super::mount::{DRUM_CIRCLE, HORN_CIRCLE, HUB, LINE_HOLE, Levels};
use super::{Layout, between};
use crate::solid::{Layer, Outline, band, disc};

/// Radius of the hub, m.
pub(super) const HUB_RADIUS: f64 = 0.011;

/// Radius of the drum's flanges, m.
pub(super) fn rim(hand: &HandDescription, layout: &Layout<'_>) -> f64 {
    layout.rim(hand.transmission.spool_radius)
}

/// The drum. A line leaves its groove inwards through a slot, goes down through a hole and ends under the head of a screw.
pub(super) fn drum(hand: &HandDescription, layout: &Layout<'_>) -> Vec<Layer> {
    let (levels, radius) = (Levels::new(hand, layout), hand.transmission.spool_radius);
    let bottom = layout.groove_bottom(radius);
    let half = layout.groove();
    // The sides of polygons are a little inside of their circles.
    let down = bottom - layout.workshop.wall - LINE_HOLE - 2e-5;
    let middles = [0, 1, 2].map(|digit| levels.groove(digit, layout));
    let heights = middles.into_iter().flat_map(|middle| [middle - half, middle + half]);
    between(heights.chain([levels.drum, levels.hub]).collect(), |z| {
        let in_groove = middles.iter().position(|middle| (z - middle).abs() < half);
        let outer = if in_groove.is_some() { bottom } else { rim(hand, layout) };
        let mut cut: Vec<Outline> = screws(0.5 * 2.7e-3).collect();
        for (digit, middle) in middles.iter().enumerate() {
            // Between two screws, beside the washer of the one before.
            let at = polar(FRAC_PI_2 * digit as f64 + FRAC_PI_2, 1.0);
            if z < middle + half {
                cut.push(disc(at.map(|part| part * down), LINE_HOLE));
            }
            if in_groove == Some(digit) {
                cut.push(band(at.map(|part| part * down), at.map(|part| part * 2.0 * bottom), LINE_HOLE));
            }
        }
        (vec![disc([0.0; 2], outer)], cut)
    })
}

/// The hub. Heads of its screws are sunk in the face to the drum.
pub(super) fn hub(hand: &HandDescription, layout: &Layout<'_>) -> Vec<Layer> {
    let low = Levels::new(hand, layout).hub;
    let sunk = low + 2.2e-3;
    between(vec![low, sunk, low + HUB], |z| {
        let mut cut: Vec<Outline> = screws(0.5 * 2.1e-3).collect();
        cut.push(disc([0.0; 2], 0.5 * 3.4e-3));
        cut.extend(horn_screws(if z < sunk { 0.5 * 4.2e-3 } else { 0.5 * 2.4e-3 }));
        (vec![disc([0.0; 2], HUB_RADIUS)], cut)
    })
}

fn screws(radius: f64) -> impl Iterator<Item = Outline> {
    (0..4).map(move |index| disc(polar(FRAC_PI_4 + FRAC_PI_2 * f64::from(index), DRUM_CIRCLE), radius))
}

/// Holes on the horn's circle.
pub(super) fn horn_screws(radius: f64) -> impl Iterator<Item = Outline> {
    (0..4).map(move |index| disc(polar(0.25 * TAU * f64::from(index), HORN_CIRCLE), radius))
}

fn polar(angle: f64, radius: f64) -> [f64; 2] {
    let (sin, cos) = angle.sin_cos();
    [radius * cos, radius * sin]
}
