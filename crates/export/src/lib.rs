//! From a run to a robot on the bench: the result of a run in files that other programs read.
//!
//! A [`Kind`] is what can be asked for. It gives named files, and [`export()`] alone writes them. A new kind needs a variant of
//! [`Kind`], and a function from [`Source`] to files, which [`export()`] calls.

#![forbid(unsafe_code)]

mod contract;
mod controller;
mod deployed;
mod error;
mod export;
mod file;
mod folder;
mod kind;
mod manual;
mod model;
mod onnx;
mod printed;
mod samples;
mod source;

pub use deployed::{Deployed, Layer};
pub use error::ExportError;
pub use export::{MOST_SAMPLES, export};
pub use file::ExportFile;
pub use kind::Kind;
pub use source::Source;
