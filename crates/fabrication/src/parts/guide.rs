//! The guide on the palm: it leads the lines to the drum.

use std::f64::consts::SQRT_2;

use hwasp_tasks::hand::{DESIGN_LEN, HandDescription};

use super::mount::{FLOOR, Levels, POSTS, SCREW, TURN_PIN, WELL, Way, ways};
use super::spool::{HUB_RADIUS, rim};
use super::{Layout, between};
use crate::solid::{Layer, Outline, band, disc, rectangle};

/// Around drum and hub, m.
const CAVITY: f64 = 1e-3;
/// Half of a line's channel, and of the arm that it is in, m.
const CHANNEL: f64 = 1.2e-3;
const ARM: f64 = 4.5e-3;
/// Around a pin that turns a line, m.
const BOSS: f64 = 7.5e-3;

pub(super) fn layers(hand: &HandDescription, design: &[f64; DESIGN_LEN], layout: &Layout<'_>) -> Vec<Layer> {
    let levels = Levels::new(hand, layout);
    let ways = ways(hand, design, layout);
    let cavity = rim(hand, layout).max(HUB_RADIUS) + CAVITY;
    let [post_x, post_y] = POSTS;
    let mut body = vec![
        rectangle([-post_x - 5e-3, post_x + 5e-3], [-post_y - 5e-3, post_y + 5e-3]),
        disc([0.0; 2], cavity + 3e-3),
    ];
    for way in &ways {
        body.push(band(way.exit, way.at(way.length), ARM));
        body.push(disc(way.pin, BOSS));
    }
    let seat = |way: &Way| way.pin_height - TURN_PIN[0];
    let bottom = |way: &Way| way.height - CHANNEL;
    let heights = ways.iter().flat_map(|way| [seat(way), bottom(way)]);
    between(heights.chain([levels.palm, levels.palm + FLOOR, levels.guide]).collect(), |z| {
        let mut cut: Vec<Outline> = screws().collect();
        cut.push(disc([0.0; 2], if z < levels.palm + FLOOR { WELL * SQRT_2 } else { cavity }));
        for way in &ways {
            let half = layout.channel() + layout.workshop.print_clearance;
            // Along the line's way, so that it opens into the pin's seat with no thin wall between.
            cut.push(band(way.at(-half), way.at(half), half));
            if z > bottom(way) {
                cut.push(band(way.at(-CHANNEL), way.at(way.length), CHANNEL));
            }
            if z > seat(way) {
                cut.push(pin_seat(way, layout));
            }
        }
        (body.clone(), cut)
    })
}

/// What the pin lies in, across the line.
fn pin_seat(way: &Way, layout: &Layout<'_>) -> Outline {
    let play = 0.5 * layout.workshop.print_clearance;
    let [along_x, along_y] = way.along;
    let half = TURN_PIN[1] + play;
    let end = |side: f64| [way.pin[0] - side * half * along_y, way.pin[1] + side * half * along_x];
    band(end(-1.0), end(1.0), TURN_PIN[0] + 0.5 * play)
}

/// Holes for the screws between cage, guide and palm.
pub(super) fn screws() -> impl Iterator<Item = Outline> {
    [-1.0, 1.0].into_iter().flat_map(|x| [-1.0, 1.0].map(|y| disc([x * POSTS[0], y * POSTS[1]], 0.5 * SCREW)))
}
