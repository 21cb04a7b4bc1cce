//! The page: title, legend, panels side by side, and a line that says what the strokes mean.

use hwasp_training::stats::LEAST_VALUES;

use crate::options::{Band, PlotOptions};
use crate::panel::{AREA, GREY, INK, MARGINS, OPTIMUM, Panel, Site, colour, left_margin, stroke};
use crate::picture::PanelPlot;
use crate::svg::{Anchor, Svg, text_width};

/// A label of the legend and how many runs share it.
#[derive(Debug)]
pub(super) struct Entry<'a> {
    /// Its place among the shapes of the panels, which is its colour.
    pub(super) place: usize,
    pub(super) label: &'a str,
    pub(super) runs: usize,
    /// How many there should be.
    pub(super) asked: usize,
}

/// The texts around the panels.
#[derive(Debug)]
pub(super) struct Page<'a> {
    /// The line above everything; empty for none.
    pub(super) title: &'a str,
    /// What readers of screens hear where there is no title.
    pub(super) untitled: &'a str,
    /// What the legend calls the dashed horizontal lines.
    pub(super) reference: &'a str,
    /// The line below everything; empty for none.
    pub(super) explanation: String,
    /// The plotting area of a panel, in pixels.
    pub(super) area: (f64, f64),
}

impl Default for Page<'_> {
    fn default() -> Self {
        Self { title: "", untitled: "", reference: "optimum", explanation: String::new(), area: AREA }
    }
}

/// The plotting area of a panel that stands by itself: with what is around it, as wide as the screen of a telephone.
const SMALL_AREA: (f64, f64) = (280.0, 176.0);
const TITLE_SIZE: f64 = 15.0;
const LEGEND_SIZE: f64 = 11.5;
const LEGEND_ROW: f64 = 19.0;
const SWATCH: f64 = 24.0;

/// Draws everything.
pub(super) fn picture(panels: &[Panel], entries: &[Entry<'_>], page: &Page<'_>) -> String {
    let ((label_at, left), (top, right, bottom)) = (left_margin(panels), MARGINS);
    let cell = (left + page.area.0 + right, top + page.area.1 + bottom);
    let rows = Rows::of(panels.len());
    let width = cell.0 * rows.columns as f64;
    let reach = width - left - 12.0;
    let title = cut(page.title, TITLE_SIZE, reach);
    let legend = Legend::lay_out(panels, entries, page.reference, reach);
    let title_end = if title.is_empty() { 8.0 } else { 32.0 };
    let panels_start = title_end + legend.height() + 6.0;
    let panels_end = panels_start + cell.1 * rows.count as f64;
    let height = if page.explanation.is_empty() { panels_end } else { panels_end + 20.0 };

    let mut svg = Svg::new(width, height, if title.is_empty() { page.untitled } else { &title });
    if !title.is_empty() {
        svg.text((left, 24.0), TITLE_SIZE, Anchor::Start, INK, &title);
    }
    legend.draw(&mut svg, (left, title_end));
    for (place, panel) in panels.iter().enumerate() {
        let (row, column, cells) = rows.site(place);
        let corner = (column as f64 * cell.0 + left, row as f64 * cell.1 + panels_start + top);
        let area = (page.area.0 + (cells - 1) as f64 * cell.0, page.area.1);
        panel.draw(&mut svg, Site { corner, area, label_at });
    }
    if !page.explanation.is_empty() {
        svg.text((left, panels_end + 8.0), 10.0, Anchor::Start, GREY, &page.explanation);
    }
    svg.finish()
}

/// Draws each panel as a small picture, with what is measured above it, where there is room for long names.
pub(super) fn one_by_one(panels: Vec<Panel>, entries: &[Entry<'_>], reference: &str) -> Vec<PanelPlot> {
    let draw = |mut panel: Panel| {
        let (label, unit) = (std::mem::take(&mut panel.text.label), std::mem::take(&mut panel.text.unit));
        let title = if unit.is_empty() { label.clone() } else { format!("{label} ({unit})") };
        let page = Page { title: &title, reference, area: SMALL_AREA, ..Page::default() };
        let svg = picture(std::slice::from_ref(&panel), entries, &page);
        PanelPlot { label, svg }
    };
    panels.into_iter().map(draw).collect()
}

/// How panels are arranged.
#[derive(Debug, PartialEq)]
struct Rows {
    columns: usize,
    count: usize,
    /// Whether the first panel, the return's, has a row to itself.
    header: bool,
}

impl Rows {
    /// The hand's twelve parameters are three quantities of four joints: a row each, under the return. So are other numbers
    /// of groups that fill rows of four; up to four panels, and what fills no such rows, are simply laid side by side.
    fn of(panels: usize) -> Self {
        let header = panels > 5 && (panels - 1).is_multiple_of(4);
        let columns = match panels {
            n @ 0..=3 => n.max(1),
            4 => 2,
            _ if header => 4,
            _ => 3,
        };
        let count = if header { 1 + (panels - 1) / 4 } else { panels.div_ceil(columns) };
        Self { columns, count, header }
    }

    /// Row and column of a panel, and how many columns it takes.
    fn site(&self, place: usize) -> (usize, usize, usize) {
        match place {
            0 if self.header => (0, 0, self.columns),
            _ if self.header => (1 + (place - 1) / self.columns, (place - 1) % self.columns, 1),
            _ => (place / self.columns, place % self.columns, 1),
        }
    }
}

/// What lines and bands mean, for whoever meets the picture without its text.
/// `missing`: labels without a single run.
pub(super) fn explanation(panels: &[Panel], options: &PlotOptions, missing: &[&str]) -> String {
    let mut parts = vec![strokes(panels, options)];
    if options.band == Band::Bootstrap && panels.iter().any(Panel::has_separate) {
        parts.push(format!("fewer than {LEAST_VALUES} runs of a label carry no interval and are drawn one by one"));
    }
    if !missing.is_empty() {
        parts.push(format!("no run finished of {}", missing.join(", ")));
    }
    parts.retain(|part| !part.is_empty());
    parts.join("; ")
}

fn strokes(panels: &[Panel], options: &PlotOptions) -> String {
    let window = options.window;
    let single = match window {
        1 => String::new(),
        _ => format!("return: each iteration (pale) and the mean of the last {window} (full)"),
    };
    let band = match options.band {
        Band::MinMax => "from the smallest to the largest",
        Band::Bootstrap => "of its 95 % bootstrap interval",
    };
    let smoothed = match window {
        1 => String::new(),
        _ => format!("; a run's return is the mean of its last {window} iterations"),
    };
    let summary = format!("interquartile mean of the runs and a band {band}{smoothed}");
    match (panels.iter().any(Panel::has_single), panels.iter().any(Panel::has_summary)) {
        (false, false) => String::new(),
        (true, false) => single,
        (false, true) => summary,
        (true, true) if window == 1 => format!("several runs: {summary}"),
        (true, true) => format!("several runs: {summary}. One run: {single}"),
    }
}

/// What stands beside a text of the legend.
enum Swatch {
    /// The label at this place, with a band or without.
    Label { place: usize, band: bool },
    /// The dashes of an optimum or a limit.
    Reference,
}

/// Texts with their swatches and positions, wrapped into rows.
struct Legend {
    items: Vec<(Swatch, String, (f64, f64))>,
}

impl Legend {
    fn lay_out(panels: &[Panel], entries: &[Entry<'_>], reference: &str, reach: f64) -> Self {
        let mut texts: Vec<(Swatch, String)> = Vec::new();
        for entry in entries {
            let (place, runs, asked) = (entry.place, entry.runs, entry.asked);
            let suffix = match runs {
                _ if asked > runs => format!(" ({runs} of {asked} runs)"),
                0 | 1 => String::new(),
                _ => format!(" ({runs} runs)"),
            };
            let band = panels.iter().any(|panel| panel.summarises(place));
            let room = (reach - SWATCH - 8.0 - text_width(&suffix, LEGEND_SIZE)).min(420.0);
            let text = format!("{}{suffix}", cut(entry.label, LEGEND_SIZE, room));
            texts.push((Swatch::Label { place, band }, text));
        }
        if panels.iter().any(|panel| panel.text.optimum.is_some()) {
            texts.push((Swatch::Reference, reference.to_owned()));
        }
        let (mut x, mut y) = (0.0, 0.0);
        let mut items = Vec::with_capacity(texts.len());
        for (swatch, text) in texts {
            let size = SWATCH + 7.0 + text_width(&text, LEGEND_SIZE);
            if x > 0.0 && x + size > reach {
                (x, y) = (0.0, y + LEGEND_ROW);
            }
            items.push((swatch, text, (x, y)));
            x += size + 20.0;
        }
        Self { items }
    }

    fn height(&self) -> f64 {
        self.items.last().map_or(0.0, |item| item.2.1 + LEGEND_ROW)
    }

    fn draw(&self, svg: &mut Svg, corner: (f64, f64)) {
        for (swatch, text, (x, y)) in &self.items {
            let (x, y) = (corner.0 + x, corner.1 + y + LEGEND_ROW / 2.0);
            let end = (x + SWATCH, y);
            match swatch {
                Swatch::Label { place, band } => {
                    if *band {
                        let corners = [(x, y - 5.0), (end.0, y - 5.0), (end.0, y + 5.0), (x, y + 5.0)];
                        let style = format!("fill=\"{}\" fill-opacity=\"0.18\"", colour(*place));
                        svg.polygon(corners.into_iter(), &style);
                    }
                    svg.line((x, y), end, &stroke(*place));
                }
                Swatch::Reference => svg.line((x, y), end, OPTIMUM),
            }
            svg.text((end.0 + 7.0, y + 4.0), LEGEND_SIZE, Anchor::Start, INK, text);
        }
    }
}

/// The text, or as much of its beginning as there is room for.
fn cut(text: &str, size: f64, room: f64) -> String {
    if text_width(text, size) <= room {
        return text.to_owned();
    }
    let mut short = String::new();
    for c in text.chars() {
        short.push(c);
        if text_width(&short, size) > room - size {
            break;
        }
    }
    format!("{}…", short.trim_end())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_hands_joints_are_columns_under_the_return() {
        let hand = Rows::of(13);
        assert_eq!(hand, Rows { columns: 4, count: 4, header: true });
        assert_eq!(
            [0, 1, 4, 5, 12].map(|place| hand.site(place)),
            [(0, 0, 4), (1, 0, 1), (1, 3, 1), (2, 0, 1), (3, 3, 1)]
        );
    }

    #[test]
    fn few_panels_are_side_by_side() {
        let sizes = [1, 2, 3, 4, 5, 7].map(|panels| (Rows::of(panels).columns, Rows::of(panels).count));
        assert_eq!(sizes, [(1, 1), (2, 1), (3, 1), (2, 2), (3, 2), (3, 3)]);
        assert_eq!(Rows::of(5).site(4), (1, 1, 1));
    }
}
