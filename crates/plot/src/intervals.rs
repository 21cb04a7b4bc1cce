//! Figures with their intervals, one below the other.

use hwasp_training::stats::Interval;

use crate::axis::Axis;
use crate::panel::{FRAME, GREY, GRID_LINE, INK, colour};
use crate::series::LARGEST;
use crate::svg::{Anchor, Svg, text_width};

/// A figure with its interval.
#[derive(Clone, Debug)]
pub struct IntervalRow<'a> {
    /// What it is of.
    pub label: &'a str,
    /// The figure.
    pub value: f64,
    /// How it is told.
    pub text: String,
    /// Its interval, if it has one.
    pub interval: Option<Interval>,
    /// What it was computed from, as dots; may be empty.
    pub points: &'a [f64],
}

const WIDTH: f64 = 400.0;
const ROW: f64 = 27.0;
const TOP: f64 = 8.0;
const LABEL_SIZE: f64 = 12.0;
/// Room for the figure's text on the right.
const RIGHT: f64 = 68.0;

/// Draws rows over one axis, on which there is nothing above `most`.
pub fn intervals(rows: &[IntervalRow<'_>], axis_text: &str, most: f64) -> String {
    let drawable = |value: &f64| value.abs() <= LARGEST;
    let ends = |row: &IntervalRow<'_>| row.interval.map_or([row.value; 2], |interval| [interval.low, interval.high]);
    let all = rows.iter().flat_map(|row| ends(row).into_iter().chain([row.value]).chain(row.points.iter().copied()));
    let (low, high) = all.filter(drawable).fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
    let mut axis = if low <= high { Axis::of_values(low, high) } else { Axis::of_values(0.0, 1.0) };
    axis.high = axis.high.min(most);
    let widest = rows.iter().map(|row| text_width(row.label, LABEL_SIZE)).fold(40.0, f64::max).min(150.0);
    let (left, width) = (widest + 12.0, WIDTH - widest - 12.0 - RIGHT);
    let bottom = TOP + ROW * rows.len() as f64;
    let mut svg = Svg::new(WIDTH, bottom + 42.0, axis_text);
    let x = |value: f64| left + width * axis.share(value).clamp(0.0, 1.0);
    for (tick, text) in axis.ticks().into_iter().zip(axis.labels()) {
        svg.line((x(tick), TOP), (x(tick), bottom), GRID_LINE);
        svg.text((x(tick), bottom + 16.0), 11.0, Anchor::Middle, INK, &text);
    }
    svg.line((left, bottom), (left + width, bottom), FRAME);
    for (i, row) in rows.iter().enumerate() {
        let y = TOP + ROW * (i as f64 + 0.5);
        svg.text((left - 10.0, y + 4.0), LABEL_SIZE, Anchor::End, INK, row.label);
        let stroke = format!("stroke=\"{}\" stroke-width=\"2.2\" stroke-linecap=\"round\"", colour(0));
        if let Some(Interval { low, high }) = row.interval {
            svg.line((x(low), y), (x(high), y), &stroke);
        }
        for &point in row.points.iter().filter(|point| drawable(point)) {
            svg.dot((x(point), y + 7.0), 2.2, &format!("fill=\"{GREY}\" fill-opacity=\"0.7\""));
        }
        svg.dot((x(row.value), y), 4.6, &format!("fill=\"{}\"", colour(0)));
        svg.text((WIDTH - RIGHT + 12.0, y + 4.0), LABEL_SIZE, Anchor::Start, INK, &row.text);
    }
    svg.text((left + width / 2.0, bottom + 34.0), LABEL_SIZE, Anchor::Middle, INK, axis_text);
    svg.finish()
}
