//! One quantity over the steps of an episode.

use crate::draw::one_by_one;
use crate::options::PanelText;
use crate::panel::Panel;
use crate::picture::PanelPlot;
use crate::series::{LARGEST, Line, Shape};

/// Draws SI values, one per step, in a unit.
pub fn trace(label: &str, unit: &str, values: &[f64]) -> Option<PanelPlot> {
    let text = PanelText { label: label.to_owned(), unit: unit.to_owned(), ..PanelText::default() };
    let points = values.iter().enumerate().map(|(step, &value)| (step as f64, value));
    let smooth = points.filter(|point| point.1.abs() <= LARGEST).collect();
    let shape = Shape::Single(Line { raw: Vec::new(), smooth });
    one_by_one(vec![Panel::new(text, "step of the episode", vec![Some(shape)])], &[], "").pop()
}
