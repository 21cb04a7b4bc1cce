//! Comparisons: a grid of methods and seeds under one budget, run in parallel, and its statistics.
//!
//! A comparison is a folder. Each cell of the grid is a run folder under `cells/`. A finished cell stays as it is, an unfinished
//! one is resumed, and one of another experiment is refused.

#![forbid(unsafe_code)]

mod cell;
mod contender;
mod error;
mod figures;
mod grid;
mod report;
mod reproduce;
mod saved;

pub use cell::{Cell, CellResult, Watch};
pub use contender::Contender;
pub use error::CompareError;
pub use figures::{Figure, MethodFigures, Pair, Reached};
pub use grid::{Grid, run};
pub use report::{COMPARISON, Comparison};
pub use reproduce::{FIGURES, PaperFigure};
pub use saved::SavedComparison;
