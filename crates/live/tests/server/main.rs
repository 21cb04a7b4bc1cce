//! The server as browsers and others meet it, over real connections.

#![allow(clippy::unwrap_used)] // helpers of tests are tests too

mod client;
mod files;
mod flood;
mod paths;
mod runs;
mod strangers;
