//! Quantities over the time of an episode.

use crate::draw::{Entry, one_by_one};
use crate::options::PanelText;
use crate::panel::Panel;
use crate::picture::PanelPlot;
use crate::series::{LARGEST, Line, Point, Shape, thin};

/// Ranges of time of which lines over it show the extremes: several are in one picture, and a page has many.
const COLUMNS: usize = 40;

/// Draws SI values, one per step, in a unit.
pub fn trace(label: &str, unit: &str, values: &[f64]) -> Option<PanelPlot> {
    let steps = values.iter().enumerate().map(|(step, &value)| (step as f64, value));
    draw((label, unit), "step of the episode", vec![shape(drawable(steps))], &[])
}

/// Draws several of the same unit, one per step of so many s, each with its name, over time.
pub fn traces(label: &str, unit: &str, step: f64, lines: &[(&str, Vec<f64>)]) -> Option<PanelPlot> {
    let over_time = |values: &[f64]| {
        let points = drawable(values.iter().enumerate().map(|(i, &value)| (step * i as f64, value)));
        shape(thin(&points, COLUMNS))
    };
    let entries: Vec<Entry<'_>> =
        (lines.iter().enumerate()).map(|(place, (name, _))| Entry { place, label: name, runs: 1, asked: 1 }).collect();
    let entries = if lines.len() > 1 { &entries[..] } else { &[] };
    draw((label, unit), "time (s)", lines.iter().map(|(_, values)| over_time(values)).collect(), entries)
}

fn drawable(points: impl Iterator<Item = Point>) -> Vec<Point> {
    points.filter(|point| point.1.abs() <= LARGEST).collect()
}

fn shape(smooth: Vec<Point>) -> Shape {
    Shape::Single(Line { raw: Vec::new(), smooth })
}

fn draw(
    (label, unit): (&str, &str),
    against: &'static str,
    shapes: Vec<Shape>,
    entries: &[Entry<'_>],
) -> Option<PanelPlot> {
    let text = PanelText { label: label.to_owned(), unit: unit.to_owned(), ..PanelText::default() };
    let panel = Panel::new(text, against, shapes.into_iter().map(Some).collect());
    one_by_one(vec![panel], |_| entries, "").pop()
}
