//! The page: title, legend, panels side by side, and a line that says what the strokes mean.

use hwasp_training::stats::LEAST_VALUES;

use crate::curve::{DISCOUNTED, RETURN};
use crate::options::{Band, PlotOptions, Theme};
use crate::panel::{AREA, GREY, INK, MARGINS, OPTIMUM, Panel, Site, colour, left_margin, right_margin, stroke};
use crate::picture::PanelPlot;
use crate::svg::{Anchor, Svg, text_width};

/// A label of the legend and how many runs share it.
#[derive(Clone, Copy, Debug)]
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
    /// In print, the area follows from the page.
    pub(super) theme: Theme,
}

impl Default for Page<'_> {
    fn default() -> Self {
        Self {
            title: "",
            untitled: "",
            reference: "optimum",
            explanation: String::new(),
            area: AREA,
            theme: Theme::Screen,
        }
    }
}

/// The plotting area of a panel that stands by itself: with what is around it, as wide as the screen of a telephone.
const SMALL_AREA: (f64, f64) = (280.0, 176.0);
/// The width of a printed picture, in pixels and in millimetres: a pixel is three quarters of a point.
const PRINT_WIDTH: (f64, f64) = (642.5, 170.0);
/// How tall the areas are there, by the panels side by side.
const PRINT_HEIGHTS: [f64; 3] = [230.0, 170.0, 112.0];
const TITLE_SIZE: f64 = 15.0;
const EXPLANATION_SIZE: f64 = 10.0;
const EXPLANATION_ROW: f64 = 14.0;
const LEGEND_SIZE: f64 = 11.5;
const LEGEND_ROW: f64 = 19.0;
const SWATCH: f64 = 24.0;

/// Draws everything.
pub(super) fn picture(panels: &[Panel], entries: &[Entry<'_>], page: &Page<'_>) -> String {
    let theme = page.theme;
    let ((label_at, left), (top, _, bottom)) = (left_margin(panels, theme), MARGINS);
    let right = right_margin(panels, theme);
    let rows = Rows::of(panels, theme);
    let area = match theme {
        Theme::Screen => page.area,
        Theme::Print => (
            PRINT_WIDTH.0 / rows.columns as f64 - left - right,
            PRINT_HEIGHTS[rows.columns.min(PRINT_HEIGHTS.len()) - 1],
        ),
    };
    let cell = (left + area.0 + right, top + area.1 + bottom);
    let width = cell.0 * rows.columns as f64;
    let reach = width - left - 12.0;
    let title = cut(page.title, TITLE_SIZE, reach);
    let legend = Legend::lay_out(panels, entries, page.reference, reach);
    let title_end = if title.is_empty() { 8.0 } else { 32.0 };
    let panels_start = title_end + legend.height() + 6.0;
    let panels_end = panels_start + cell.1 * rows.count as f64;
    let explanation = wrapped(&page.explanation, EXPLANATION_SIZE, reach);
    let height =
        panels_end + EXPLANATION_ROW * explanation.len() as f64 + if explanation.is_empty() { 0.0 } else { 6.0 };

    let spoken = if title.is_empty() { page.untitled } else { &title };
    let mut svg = match theme {
        Theme::Screen => Svg::new(width, height, spoken),
        Theme::Print => Svg::printed((width, height), PRINT_WIDTH.1, spoken),
    };
    if !title.is_empty() {
        svg.text((left, 24.0), TITLE_SIZE, Anchor::Start, INK, &title);
    }
    legend.draw(&mut svg, (left, title_end), theme);
    for (place, panel) in panels.iter().enumerate() {
        let (row, column, cells) = rows.site(place);
        let corner = (column as f64 * cell.0 + left, row as f64 * cell.1 + panels_start + top);
        let area = (area.0 + (cells - 1) as f64 * cell.0, area.1);
        panel.draw(&mut svg, Site { corner, area, label_at, theme });
    }
    for (i, line) in explanation.iter().enumerate() {
        let y = panels_end + 8.0 + EXPLANATION_ROW * i as f64;
        svg.text((left, y), EXPLANATION_SIZE, Anchor::Start, GREY, line);
    }
    svg.finish()
}

/// Draws each panel as a small picture, with what is measured above it, where there is room for long names.
/// The legend of each: `entries` at its place, as far as the panel shows them.
pub(super) fn one_by_one<'e>(
    panels: Vec<Panel>,
    entries: impl Fn(usize) -> &'e [Entry<'e>],
    reference: &str,
) -> Vec<PanelPlot> {
    let draw = |(place, mut panel): (usize, Panel)| {
        let (label, unit) = (std::mem::take(&mut panel.text.label), std::mem::take(&mut panel.text.unit));
        let title = if unit.is_empty() { label.clone() } else { format!("{label} ({unit})") };
        let page = Page { title: &title, reference, area: SMALL_AREA, ..Page::default() };
        let shown: Vec<Entry<'_>> = entries(place).iter().filter(|entry| panel.shows(entry.place)).copied().collect();
        let svg = picture(std::slice::from_ref(&panel), &shown, &page);
        PanelPlot { label, svg }
    };
    panels.into_iter().enumerate().map(draw).collect()
}

/// How panels are arranged.
#[derive(Debug, PartialEq)]
struct Rows {
    columns: usize,
    count: usize,
    /// How many of the first panels, those of returns, share a row of their own.
    header: usize,
}

impl Rows {
    fn of(panels: &[Panel], theme: Theme) -> Self {
        let returns = panels.iter().filter(|panel| [RETURN, DISCOUNTED].contains(&panel.text.column.as_str())).count();
        Self::laid(panels.len(), returns, theme)
    }

    /// The hand's twelve parameters are three quantities of four joints: a row each, under the returns. So are other numbers
    /// of groups that fill rows of four; up to four panels, and what fills no such rows, are simply laid side by side. A page has
    /// room for three.
    fn laid(panels: usize, returns: usize, theme: Theme) -> Self {
        let others = panels - returns;
        let header =
            if theme == Theme::Screen && returns > 0 && others >= 8 && others.is_multiple_of(4) { returns } else { 0 };
        let columns = match panels {
            n @ 0..=3 if theme == Theme::Screen => n.max(1),
            1 => 1,
            0..=4 => 2,
            _ if header > 0 => 4,
            _ => 3,
        };
        let rest = panels - header;
        Self { columns, count: usize::from(header > 0) + rest.div_ceil(columns), header }
    }

    /// Row and column of a panel, and how many columns it takes.
    fn site(&self, place: usize) -> (usize, usize, usize) {
        if place < self.header {
            let cells = self.columns / self.header;
            return (0, place * cells, cells);
        }
        let place = place - self.header;
        (usize::from(self.header > 0) + place / self.columns, place % self.columns, 1)
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

    fn draw(&self, svg: &mut Svg, corner: (f64, f64), theme: Theme) {
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
                    svg.line((x, y), end, &stroke(*place, theme));
                }
                Swatch::Reference => svg.line((x, y), end, OPTIMUM),
            }
            svg.text((end.0 + 7.0, y + 4.0), LEGEND_SIZE, Anchor::Start, INK, text);
        }
    }
}

/// The words of a text in lines that have room; none where there are none.
fn wrapped(text: &str, size: f64, room: f64) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        match lines.last_mut() {
            Some(line) if text_width(&format!("{line} {word}"), size) <= room => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines
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
    fn the_hands_joints_are_columns_under_the_returns() {
        let hand = Rows::laid(14, 2, Theme::Screen);
        assert_eq!(hand, Rows { columns: 4, count: 4, header: 2 });
        assert_eq!(
            [0, 1, 2, 5, 13].map(|place| hand.site(place)),
            [(0, 0, 2), (0, 2, 2), (1, 0, 1), (1, 3, 1), (3, 3, 1)]
        );
        let one = Rows::laid(13, 1, Theme::Screen);
        assert_eq!([0, 1, 12].map(|place| one.site(place)), [(0, 0, 4), (1, 0, 1), (3, 3, 1)]);
    }

    #[test]
    fn few_panels_are_side_by_side() {
        let sizes = |theme| {
            [1, 2, 3, 4, 5, 7, 14]
                .map(|panels| (Rows::laid(panels, 1, theme).columns, Rows::laid(panels, 1, theme).count))
        };
        assert_eq!(sizes(Theme::Screen), [(1, 1), (2, 1), (3, 1), (2, 2), (3, 2), (3, 3), (3, 5)]);
        assert_eq!(sizes(Theme::Print), [(1, 1), (2, 1), (2, 2), (2, 2), (3, 2), (3, 3), (3, 5)]);
        assert_eq!(Rows::laid(5, 1, Theme::Screen).site(4), (1, 1, 1));
    }

    #[test]
    fn an_explanation_ends_between_words() {
        assert_eq!(wrapped("one two three", 10.0, 45.0), ["one two", "three"]);
        assert_eq!(wrapped("", 10.0, 45.0), [""; 0]);
    }
}
