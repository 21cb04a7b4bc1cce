//! Episodes in three dimensions: filmed ([`Studio`]), as data ([`Scene`]), and as a page that shows them ([`page`]).
//!
//! Whatever [shows itself](hwasp_core::Environment::look) can be filmed. The page draws with a small WebGL 2 program of its own
//! ([`VIEWER_JS`]) and loads nothing.

#![forbid(unsafe_code)]

mod numbers;
mod page;
mod record;
mod scene;
mod surface;
mod viewer;

pub use page::{data, page, source_hash};
pub use record::{LOOKED_THROUGH, Moment, Studio, Take};
pub use scene::Scene;
pub use viewer::{VIEWER_CSS, VIEWER_JS};
