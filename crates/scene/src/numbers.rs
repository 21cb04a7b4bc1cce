//! Numbers as text: base64 of their bytes, the lowest first.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;

/// Numbers of 4 bytes each.
pub(crate) fn reals(values: impl IntoIterator<Item = f32>) -> String {
    STANDARD.encode(values.into_iter().flat_map(f32::to_le_bytes).collect::<Vec<u8>>())
}

/// Whole numbers of 2 bytes each.
pub(crate) fn counts(values: impl IntoIterator<Item = u16>) -> String {
    STANDARD.encode(values.into_iter().flat_map(u16::to_le_bytes).collect::<Vec<u8>>())
}
