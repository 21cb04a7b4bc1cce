//! Frames of RTDE: a size, a kind, a body, all of it big-endian. Source: the RTDE guide of Universal Robots.

use thiserror::Error;

use super::field::FieldType;

/// Kinds of frames.
pub mod kind {
    /// Asks for a version of the protocol.
    pub const PROTOCOL: u8 = b'V';
    /// Asks for the version of the controller.
    pub const CONTROLLER: u8 = b'v';
    /// A word of the controller to a person.
    pub const TEXT: u8 = b'M';
    /// Values, in the order of a recipe.
    pub const DATA: u8 = b'U';
    /// Chooses what the controller sends.
    pub const OUTPUTS: u8 = b'O';
    /// Chooses what the controller is sent.
    pub const INPUTS: u8 = b'I';
    /// Begins to send.
    pub const START: u8 = b'S';
    /// Sends no more.
    pub const PAUSE: u8 = b'P';
}

/// Size and kind, bytes.
const HEAD: usize = 3;
/// The most bytes that a frame's size can tell, without the head.
pub const LONGEST: usize = u16::MAX as usize - HEAD;

/// Why bytes are no frame, or a body is not what its kind asks for.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
pub enum WireError {
    /// A size that does not even hold its own head.
    #[error("a frame says that it is {0} bytes long; the shortest is 3")]
    Size(u16),
    /// A body that ends too early.
    #[error("the body ends after {has} bytes; {needs} are needed")]
    Short {
        /// Bytes that are there.
        has: usize,
        /// Bytes that would have to be.
        needs: usize,
    },
    /// A body that goes on.
    #[error("the body has {0} bytes too many")]
    Long(usize),
    /// A body that is to be text, and is none.
    #[error("the body is no text")]
    Text,
}

/// One frame.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Frame {
    /// One of [`kind`], or any other byte that was sent.
    pub kind: u8,
    /// What follows the head.
    pub body: Vec<u8>,
}

impl Frame {
    /// A frame of these; a body longer than [`LONGEST`] cannot be told and is `None`.
    pub fn bytes(kind: u8, body: &[u8]) -> Option<Vec<u8>> {
        let size = u16::try_from(body.len() + HEAD).ok()?;
        let mut bytes = Vec::with_capacity(body.len() + HEAD);
        bytes.extend_from_slice(&size.to_be_bytes());
        bytes.push(kind);
        bytes.extend_from_slice(body);
        Some(bytes)
    }
}

/// Cuts a stream of bytes into frames, wherever the pieces of the stream begin and end.
#[derive(Debug, Default)]
pub struct Frames {
    bytes: Vec<u8>,
}

impl Frames {
    /// More of the stream.
    pub fn push(&mut self, bytes: &[u8]) {
        self.bytes.extend_from_slice(bytes);
    }

    /// The next frame, if all of it is there. After an error the stream has no beginning of a frame any more: close it.
    pub fn take(&mut self) -> Result<Option<Frame>, WireError> {
        let [high, low, kind, ..] = self.bytes[..] else {
            return Ok(None);
        };
        let size = u16::from_be_bytes([high, low]);
        if usize::from(size) < HEAD {
            return Err(WireError::Size(size));
        }
        if self.bytes.len() < usize::from(size) {
            return Ok(None);
        }
        let rest = self.bytes.split_off(usize::from(size));
        let frame = std::mem::replace(&mut self.bytes, rest);
        Ok(Some(Frame { kind, body: frame[HEAD..].to_vec() }))
    }
}

/// Reads a body from its beginning to its end.
#[derive(Clone, Copy, Debug)]
pub struct Body<'a>(&'a [u8]);

impl<'a> Body<'a> {
    /// From the beginning.
    pub fn new(bytes: &'a [u8]) -> Self {
        Self(bytes)
    }

    fn take<const N: usize>(&mut self) -> Result<[u8; N], WireError> {
        let (head, rest) = self.0.split_first_chunk().ok_or(WireError::Short { has: self.0.len(), needs: N })?;
        self.0 = rest;
        Ok(*head)
    }

    /// A byte.
    pub fn u8(&mut self) -> Result<u8, WireError> {
        Ok(u8::from_be_bytes(self.take()?))
    }

    /// Two bytes.
    pub fn u16(&mut self) -> Result<u16, WireError> {
        Ok(u16::from_be_bytes(self.take()?))
    }

    /// Four bytes.
    pub fn u32(&mut self) -> Result<u32, WireError> {
        Ok(u32::from_be_bytes(self.take()?))
    }

    /// Four bytes, with sign.
    pub fn i32(&mut self) -> Result<i32, WireError> {
        Ok(i32::from_be_bytes(self.take()?))
    }

    /// A real number.
    pub fn f64(&mut self) -> Result<f64, WireError> {
        Ok(f64::from_be_bytes(self.take()?))
    }

    /// As many real numbers.
    pub fn reals<const N: usize>(&mut self) -> Result<[f64; N], WireError> {
        let mut reals = [0.0; N];
        for real in &mut reals {
            *real = self.f64()?;
        }
        Ok(reals)
    }

    /// The bytes of a value of this type.
    pub fn field(&mut self, kind: FieldType) -> Result<&'a [u8], WireError> {
        let (head, rest) =
            self.0.split_at_checked(kind.size()).ok_or(WireError::Short { has: self.0.len(), needs: kind.size() })?;
        self.0 = rest;
        Ok(head)
    }

    /// All that is left, as text.
    pub fn text(&mut self) -> Result<&'a str, WireError> {
        std::str::from_utf8(std::mem::take(&mut self.0)).map_err(|_| WireError::Text)
    }

    /// Nothing may be left.
    pub fn end(self) -> Result<(), WireError> {
        if self.0.is_empty() { Ok(()) } else { Err(WireError::Long(self.0.len())) }
    }
}
