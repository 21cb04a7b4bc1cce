//! Quantities over the time of an episode.

use crate::draw::{Entry, one_by_one};
use crate::options::PanelText;
use crate::panel::Panel;
use crate::picture::PanelPlot;
use crate::series::{LARGEST, Line, Shape};

/// Draws SI values, one per step, in a unit.
pub fn trace(label: &str, unit: &str, values: &[f64]) -> Option<PanelPlot> {
    let steps = values.iter().enumerate().map(|(step, &value)| (step as f64, value));
    draw((label, unit), "step of the episode", vec![shape(steps)], &[])
}

/// Draws several of the same unit, one per step of so many s, each with its name, over time.
pub fn traces(label: &str, unit: &str, step: f64, lines: &[(&str, Vec<f64>)]) -> Option<PanelPlot> {
    let over_time = |values: &[f64]| shape(values.iter().enumerate().map(|(i, &value)| (step * i as f64, value)));
    let entries: Vec<Entry<'_>> =
        (lines.iter().enumerate()).map(|(place, (name, _))| Entry { place, label: name, runs: 1, asked: 1 }).collect();
    let entries = if lines.len() > 1 { &entries[..] } else { &[] };
    draw((label, unit), "time (s)", lines.iter().map(|(_, values)| over_time(values)).collect(), entries)
}

fn shape(points: impl Iterator<Item = (f64, f64)>) -> Shape {
    Shape::Single(Line { raw: Vec::new(), smooth: points.filter(|point| point.1.abs() <= LARGEST).collect() })
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
