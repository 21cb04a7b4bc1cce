//! The tornado chart of a design's tolerances: for each parameter, what return and success change where it is off.

use hwasp_training::stats::Interval;
use hwasp_training::{Change, MeanInterval};

use crate::axis::Axis;
use crate::options::Theme;
use crate::panel::{FRAME, GREY, GRID_LINE, INK, TICK, colour};
use crate::picture::Plot;
use crate::svg::{Anchor, Svg, text_width};

/// What an error of one parameter changes.
#[derive(Clone, Copy, Debug)]
pub struct TornadoRow<'a> {
    /// The parameter.
    pub name: &'a str,
    /// The error: `5 %`, `0.1 mm`.
    pub error: &'a str,
    /// Where it is too small by the error, and too large by it.
    pub sides: [&'a Change; 2],
}

/// Rows that are drawn: the file has all.
const MOST_ROWS: usize = 30;
/// Height of a row and of one of its two bars, pixels.
const ROW: (f64, f64) = (30.0, 10.0);
/// Width of a column of bars, and the room between two.
const COLUMN: (f64, f64) = (330.0, 34.0);
/// From the top of the page to the first row.
const TOP: f64 = 66.0;
/// Room left and right of everything.
const MARGIN: f64 = 16.0;
const TEXT: f64 = 11.5;
const WHISKER: &str = "stroke=\"#262626\" stroke-width=\"1\"";

/// What a column shows of a side.
struct Column {
    label: &'static str,
    change: fn(&Change) -> Option<MeanInterval>,
}

/// Changes in percentage points.
fn success(change: &Change) -> Option<MeanInterval> {
    Some(change.success?.scaled(100.0))
}

/// Draws rows in their order, the costliest on top; each change is over so many `episodes`.
pub fn tornado_plot(title: &str, all: &[TornadoRow<'_>], episodes: u64) -> Plot {
    let rows = &all[..all.len().min(MOST_ROWS)];
    let mut columns = vec![Column { label: "change of return", change: |change| Some(change.undiscounted_return) }];
    if rows.iter().any(|row| row.sides[0].success.is_some()) {
        columns.push(Column { label: "change of success, percentage points", change: success });
    }
    let names: Vec<String> = rows.iter().map(|row| format!("{} ±{}", row.name.replace('_', " "), row.error)).collect();
    let left = MARGIN + names.iter().map(|name| text_width(name, TEXT)).fold(150.0, f64::max) + 12.0;
    let width = left + columns.len() as f64 * (COLUMN.0 + COLUMN.1);
    let bottom = TOP + ROW.0 * rows.len() as f64;
    let mut svg = Svg::new(width, bottom + 72.0, title);
    svg.text((MARGIN, 24.0), 15.0, Anchor::Start, INK, title);
    legend(&mut svg, (MARGIN, 46.0));
    for (row, name) in names.iter().enumerate() {
        svg.text((left - 10.0, TOP + ROW.0 * (row as f64 + 0.5) + 4.0), TEXT, Anchor::End, INK, name);
    }
    for (place, column) in columns.iter().enumerate() {
        let x = left + place as f64 * (COLUMN.0 + COLUMN.1);
        column.draw(&mut svg, rows, x, bottom);
    }
    svg.text((MARGIN, bottom + 60.0), 10.0, Anchor::Start, GREY, &explanation(all.len(), episodes));
    Plot { svg: svg.finish(), theme: Theme::Screen, notes: Vec::new() }
}

fn legend(svg: &mut Svg, (mut x, y): (f64, f64)) {
    for (place, text) in ["too small by the error", "too large by it"].into_iter().enumerate() {
        svg.rectangle((x, y - 8.0), (18.0, 9.0), &fill(place));
        svg.text((x + 24.0, y), TEXT, Anchor::Start, INK, text);
        x += 24.0 + text_width(text, TEXT) + 22.0;
    }
}

fn fill(place: usize) -> String {
    format!("fill=\"{}\"", colour(place))
}

fn explanation(parameters: usize, episodes: u64) -> String {
    let more = parameters.saturating_sub(MOST_ROWS);
    let more = if more > 0 { format!("; {more} parameters that cost less are left out") } else { String::new() };
    format!(
        "{episodes} held-out episodes, the same for every bar; thin lines: 95 % bootstrap intervals of the paired change{more}"
    )
}

impl Column {
    fn draw(&self, svg: &mut Svg, rows: &[TornadoRow<'_>], left: f64, bottom: f64) {
        let sides = |row: &TornadoRow<'_>| row.sides.map(self.change);
        let ends =
            rows.iter().flat_map(sides).flatten().flat_map(|m| m.interval.map_or([m.mean; 2], |i| [i.low, i.high]));
        let (low, high) = ends.fold((0f64, 0f64), |(low, high), end| (low.min(end), high.max(end)));
        let axis = Axis::of_values(low, high);
        let at = |value: f64| left + axis.share(value) * COLUMN.0;
        for (tick, label) in axis.ticks().into_iter().zip(axis.labels()) {
            svg.line((at(tick), TOP), (at(tick), bottom), GRID_LINE);
            svg.line((at(tick), bottom), (at(tick), bottom + 4.0), FRAME);
            svg.text((at(tick), bottom + 16.0), TICK.0, Anchor::Middle, INK, &label);
        }
        for (i, row) in rows.iter().enumerate() {
            let middle = TOP + ROW.0 * (i as f64 + 0.5);
            for (place, change) in sides(row).into_iter().enumerate() {
                let Some(MeanInterval { mean, interval }) = change else { continue };
                let top = middle + ROW.1 * (place as f64 - 1.0);
                let (from, to) = (at(mean.min(0.0)), at(mean.max(0.0)));
                svg.rectangle((from, top), (to - from, ROW.1), &fill(place));
                let Some(Interval { low, high }) = interval else { continue };
                let y = top + 0.5 * ROW.1;
                svg.line((at(low), y), (at(high), y), WHISKER);
                for end in [low, high] {
                    svg.line((at(end), y - 2.5), (at(end), y + 2.5), WHISKER);
                }
            }
        }
        svg.line((at(0.0), TOP), (at(0.0), bottom), FRAME);
        svg.line((left, bottom), (left + COLUMN.0, bottom), FRAME);
        svg.text((left + 0.5 * COLUMN.0, bottom + 36.0), 12.0, Anchor::Middle, INK, self.label);
    }
}
