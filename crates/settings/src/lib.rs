//! Settings described once.
//!
//! A struct of settings lists its fields in one method, with key, limits and meaning ([`Settings::fields`]). That one text
//! does four things: it reads a file and checks it, writes a resolved file, makes the rows of the reference ([`Field::row`]),
//! and makes the JSON Schema ([`object_schema`]). The value of a field before it is read is its default.
//!
//! Files come in layers ([`Layers`]), and later ones win. Every value keeps its place in a file, so that each [`Fault`] can
//! show its line. All faults are reported at once. Files may be hostile, so their size, their counts and their numbers have
//! limits.
//!
//! ```
//! use hwasp_core::Dimension;
//! use hwasp_settings::{Fields, Settings, described};
//!
//! struct Lamp {
//!     mass: f64,
//! }
//!
//! impl Settings for Lamp {
//!     fn fields(&mut self, fields: &mut Fields<'_, '_>) {
//!         fields.quantity("mass", &mut self.mass, Dimension::Mass, 0.01..=10.0, "of the lamp");
//!     }
//! }
//!
//! let fields = described(&mut Lamp { mass: 0.5 });
//! assert_eq!(fields[0].row(), "| `mass` | \"0.5 kg\" | of the lamp | 0.01 to 10 kg |");
//! ```

#![forbid(unsafe_code)]

mod any;
mod choice;
mod fault;
mod field;
mod fields;
mod folder;
mod item;
mod layers;
mod schema;
mod section;
mod source;
mod suggest;
pub mod text;
mod tree;
mod values;

pub use any::AnySettings;
pub use choice::Choice;
pub use fault::{Excerpt, Fault, Faults};
pub use field::{Field, Kind};
pub use fields::{Fields, Settings, described, read, written};
pub use folder::{Files, Folder, FolderError, inside};
pub use item::{Item, Keys};
pub use layers::{LONGEST_FILE, Layers};
pub use schema::object_schema;
pub use section::{Reader, Section};
pub use source::Origin;
pub use suggest::{either, listed, nearest};
pub use tree::{Entry, Node, Table, Value};
pub use values::with_unit;
