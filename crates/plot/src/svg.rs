//! A small writer of SVG: numbers to a hundredth of a pixel, text escaped, nothing else clever.

use std::fmt::{Display, Write};

/// The fonts of a picture, the embedded one first.
const FONTS: &str = "DejaVu Sans, Helvetica, Arial, sans-serif";

/// Where a text stands against its position.
#[derive(Clone, Copy, Debug)]
pub enum Anchor {
    /// It begins there.
    Start,
    /// It is centred there.
    Middle,
    /// It ends there.
    End,
}

/// A picture in the making; lengths in pixels, y downwards.
#[derive(Debug)]
pub struct Svg {
    text: String,
}

impl Svg {
    /// A white page with a title for readers of screens.
    pub fn new(width: f64, height: f64, title: &str) -> Self {
        Self::transparent(width, height, title).on_white(width, height)
    }

    /// The same for print: as wide as this in millimetres, whatever its pixels.
    pub fn printed((width, height): (f64, f64), millimetres: f64, title: &str) -> Self {
        let mm = |length: f64| format!("{}mm", px(length * millimetres / width));
        Self::begin((width, height), (&mm(width), &mm(height)), title).on_white(width, height)
    }

    /// A page to lay over another picture.
    pub fn transparent(width: f64, height: f64, title: &str) -> Self {
        Self::begin((width, height), (&px(width).to_string(), &px(height).to_string()), title)
    }

    fn begin((width, height): (f64, f64), (shown_width, shown_height): (&str, &str), title: &str) -> Self {
        let (w, h) = (px(width), px(height));
        let mut text = String::new();
        push(
            &mut text,
            format_args!(
                "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{shown_width}\" height=\"{shown_height}\" viewBox=\"0 0 {w} {h}\" \
                 role=\"img\" font-family=\"{FONTS}\">\n<title>{}</title>\n",
                escape(title)
            ),
        );
        Self { text }
    }

    fn on_white(mut self, width: f64, height: f64) -> Self {
        let (w, h) = (px(width), px(height));
        self.push(format_args!("<rect width=\"{w}\" height=\"{h}\" fill=\"#ffffff\"/>\n"));
        self
    }

    /// A rectangle from its upper left corner.
    pub fn rectangle(&mut self, (x, y): (f64, f64), (width, height): (f64, f64), style: &str) {
        let (x, y, width, height) = (px(x), px(y), px(width), px(height));
        self.push(format_args!("<rect x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\" {style}/>\n"));
    }

    /// A straight line.
    pub fn line(&mut self, (x1, y1): (f64, f64), (x2, y2): (f64, f64), style: &str) {
        let (x1, y1, x2, y2) = (px(x1), px(y1), px(x2), px(y2));
        self.push(format_args!("<line x1=\"{x1}\" y1=\"{y1}\" x2=\"{x2}\" y2=\"{y2}\" {style}/>\n"));
    }

    /// A broken line through the points.
    pub fn polyline(&mut self, points: &[(f64, f64)], style: &str) {
        let points = joined(points.iter().copied());
        self.push(format_args!("<polyline points=\"{points}\" fill=\"none\" stroke-linejoin=\"round\" {style}/>\n"));
    }

    /// A filled area.
    pub fn polygon(&mut self, points: impl Iterator<Item = (f64, f64)>, style: &str) {
        let points = joined(points);
        self.push(format_args!("<polygon points=\"{points}\" {style}/>\n"));
    }

    /// A dot.
    pub fn dot(&mut self, (x, y): (f64, f64), radius: f64, style: &str) {
        self.push(format_args!("<circle cx=\"{}\" cy=\"{}\" r=\"{}\" {style}/>\n", px(x), px(y), px(radius)));
    }

    /// A line of text whose baseline is at `y`.
    pub fn text(&mut self, (x, y): (f64, f64), size: f64, anchor: Anchor, fill: &str, text: &str) {
        self.place(format_args!("x=\"{}\" y=\"{}\"", px(x), px(y)), size, anchor, fill, text);
    }

    /// A line of text that reads upwards, centred on the position.
    pub fn upward_text(&mut self, (x, y): (f64, f64), size: f64, fill: &str, text: &str) {
        let place = format!("transform=\"translate({} {}) rotate(-90)\"", px(x), px(y));
        self.place(format_args!("{place}"), size, Anchor::Middle, fill, text);
    }

    /// The whole document.
    pub fn finish(mut self) -> String {
        self.text.push_str("</svg>\n");
        self.text
    }

    fn place(&mut self, place: std::fmt::Arguments<'_>, size: f64, anchor: Anchor, fill: &str, text: &str) {
        let anchor = match anchor {
            Anchor::Start => "start",
            Anchor::Middle => "middle",
            Anchor::End => "end",
        };
        let (size, text) = (px(size), escape(text));
        self.push(format_args!(
            "<text {place} font-size=\"{size}\" text-anchor=\"{anchor}\" fill=\"{fill}\">{text}</text>\n"
        ));
    }

    fn push(&mut self, piece: std::fmt::Arguments<'_>) {
        push(&mut self.text, piece);
    }
}

/// The width of a text in the embedded font, near enough to lay out a legend, in pixels.
pub(crate) fn text_width(text: &str, size: f64) -> f64 {
    let em = |c: char| match c {
        'i' | 'j' | 'l' | 'I' | '.' | ',' | ':' | ';' | '\'' | '|' | ' ' => 0.32,
        'f' | 't' | 'r' | '(' | ')' | '[' | ']' | '-' => 0.4,
        'm' | 'w' | 'M' | 'W' | '\u{2212}' | '+' | '=' => 0.88,
        c if c.is_uppercase() => 0.69,
        c if c.is_ascii() => 0.61,
        _ => 0.7,
    };
    size * text.chars().map(em).sum::<f64>()
}

fn joined(points: impl Iterator<Item = (f64, f64)>) -> String {
    let mut text = String::new();
    for (x, y) in points {
        let gap = if text.is_empty() { "" } else { " " };
        push(&mut text, format_args!("{gap}{},{}", px(x), px(y)));
    }
    text
}

/// A length to a hundredth of a pixel, without idle zeros.
fn px(value: f64) -> impl Display {
    let hundredths = (value * 100.0).round() / 100.0;
    if hundredths == 0.0 { 0.0 } else { hundredths }
}

fn push(text: &mut String, piece: std::fmt::Arguments<'_>) {
    // Writing to a string cannot fail.
    let _ = text.write_fmt(piece);
}

/// Text as XML holds it; characters that XML forbids become spaces.
fn escape(text: &str) -> String {
    let mut safe = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => safe.push_str("&amp;"),
            '<' => safe.push_str("&lt;"),
            '>' => safe.push_str("&gt;"),
            '"' => safe.push_str("&quot;"),
            c if c.is_control() || matches!(c, '\u{fffe}' | '\u{ffff}') => safe.push(' '),
            c => safe.push(c),
        }
    }
    safe
}
