//! What is built of a law.

use std::any::Any;
use std::fmt::Debug;

use crate::error::AnyError;

/// A format in which other programs read a mechanism.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ModelFormat {
    /// A model of `MuJoCo`.
    Mjcf,
    /// Links and joints, for ROS and its relatives.
    Urdf,
}

/// One of the files that a mechanism is written as.
#[derive(Clone, Debug, PartialEq)]
pub struct ModelFile {
    /// Its place in the folder that it is written to.
    pub name: String,
    /// What is in it.
    pub contents: Vec<u8>,
}

/// A number of a mechanism that is another one with another design.
#[derive(Clone, Debug, PartialEq)]
pub struct Changed {
    /// What it is.
    pub name: String,
    /// The symbol of its SI unit; empty for pure numbers.
    pub unit: String,
    /// With the one design.
    pub before: f64,
    /// With the other.
    pub after: f64,
    /// Whether it follows of numbers that the design sets, and is not set itself.
    pub follows: bool,
}

/// A mechanism as it is built: models, parts, shapes and statics for the numbers of a design.
pub trait Mechanism: Any + Debug + Send + Sync {
    /// For those who know what it is: a hand has pages and printed parts of its own.
    fn as_any(&self) -> &dyn Any;

    /// The formats that it can be written in.
    fn formats(&self) -> Vec<ModelFormat> {
        Vec::new()
    }

    /// The mechanism with a design (SI, as built) in one of its [`formats`](Self::formats).
    ///
    /// # Errors
    /// Where the mechanism cannot have this design, or has no such format.
    fn write(&self, format: ModelFormat, design: &[f64]) -> Result<Vec<ModelFile>, AnyError> {
        let _ = design;
        Err(format!("this mechanism is not written as {format:?}").into())
    }

    /// The numbers that differ between two designs (SI): those that the design sets, then those that follow.
    ///
    /// # Errors
    /// Where the mechanism cannot have one of the designs.
    fn changes(&self, _before: &[f64], _after: &[f64]) -> Result<Vec<Changed>, AnyError> {
        Ok(Vec::new())
    }

    /// What is likely to go wrong with it, though it can be built: for whoever checks an experiment, with ways out. Lines of one
    /// doubt are parted by `\n`.
    fn doubts(&self) -> Vec<String> {
        Vec::new()
    }

    /// The manufacturing errors to reckon with where nobody says others: what is off, by its name or the last word of it, and by
    /// how much, `("radius", "0.1 mm")`.
    fn manufacturing_errors(&self) -> Vec<(String, String)> {
        Vec::new()
    }
}
