//! From a trained hand to parts that can be bought and made.

mod bench;
mod list;
mod spring;

pub use bench::{Bench, BenchError};
pub use list::{
    CatalogueNote, JointDesign, JointParts, PartsList, PartsWorth, PulleyPart, SnappedParameter, SpringPart, TunedWorth,
};
pub use spring::{MUSIC_WIRE_MODULUS, TorsionSpring, music_wire_strength};
