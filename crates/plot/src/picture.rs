//! Finished pictures.

use crate::options::Theme;
use crate::series::Note;

/// A finished picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Plot {
    /// The SVG document.
    pub svg: String,
    /// What it is to be looked at on: its pixels are finer for print.
    pub theme: Theme,
    /// What the picture does not show, for the user to be told.
    pub notes: Vec<Note>,
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
