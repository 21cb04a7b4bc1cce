//! Pictures of runs: the return, the discounted return and each design total against real environment steps or time.
//!
//! A label with one run shows its return as logged (pale) and as a trailing mean (full). Runs that share a label, such as
//! the seeds of one method on one experiment, are drawn as their interquartile mean with a band. Design totals are never
//! smoothed. The picture is SVG text; a PNG is that same SVG drawn with an embedded font.
//!
//! [`views`] draws what shows itself from three sides, [`transmission`] that of a hand with the ways of its tendons.
//! [`closing_plot`] draws the closing chart of a hand with the same panels, [`tornado_plot`] what errors of a design's parameters do.
//! [`curve_panels`] draws each panel as a picture of its own, for pages that arrange them by the width of their reader's screen.

#![forbid(unsafe_code)]

mod axis;
mod bars;
mod closing;
mod curve;
mod curves;
mod draw;
mod error;
mod graph;
mod intervals;
mod options;
mod output;
mod panel;
mod picture;
mod run;
mod series;
mod svg;
mod tornado;
mod trace;
mod transmission;
mod views;

pub use bars::bars;
pub use closing::{closing_panels, closing_plot};
pub use curve::{Curve, DISCOUNTED, RETURN, XAxis};
pub use curves::{curve_panels, curves};
pub use error::{LONGEST_WINDOW, MOST_PANELS, MOST_RUNS, PlotError};
pub use graph::{Drawing, drawing, law_svg};
pub use intervals::{IntervalRow, intervals};
pub use options::{Band, PanelText, PlotOptions, Theme};
pub use output::{embedded_font, render_png, write_plot};
pub use picture::{PanelPlot, PanelPlots, Plot};
pub use run::{curves_svg, plot_options, saved_curve, saved_plot_options};
pub use series::Note;
pub use svg::{Anchor, Svg};
pub use tornado::{TornadoRow, tornado_plot};
pub use trace::{trace, traces};
pub use transmission::transmission;
pub use views::views;
