//! Safetensors: ours written, those of strangers looked at first.

use std::collections::HashMap;

use safetensors::tensor::{Dtype, Metadata, TensorView};
use safetensors::{SafeTensorError, serialize};

/// An array to be written.
pub struct Piece {
    name: String,
    dtype: Dtype,
    shape: Vec<usize>,
    bytes: Vec<u8>,
}

impl Piece {
    /// In single precision.
    pub fn f32(name: String, shape: Vec<usize>, values: &[f32]) -> Self {
        Self { name, dtype: Dtype::F32, shape, bytes: values.iter().flat_map(|v| v.to_le_bytes()).collect() }
    }

    /// In double precision.
    pub fn f64(name: String, shape: Vec<usize>, values: &[f64]) -> Self {
        Self { name, dtype: Dtype::F64, shape, bytes: values.iter().flat_map(|v| v.to_le_bytes()).collect() }
    }
}

/// The bytes of a file with these arrays and this metadata.
pub fn serialized<const N: usize>(pieces: &[Piece], about: [(&str, String); N]) -> Result<Vec<u8>, SafeTensorError> {
    let views = pieces
        .iter()
        .map(|piece| Ok((&piece.name, TensorView::new(piece.dtype, piece.shape.clone(), &piece.bytes)?)))
        .collect::<Result<Vec<_>, SafeTensorError>>()?;
    let about: HashMap<String, String> = about.into_iter().map(|(key, value)| (key.to_owned(), value)).collect();
    serialize(views, Some(about))
}

/// The longest header that is read, bytes: tens of thousands of tensors. While it is read it takes eighteen times its length,
/// and the format allows 100 MB.
const LONGEST_HEADER: u64 = 4 << 20;

/// Refuses a file whose header is too long, or whose tensors claim to reach far beyond its end: the format's own reader adds
/// to where they end before it looks, and the sum overflows. Whatever else is wrong it finds itself.
pub(crate) fn check_header(bytes: &[u8]) -> Result<(), SafeTensorError> {
    let Some((length, rest)) = bytes.split_first_chunk() else { return Ok(()) };
    let length = u64::from_le_bytes(*length);
    if length > LONGEST_HEADER {
        return Err(SafeTensorError::HeaderTooLarge);
    }
    match rest.get(..length as usize).map(serde_json::from_slice::<Metadata>) {
        Some(Ok(header)) if header.data_len() > bytes.len() => Err(SafeTensorError::MetadataIncompleteBuffer),
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Eight tensors of 2^61 - 8 bytes, the most whose bits can be counted, end at 2^64 - 64; to that the reader adds the
    /// length of the header.
    #[test]
    fn ends_that_overflow_are_refused() {
        let (elements, mut end) = ((1_u64 << 58) - 1, 0);
        let tensors = (0..8).map(|i| {
            let begin = end;
            end += 8 * elements;
            format!(r#""{i}":{{"dtype":"F64","shape":[{elements}],"data_offsets":[{begin},{end}]}}"#)
        });
        let header = format!("{{{}}}", tensors.collect::<Vec<_>>().join(","));
        let file = [&(header.len() as u64).to_le_bytes()[..], header.as_bytes()].concat();
        assert_eq!(end, u64::MAX - 63);
        assert!(matches!(check_header(&file), Err(SafeTensorError::MetadataIncompleteBuffer)));
    }
}
