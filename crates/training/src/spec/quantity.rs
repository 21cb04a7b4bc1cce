//! SI numbers written with their unit into resolved files.

use hwasp_core::Dimension;
use serde::Serializer;

use super::values::with_unit;

macro_rules! written {
    ($($name:ident = $dimension:ident),+ $(,)?) => {$(
        #[allow(clippy::trivially_copy_pass_by_ref, reason = "serde's signature")]
        pub(super) fn $name<S: Serializer>(value: &f64, serializer: S) -> Result<S::Ok, S::Error> {
            serializer.serialize_str(&with_unit(*value, Dimension::$dimension))
        }
    )+};
}

written!(
    kilograms = Mass,
    metres = Length,
    newtons = Force,
    newton_metres = Torque,
    radians = Angle,
    newtons_per_metre = Stiffness,
    newton_seconds_per_metre = Damping,
);

/// A limit that may be absent.
#[allow(clippy::ref_option, reason = "serde's signature")]
pub(super) fn newtons_or_none<S: Serializer>(value: &Option<f64>, serializer: S) -> Result<S::Ok, S::Error> {
    match value {
        Some(value) => newtons(value, serializer),
        None => serializer.serialize_str("none"),
    }
}
