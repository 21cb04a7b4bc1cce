//! Pictures of runs: the discounted return and each design total against real environment steps or time.
//!
//! A label with one run shows its return as logged (pale) and as a trailing mean (full). Runs that share a label, such as
//! the seeds of one method on one experiment, are drawn as their interquartile mean with a band. Design totals are never
//! smoothed. The picture is SVG text; a PNG is that same SVG drawn with an embedded font.
//!
//! [`closing_plot`] draws the closing chart of a hand with the same panels, [`tornado_plot`] what errors of a design's parameters do.
//! [`curve_panels`] draws each panel as a picture of its own, for pages that arrange them by the width of their reader's screen.

mod axis;
mod bars;
mod closing;
mod draw;
mod intervals;
pub(crate) mod output;
mod panel;
mod series;
pub(crate) mod svg;
mod tornado;
mod trace;

use crate::metrics::{MetricsRow, MetricsTable};
use crate::stats::StatsError;
use std::path::PathBuf;
use thiserror::Error;

pub(crate) use bars::bars;
pub(crate) use closing::closing_panels;
pub use closing::closing_plot;
pub(crate) use intervals::{IntervalRow, intervals};
pub use output::{render_png, write_plot};
pub use series::Note;
pub use tornado::tornado_plot;
pub(crate) use trace::trace;

/// The column of the return, whose panel comes first.
pub const RETURN: &str = "discounted_return";
/// The most panels in a picture.
pub const MOST_PANELS: usize = 24;
/// The most runs in a picture.
pub const MOST_RUNS: usize = 1000;
/// The longest trailing mean, in rows.
pub const LONGEST_WINDOW: usize = 1001;

/// One run.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Curve {
    /// What the legend says; runs with the same label are summarised together.
    pub label: String,
    /// Where each row lies on the horizontal axis; never falling.
    pub x: Vec<f64>,
    /// Mean discounted return of the training episodes, one per row.
    pub discounted_return: Vec<f64>,
    /// The design totals, each with its column name and one SI value per row.
    pub totals: Vec<(String, Vec<f64>)>,
}

impl Curve {
    /// The curve of a run's table. A nominal axis counts `nominal_steps` per iteration.
    pub fn from_table(label: impl Into<String>, table: &MetricsTable, axis: XAxis, nominal_steps: u64) -> Self {
        let x = |row: &MetricsRow| match axis {
            XAxis::WallClock => row.wall_s,
            XAxis::Nominal if nominal_steps > 0 => ((row.iteration + 1) * nominal_steps) as f64,
            XAxis::EnvSteps | XAxis::Nominal => row.env_steps as f64,
        };
        let total = |(place, name): (usize, &String)| {
            (name.clone(), table.rows.iter().filter_map(|row| row.design_totals.get(place).copied()).collect())
        };
        Self {
            label: label.into(),
            x: table.rows.iter().map(x).collect(),
            discounted_return: table.rows.iter().map(|row| row.discounted_return).collect(),
            totals: table.design_totals.iter().enumerate().map(total).collect(),
        }
    }

    fn column(&self, name: &str) -> Option<&[f64]> {
        if name == RETURN {
            return Some(&self.discounted_return);
        }
        self.totals.iter().find(|total| total.0 == name).map(|total| total.1.as_slice())
    }
}

/// What curves are drawn against.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum XAxis {
    /// Real simulator steps.
    #[default]
    EnvSteps,
    /// Time since training began, s.
    WallClock,
    /// Steps as the paper counts them: a nominal number per iteration, whatever an iteration took.
    Nominal,
}

impl XAxis {
    fn label(self) -> &'static str {
        match self {
            Self::EnvSteps => "real environment steps",
            Self::WallClock => "wall-clock time (s)",
            Self::Nominal => "nominal environment steps",
        }
    }
}

/// What a panel's vertical axis says.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PanelText {
    /// The column it is about: [`RETURN`] or a design total's name.
    pub column: String,
    /// What is measured, such as `total stiffness`.
    pub label: String,
    /// The symbol of the unit to draw it in, such as `N/m` or `mm`; empty for a pure number. Values are brought to it from
    /// SI; one that is not known is taken for SI.
    pub unit: String,
    /// A known optimum, SI, drawn as a dashed line.
    pub optimum: Option<f64>,
}

/// What the band around several runs spans.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Band {
    /// The smallest to the largest run.
    #[default]
    MinMax,
    /// The 95 % bootstrap interval of the interquartile mean.
    Bootstrap,
}

/// How a picture is drawn.
///
/// | option | default | what it does | range |
/// |---|---|---|---|
/// | `title` | none | the line above everything | any text |
/// | `x_axis` | `EnvSteps` | what the curves are drawn against; their `x` has to be that | - |
/// | `window` | 11 | rows in the trailing mean of the return | 1 to 1001 |
/// | `band` | `MinMax` | the band around several runs | - |
/// | `panels` | none | axis texts and optima by column; a column without gets its own name | - |
#[derive(Clone, Debug, PartialEq)]
pub struct PlotOptions {
    /// The line above everything; empty for none.
    pub title: String,
    /// What the curves are drawn against.
    pub x_axis: XAxis,
    /// Rows in the trailing mean of the return.
    pub window: usize,
    /// The band around several runs.
    pub band: Band,
    /// Axis texts and optima by column.
    pub panels: Vec<PanelText>,
}

impl Default for PlotOptions {
    fn default() -> Self {
        Self { title: String::new(), x_axis: XAxis::EnvSteps, window: 11, band: Band::MinMax, panels: Vec::new() }
    }
}

/// A finished picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Plot {
    /// The SVG document.
    pub svg: String,
    /// What the picture does not show, for the user to be told.
    pub notes: Vec<Note>,
}

/// Why a picture cannot be drawn or written.
#[derive(Debug, Error)]
pub enum PlotError {
    /// Nothing was given to draw.
    #[error("a plot needs at least one run, and there is none")]
    NoRuns,
    /// More runs than a picture can show.
    #[error("{0} runs are more than {MOST_RUNS} in one plot; plot fewer at a time")]
    Runs(usize),
    /// More design totals than a picture can show.
    #[error(
        "{0} panels are more than {MOST_PANELS} in one plot; plot runs with fewer different design totals together"
    )]
    Panels(usize),
    /// A trailing mean over too few or too many rows.
    #[error("a trailing mean over {0} rows is outside [1, {LONGEST_WINDOW}]; 11 is usual")]
    Window(usize),
    /// A column with another number of values than there are steps.
    #[error("`{label}` has {steps} rows of steps or times but {values} of {series}")]
    Lengths {
        /// The run's label.
        label: String,
        /// The column.
        series: String,
        /// Rows of steps.
        steps: usize,
        /// Rows of the column.
        values: usize,
    },
    /// A figure over the runs cannot be computed.
    #[error(transparent)]
    Stats(#[from] StatsError),
    /// A file name that names no format.
    #[error("`{}` ends neither in .svg nor in .png, so it names no format to write a plot in", path.display())]
    Extension {
        /// The file.
        path: PathBuf,
    },
    /// The SVG cannot be turned into pixels.
    #[error("the plot cannot be drawn as PNG: {0}")]
    Render(String),
    /// The file cannot be written.
    #[error("`{}` cannot be written: {source}", path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
}

/// One panel as a picture of its own.
#[derive(Clone, Debug, PartialEq)]
pub struct PanelPlot {
    /// What is measured, such as `total stiffness`.
    pub label: String,
    /// The SVG document.
    pub svg: String,
}

/// The panels of runs, one by one.
#[derive(Clone, Debug, PartialEq)]
pub struct PanelPlots {
    /// The panels, that of the return first.
    pub panels: Vec<PanelPlot>,
    /// What lines and bands mean.
    pub explanation: String,
    /// What the pictures do not show.
    pub notes: Vec<Note>,
}

/// Draws the runs: one panel for the discounted return and one for each design total, one colour per label.
pub fn curves(runs: &[Curve], options: &PlotOptions) -> Result<Plot, PlotError> {
    let Drawn { panels, entries, explanation, notes } = Drawn::new(runs, options)?;
    let page = draw::Page { title: &options.title, untitled: "learning curves", explanation, ..draw::Page::default() };
    Ok(Plot { svg: draw::picture(&panels, &entries, &page), notes })
}

/// Draws the same panels, each as a small picture of its own without a title; with a legend where there are several labels.
pub fn curve_panels(runs: &[Curve], options: &PlotOptions) -> Result<PanelPlots, PlotError> {
    let Drawn { panels, mut entries, explanation, notes } = Drawn::new(runs, options)?;
    if entries.len() == 1 {
        entries.clear();
    }
    Ok(PanelPlots { panels: draw::one_by_one(panels, &entries, draw::Page::default().reference), explanation, notes })
}

/// What is to be drawn.
struct Drawn<'r> {
    panels: Vec<panel::Panel>,
    entries: Vec<draw::Entry<'r>>,
    explanation: String,
    notes: Vec<Note>,
}

impl<'r> Drawn<'r> {
    fn new(runs: &'r [Curve], options: &PlotOptions) -> Result<Self, PlotError> {
        if runs.is_empty() {
            return Err(PlotError::NoRuns);
        }
        if runs.len() > MOST_RUNS {
            return Err(PlotError::Runs(runs.len()));
        }
        if !(1..=LONGEST_WINDOW).contains(&options.window) {
            return Err(PlotError::Window(options.window));
        }
        // Labels and columns in the order in which they are first seen.
        let mut groups: Vec<Vec<&Curve>> = Vec::new();
        let mut columns = vec![RETURN];
        for run in runs {
            match groups.iter_mut().find(|group| group[0].label == run.label) {
                Some(group) => group.push(run),
                None => groups.push(vec![run]),
            }
            for (name, _) in &run.totals {
                if !columns.contains(&name.as_str()) {
                    columns.push(name);
                }
            }
        }
        if columns.len() > MOST_PANELS {
            return Err(PlotError::Panels(columns.len()));
        }
        let mut notes = Vec::new();
        let mut panels = Vec::new();
        for column in columns {
            let shapes = groups.iter().map(|group| series::shape(group, column, options, &mut notes));
            panels.push(panel::Panel::new(
                text_of(column, options),
                options.x_axis.label(),
                shapes.collect::<Result<_, _>>()?,
            ));
        }
        let entry =
            |(place, group): (usize, &Vec<&'r Curve>)| draw::Entry { place, label: &group[0].label, runs: group.len() };
        let explanation = draw::explanation(&panels, options);
        Ok(Self { panels, entries: groups.iter().enumerate().map(entry).collect(), explanation, notes })
    }
}

/// The panel's text: as given, or the column's own name without underscores.
fn text_of(column: &str, options: &PlotOptions) -> PanelText {
    let given = options.panels.iter().find(|panel| panel.column == column).cloned();
    let mut text = given.unwrap_or_default();
    if text.label.is_empty() {
        text.label = column.replace('_', " ");
    }
    // An optimum that is no number, or dwarfs everything, is no line.
    text.optimum = text.optimum.filter(|value| value.abs() <= series::LARGEST);
    text
}
