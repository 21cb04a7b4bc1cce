//! A page that follows trainings, served to a browser on this machine: learning curves, design, terms of the reward, log, the
//! newest controller in three dimensions, and what another design would do.
//!
//! A [`Server`] reads run folders as they lie on the disk, whoever writes them, and writes nothing. It answers GET on
//! a fixed list of paths, and names runs by their places in the list that it was given.

#![forbid(unsafe_code)]

mod about;
mod answer;
mod api;
mod assets;
mod curve;
mod door;
mod follow;
mod list;
mod nice;
mod server;
mod simulate;
mod stamp;
mod worker;

pub use server::{DEFAULT_PORT, Options, Server, StartError, listen};
