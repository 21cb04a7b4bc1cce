//! What is built of a law.

use std::any::Any;
use std::fmt::Debug;

/// A mechanism as it is built: parts, shapes and statics for the numbers of a design.
pub trait Mechanism: Any + Debug + Send + Sync {
    /// For those who know what it is: a hand has pages of its own.
    fn as_any(&self) -> &dyn Any;

    /// The manufacturing errors to reckon with where nobody says others: what is off, by its name or the last word of it, and by
    /// how much, `("radius", "0.1 mm")`.
    fn manufacturing_errors(&self) -> Vec<(String, String)> {
        Vec::new()
    }
}
