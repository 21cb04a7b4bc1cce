//! One panel: axes, grid, and the lines of every label.

use hwasp_core::unit;

use crate::axis::{Axis, value_label};
use crate::options::{PanelText, Theme};
use crate::series::{Point, Shape, thin};
use crate::svg::{Anchor, Svg, text_width};

/// The plotting area, in pixels.
pub(super) const AREA: (f64, f64) = (360.0, 236.0);
/// Room above, right of and below it.
pub(super) const MARGINS: (f64, f64, f64) = (8.0, 50.0, 46.0);
/// Room right of it in print, with the figure of an optimum and without one.
const PRINT_RIGHT: (f64, f64) = (32.0, 12.0);
/// From the axis to its text, if the labels of the ticks leave room for it.
const LABEL_AT: f64 = 56.0;
/// The size of the ticks' labels, how far they are from the axis, and the least between them and its text.
pub(super) const TICK: (f64, f64, f64) = (11.0, 7.0, 8.0);
/// Room left of the baseline of the axis' text.
const LABEL_ROOM: f64 = 18.0;

/// Where a panel lies on the page.
#[derive(Clone, Copy, Debug)]
pub(super) struct Site {
    /// The top left corner of its plotting area.
    pub(super) corner: (f64, f64),
    /// The size of that.
    pub(super) area: (f64, f64),
    /// How far the text of the vertical axis is from it.
    pub(super) label_at: f64,
    pub(super) theme: Theme,
}

/// How far the text of the vertical axis is from it, for the widest label of a tick among the panels, and the room that
/// both take; without a text only the ticks'.
pub(super) fn left_margin(panels: &[Panel], theme: Theme) -> (f64, f64) {
    let widest = panels.iter().map(Panel::widest_label).fold(0.0, f64::max);
    let ticks = TICK.1 + widest + TICK.2;
    if panels.iter().all(|panel| panel.text.label.is_empty()) {
        return (ticks, ticks);
    }
    let label_at = if theme == Theme::Print { ticks } else { LABEL_AT.max(ticks) };
    (label_at, label_at + LABEL_ROOM)
}

/// Room right of the plotting areas.
pub(super) fn right_margin(panels: &[Panel], theme: Theme) -> f64 {
    match theme {
        Theme::Screen => MARGINS.1,
        Theme::Print if panels.iter().any(|panel| panel.text.optimum.is_some()) => PRINT_RIGHT.0,
        Theme::Print => PRINT_RIGHT.1,
    }
}

pub(super) const INK: &str = "#262626";
pub(super) const GREY: &str = "#666666";
/// Dashes of a known optimum.
pub(super) const OPTIMUM: &str = "stroke=\"#262626\" stroke-width=\"1.1\" stroke-dasharray=\"5 3\"";
pub(super) const GRID_LINE: &str = "stroke=\"#e6e6e6\" stroke-width=\"0.8\"";
pub(super) const FRAME: &str = "stroke=\"#262626\" stroke-width=\"0.9\"";

/// Okabe and Ito's palette without its yellow, told apart by every common kind of colour vision.
const COLOURS: [&str; 7] = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9", "#e69f00", "#000000"];
/// A second and third round of colours is dashed; in print each colour is.
const DASHES: [&str; 3] = ["", " stroke-dasharray=\"7 2.5\"", " stroke-dasharray=\"2 2\""];
const PRINT_DASHES: [&str; 5] = [
    "",
    " stroke-dasharray=\"7 2.5\"",
    " stroke-dasharray=\"2 2\"",
    " stroke-dasharray=\"9 2.5 2 2.5\"",
    " stroke-dasharray=\"14 3\"",
];

/// The first place whose lines are dashed; their colours are those from the beginning.
pub(super) const SECOND_ROUND: usize = COLOURS.len();

/// The colour of the label at this place in the legend.
pub(super) fn colour(place: usize) -> &'static str {
    COLOURS[place % COLOURS.len()]
}

/// The stroke of the label at this place in the legend.
pub(super) fn stroke(place: usize, theme: Theme) -> String {
    let dash = match theme {
        Theme::Screen => DASHES[place / COLOURS.len() % DASHES.len()],
        Theme::Print => PRINT_DASHES[place % PRINT_DASHES.len()],
    };
    format!("stroke=\"{}\" stroke-width=\"1.8\"{dash}", colour(place))
}

/// What one panel shows: a shape per label, none for a label that lacks the column.
#[derive(Debug)]
pub(super) struct Panel {
    pub(super) text: PanelText,
    x_label: &'static str,
    shapes: Vec<Option<Shape>>,
    axes: (Axis, Axis),
    empty: bool,
}

impl Panel {
    /// Brings what is SI to the unit of the text and finds axes that hold it.
    pub(super) fn new(mut text: PanelText, x_label: &'static str, mut shapes: Vec<Option<Shape>>) -> Self {
        let to_si = unit(&text.unit).map_or(1.0, |unit| unit.to_si);
        // A division by one would do no harm, but a run may have many rows.
        if to_si != 1.0 {
            text.optimum = text.optimum.map(|value| value / to_si);
            shapes.iter_mut().flatten().for_each(|shape| shape.divide(to_si));
        }
        let points: Vec<Point> = shapes.iter().flatten().flat_map(points).collect();
        let last = points.iter().fold(0f64, |last, point| last.max(point.0));
        let values = points.iter().map(|point| point.1);
        let (low, high) =
            values.chain(text.optimum).fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
        let values = if low <= high { Axis::of_values(low, high) } else { Axis::of_values(0.0, 1.0) };
        Self { text, x_label, shapes, axes: (Axis::of_progress(last), values), empty: points.is_empty() }
    }

    /// The width of the widest label beside the vertical axis.
    fn widest_label(&self) -> f64 {
        self.axes.1.labels().iter().map(|label| text_width(label, TICK.0)).fold(0.0, f64::max)
    }

    /// Whether a label is drawn as a mean with a band.
    pub(super) fn has_summary(&self) -> bool {
        self.shapes.iter().flatten().any(|shape| matches!(shape, Shape::Summary { .. }))
    }

    /// Whether a label is drawn as logged with its trailing mean.
    pub(super) fn has_single(&self) -> bool {
        self.shapes.iter().flatten().any(|shape| matches!(shape, Shape::Single(_)))
    }

    /// Whether several runs of a label are drawn one by one.
    pub(super) fn has_separate(&self) -> bool {
        self.shapes.iter().flatten().any(|shape| matches!(shape, Shape::Separate(_)))
    }

    /// Whether it shows anything of the label at this place.
    pub(super) fn shows(&self, place: usize) -> bool {
        matches!(self.shapes.get(place), Some(Some(_)))
    }

    /// Whether the label at this place has a band.
    pub(super) fn summarises(&self, place: usize) -> bool {
        matches!(self.shapes.get(place), Some(Some(Shape::Summary { .. })))
    }

    /// Draws the panel.
    pub(super) fn draw(&self, svg: &mut Svg, site: Site) {
        let (x, values) = &self.axes;
        let frame = Frame { site, x, values };
        frame.draw_axes(svg, &self.text, self.x_label);
        let (corner, area) = (site.corner, site.area);
        if self.empty {
            let middle = (corner.0 + area.0 / 2.0, corner.1 + area.1 / 4.0);
            svg.text(middle, 12.0, Anchor::Middle, GREY, "no rows to draw");
        }
        // The optimum lies under the curves that run into it, bands under lines.
        if let Some(value) = self.text.optimum {
            let y = frame.at((0.0, value)).1;
            svg.line((corner.0, y), (corner.0 + area.0, y), OPTIMUM);
            svg.text((corner.0 + area.0 + 5.0, y + 3.6), 10.0, Anchor::Start, INK, &value_label(value));
        }
        let shapes = || self.shapes.iter().enumerate().filter_map(|(place, shape)| Some((place, shape.as_ref()?)));
        for (place, shape) in shapes() {
            frame.draw_background(svg, place, shape);
        }
        for (place, shape) in shapes() {
            frame.draw_lines(svg, place, shape);
        }
    }
}

/// Every point of a shape that the axes must hold.
fn points(shape: &Shape) -> Vec<Point> {
    match shape {
        Shape::Nothing => Vec::new(),
        Shape::Single(line) => [line.raw.clone(), line.smooth.clone()].concat(),
        Shape::Summary { centre, band } => {
            let sides = band.iter().flat_map(|&(step, low, high)| [(step, low), (step, high)]);
            centre.iter().copied().chain(sides).collect()
        }
        Shape::Separate(lines) => lines.iter().flat_map(|line| line.smooth.clone()).collect(),
    }
}

/// A plotting area with its axes.
struct Frame<'a> {
    site: Site,
    x: &'a Axis,
    values: &'a Axis,
}

impl Frame<'_> {
    /// Where a point lies on the page.
    fn at(&self, point: Point) -> (f64, f64) {
        let (x, y) = (self.x.share(point.0), self.values.share(point.1));
        let Site { corner, area, .. } = self.site;
        (corner.0 + x * area.0, corner.1 + (1.0 - y) * area.1)
    }

    fn draw_axes(&self, svg: &mut Svg, text: &PanelText, x_label: &str) {
        let Site { corner: (left, top), area, label_at, .. } = self.site;
        let (right, bottom) = (left + area.0, top + area.1);
        let (ticks, labels) = (self.x.ticks(), self.x.engineering_labels());
        // A narrow panel has no room for all.
        let widest = labels.iter().map(|label| text_width(label, TICK.0)).fold(0.0, f64::max) + TICK.2;
        let every = (widest * ticks.len() as f64 / area.0).ceil().max(1.0) as usize;
        for (i, (tick, label)) in ticks.into_iter().zip(labels).enumerate() {
            let x = self.at((tick, 0.0)).0;
            svg.line((x, top), (x, bottom), GRID_LINE);
            svg.line((x, bottom), (x, bottom + 4.0), FRAME);
            if i % every == 0 {
                svg.text((x, bottom + 16.0), TICK.0, Anchor::Middle, INK, &label);
            }
        }
        for (tick, label) in self.values.ticks().into_iter().zip(self.values.labels()) {
            let y = self.at((0.0, tick)).1;
            svg.line((left, y), (right, y), GRID_LINE);
            svg.line((left - 4.0, y), (left, y), FRAME);
            svg.text((left - TICK.1, y + 4.0), TICK.0, Anchor::End, INK, &label);
        }
        svg.line((left, top), (left, bottom), FRAME);
        svg.line((left, bottom), (right, bottom), FRAME);
        let middle = (left + area.0 / 2.0, bottom + 35.0);
        svg.text(middle, 12.0, Anchor::Middle, INK, x_label);
        if text.label.is_empty() {
            return;
        }
        let unit = if text.unit.is_empty() { String::new() } else { format!(" ({})", text.unit) };
        svg.upward_text((left - label_at, top + area.1 / 2.0), 12.0, INK, &format!("{}{unit}", text.label));
    }

    /// What lies under every line: bands, and single runs as logged.
    fn draw_background(&self, svg: &mut Svg, place: usize, shape: &Shape) {
        let colour = colour(place);
        match shape {
            Shape::Summary { band, .. } => {
                let upper = band.iter().map(|&(step, _, high)| (step, high));
                let lower = band.iter().rev().map(|&(step, low, _)| (step, low));
                let style = format!("fill=\"{colour}\" fill-opacity=\"0.18\"");
                svg.polygon(upper.chain(lower).map(|point| self.at(point)), &style);
            }
            Shape::Single(line) => {
                let style = format!("stroke=\"{colour}\" stroke-width=\"0.8\" stroke-opacity=\"0.35\"");
                self.draw_line(svg, &line.raw, &style, place);
            }
            Shape::Separate(_) | Shape::Nothing => {}
        }
    }

    fn draw_lines(&self, svg: &mut Svg, place: usize, shape: &Shape) {
        let style = stroke(place, self.site.theme);
        match shape {
            Shape::Nothing => {}
            Shape::Single(line) => self.draw_line(svg, &line.smooth, &style, place),
            Shape::Summary { centre, .. } => self.draw_line(svg, centre, &style, place),
            Shape::Separate(lines) => {
                for line in lines {
                    self.draw_line(svg, &line.smooth, &style, place);
                }
            }
        }
    }

    /// A line, or a dot where there is but one point.
    fn draw_line(&self, svg: &mut Svg, line: &[Point], style: &str, place: usize) {
        match line {
            [] => {}
            [point] => svg.dot(self.at(*point), 3.0, &format!("fill=\"{}\"", colour(place))),
            _ => {
                let points: Vec<_> =
                    thin(line, self.site.area.0 as usize).into_iter().map(|point| self.at(point)).collect();
                svg.polyline(&points, style);
            }
        }
    }
}
