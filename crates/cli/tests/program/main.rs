//! The program as a user meets it: what it prints, what it writes, what it refuses and with which exit status.
//!
//! A transcript is `$ the command`, standard output, standard error with `! ` before each line, and the exit status.
//! Figures that were measured are `#`.

#![allow(clippy::unwrap_used)] // helpers of tests are tests too

mod arguments;
#[cfg(feature = "mujoco")]
mod begun;
mod comparisons;
mod designs;
#[cfg(target_os = "linux")]
mod errors;
mod experiments;
mod exports;
mod folders;
mod help;
mod judged;
mod parts;
mod pipes;
mod play;
mod printable;
mod projects;
mod reference;
mod report;
#[cfg(unix)]
mod resume;
mod runs;
mod sandbox;
#[cfg(unix)]
mod watch;
