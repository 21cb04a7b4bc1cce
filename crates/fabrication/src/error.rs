//! What can keep a hand from being made.

use hwasp_tasks::hand::HandError;
use thiserror::Error;

/// Why a part cannot be made.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum PartError {
    /// Numbers that describe no hand, or none that can be built.
    #[error(transparent)]
    Hand(#[from] HandError),
    /// A part that this hand has no room for.
    #[error("{what} takes {:.2} mm, and this hand has {:.2} mm for it\n  = hint: {hint}", 1e3 * needed, 1e3 * room)]
    Room {
        /// What needs room.
        what: String,
        /// How much it needs, m.
        needed: f64,
        /// How much there is, m.
        room: f64,
        /// The way out.
        hint: &'static str,
    },
    /// A part that cannot be made.
    #[error("{part} cannot be made: {message}")]
    Part {
        /// Which.
        part: &'static str,
        /// What is wrong with it.
        message: String,
    },
}
