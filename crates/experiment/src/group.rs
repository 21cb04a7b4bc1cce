//! Design parameters by group, and where they can sit.

use hwasp_core::Dimension;
use hwasp_settings::choice;

choice! {
    /// Where a design parameter sits.
    pub enum Place {
        /// In the policy's computational graph (`HWasP`).
        Graph = "graph",
        /// In the action (HWasP-Minimal).
        Action = "action",
        /// In the action, drawn once an episode and held.
        Episode = "episode",
        /// Nowhere: it keeps its first value.
        Fixed = "fixed",
    }
}

/// A group of design parameters that a problem has.
#[derive(Clone, Debug, PartialEq)]
pub struct Group {
    /// Its name.
    pub name: String,
    /// The index of its first parameter in the design.
    pub first: usize,
    /// What it measures.
    pub dimension: Dimension,
    /// How many there are.
    pub count: usize,
    /// Lower limit of each, SI.
    pub lo: f64,
    /// Upper limit of each, SI.
    pub hi: f64,
    /// Where the problem's law lets each begin, SI, where it says so.
    pub initial: Option<f64>,
    /// Whether the world's model is made from it, so that it stays as it is during an episode.
    pub shapes_world: bool,
}
