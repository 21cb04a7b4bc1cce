//! Many like parameters side by side.

use crate::axis::Axis;
use crate::panel::{FRAME, GRID_LINE, INK, colour};
use crate::svg::{Anchor, Svg};

const AREA: (f64, f64) = (330.0, 120.0);
const LEFT: f64 = 58.0;
const TOP: f64 = 10.0;

/// Draws values, at least one, as a staircase from zero; `label` says what they are and in which unit.
pub fn bars(values: &[f64], label: &str) -> String {
    let (low, high) = values.iter().fold((0f64, 0f64), |(l, h), &v| (l.min(v), h.max(v)));
    let axis = Axis::of_values(low, high);
    let mut svg = Svg::new(LEFT + AREA.0 + 10.0, TOP + AREA.1 + 44.0, label);
    let y = |value: f64| TOP + AREA.1 * (1.0 - axis.share(value));
    let x = |i: usize| LEFT + AREA.0 * i as f64 / values.len() as f64;
    for (tick, text) in axis.ticks().into_iter().zip(axis.labels()) {
        svg.line((LEFT, y(tick)), (LEFT + AREA.0, y(tick)), GRID_LINE);
        svg.text((LEFT - 7.0, y(tick) + 4.0), 11.0, Anchor::End, INK, &text);
    }
    // Bars as wide as they can be told apart, with a gap where there is room for one.
    let gap = if values.len() <= 60 { 0.12 * AREA.0 / values.len() as f64 } else { 0.0 };
    let corners = values.iter().enumerate().flat_map(|(i, &value)| {
        let (from, to) = (x(i) + gap, x(i + 1) - gap);
        [(from, y(0.0)), (from, y(value)), (to, y(value)), (to, y(0.0))]
    });
    svg.polygon(corners, &format!("fill=\"{}\"", colour(0)));
    svg.line((LEFT, y(0.0)), (LEFT + AREA.0, y(0.0)), FRAME);
    let count = values.len();
    svg.text((x(0), TOP + AREA.1 + 18.0), 11.0, Anchor::Start, INK, "1");
    svg.text((x(count), TOP + AREA.1 + 18.0), 11.0, Anchor::End, INK, &count.to_string());
    svg.text((LEFT + AREA.0 / 2.0, TOP + AREA.1 + 34.0), 12.0, Anchor::Middle, INK, label);
    svg.finish()
}
