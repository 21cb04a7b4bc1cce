//! Numbers as their bits, for serde: every format keeps them all. JSON has no text for infinities and for what is no number,
//! and some readers of it round. In a binary format a list is one string of bytes, little-endian.
//!
//! To be named beside a field: `#[serde(with = "hwasp_core::bits")]`.

use std::fmt;

use serde::de::{Error, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// What has bits, and how they are written.
pub trait Bits: Sized {
    /// Whole numbers of the same width.
    type Plain: Serialize + for<'de> Deserialize<'de>;

    /// The bits.
    fn to_plain(&self) -> Self::Plain;

    /// The number of these bits.
    fn from_plain(plain: Self::Plain) -> Self;

    /// Whether binary formats have it as one string of bytes, and not as whole numbers.
    const AS_BYTES: bool = false;

    /// Those bytes.
    fn to_bytes(&self) -> Vec<u8> {
        Vec::new()
    }

    /// From those bytes; none where they are of no such value.
    fn from_bytes(_bytes: &[u8]) -> Option<Self> {
        None
    }
}

/// A number of a list.
pub trait Number: Bits + Copy {
    /// Bytes of one.
    const SIZE: usize;

    /// Appends its bytes.
    fn push(self, bytes: &mut Vec<u8>);

    /// The number of so many bytes.
    fn read(bytes: &[u8]) -> Option<Self>;
}

impl Number for f32 {
    const SIZE: usize = 4;

    fn push(self, bytes: &mut Vec<u8>) {
        bytes.extend(self.to_le_bytes());
    }

    fn read(bytes: &[u8]) -> Option<Self> {
        bytes.try_into().ok().map(Self::from_le_bytes)
    }
}

impl Number for f64 {
    const SIZE: usize = 8;

    fn push(self, bytes: &mut Vec<u8>) {
        bytes.extend(self.to_le_bytes());
    }

    fn read(bytes: &[u8]) -> Option<Self> {
        bytes.try_into().ok().map(Self::from_le_bytes)
    }
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

impl<T: Number> Bits for Vec<T> {
    type Plain = Vec<T::Plain>;
    const AS_BYTES: bool = true;

    fn to_bytes(&self) -> Vec<u8> {
        let mut bytes = Vec::with_capacity(self.len() * T::SIZE);
        for number in self {
            number.push(&mut bytes);
        }
        bytes
    }

    fn from_bytes(bytes: &[u8]) -> Option<Self> {
        if bytes.len().is_multiple_of(T::SIZE) { bytes.chunks_exact(T::SIZE).map(T::read).collect() } else { None }
    }

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
    if T::AS_BYTES && !serializer.is_human_readable() {
        serializer.serialize_bytes(&value.to_bytes())
    } else {
        value.to_plain().serialize(serializer)
    }
}

/// Reads them.
pub fn deserialize<'de, T: Bits, D: Deserializer<'de>>(deserializer: D) -> Result<T, D::Error> {
    if !T::AS_BYTES || deserializer.is_human_readable() {
        return T::Plain::deserialize(deserializer).map(T::from_plain);
    }
    let bytes = deserializer.deserialize_byte_buf(Bytes)?;
    T::from_bytes(&bytes).ok_or_else(|| D::Error::invalid_length(bytes.len(), &"the bytes of whole numbers"))
}

/// Takes bytes.
struct Bytes;

impl Visitor<'_> for Bytes {
    type Value = Vec<u8>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("bytes")
    }

    fn visit_bytes<E: Error>(self, bytes: &[u8]) -> Result<Vec<u8>, E> {
        Ok(bytes.to_vec())
    }

    fn visit_byte_buf<E: Error>(self, bytes: Vec<u8>) -> Result<Vec<u8>, E> {
        Ok(bytes)
    }
}
