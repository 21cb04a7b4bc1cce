//! Numbers as their bits, for serde: every format keeps them all. JSON has no text for infinities and for what is no number,
//! and some readers of it round.
//!
//! To be named beside a field: `#[serde(with = "hwasp_core::bits")]`.

use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// What has bits, and how they are written.
pub trait Bits: Sized {
    /// Whole numbers of the same width.
    type Plain: Serialize + for<'de> Deserialize<'de>;

    /// The bits.
    fn to_plain(&self) -> Self::Plain;

    /// The number of these bits.
    fn from_plain(plain: Self::Plain) -> Self;
}

impl Bits for f32 {
    type Plain = u32;

    fn to_plain(&self) -> u32 {
        self.to_bits()
    }

    fn from_plain(plain: u32) -> Self {
        Self::from_bits(plain)
    }
}

impl Bits for f64 {
    type Plain = u64;

    fn to_plain(&self) -> u64 {
        self.to_bits()
    }

    fn from_plain(plain: u64) -> Self {
        Self::from_bits(plain)
    }
}

impl<T: Bits> Bits for Vec<T> {
    type Plain = Vec<T::Plain>;

    fn to_plain(&self) -> Self::Plain {
        self.iter().map(T::to_plain).collect()
    }

    fn from_plain(plain: Self::Plain) -> Self {
        plain.into_iter().map(T::from_plain).collect()
    }
}

impl<A: Bits, B: Bits> Bits for (A, B) {
    type Plain = (A::Plain, B::Plain);

    fn to_plain(&self) -> Self::Plain {
        (self.0.to_plain(), self.1.to_plain())
    }

    fn from_plain((a, b): Self::Plain) -> Self {
        (A::from_plain(a), B::from_plain(b))
    }
}

/// Writes the bits.
pub fn serialize<T: Bits, S: Serializer>(value: &T, serializer: S) -> Result<S::Ok, S::Error> {
    value.to_plain().serialize(serializer)
}

/// Reads them.
pub fn deserialize<'de, T: Bits, D: Deserializer<'de>>(deserializer: D) -> Result<T, D::Error> {
    T::Plain::deserialize(deserializer).map(T::from_plain)
}
