//! Comparisons: a grid of methods and seeds under one budget, run in parallel, and its statistics.
//!
//! A comparison is a folder. Each cell of the grid is a run folder under `cells/`. A finished cell stays as it is, an unfinished
//! one is resumed, one that failed is told with its reason, and one of another experiment is refused. Several processes may work
//! on one folder.

#![forbid(unsafe_code)]

mod cell;
mod comparison;
mod contender;
mod error;
mod failure;
mod figures;
mod grid;
mod outcome;
mod report;
mod reproduce;
mod saved;
mod table;

pub use cell::{Cell, CellAnswer, CellResult, Watch, Work};
pub use comparison::Comparison;
pub use contender::Contender;
pub use error::CompareError;
pub use failure::{FAILURE, Failure, MissingSeed};
pub use figures::{Figure, MethodFigures, Pair, Reached};
pub use grid::{Grid, run};
pub use outcome::{Contest, MissingCell, Outcome};
pub use report::COMPARISON;
pub use reproduce::{FIGURES, PaperFigure};
pub use saved::SavedComparison;
