//! Buffers that begin on a cache line, so that no vector straddles two.

use std::ops::{Deref, DerefMut};

use crate::Float;

const LINE: usize = 64;

/// A zeroed buffer aligned to 64 bytes.
#[derive(Debug)]
pub(crate) struct Aligned<F> {
    memory: Vec<F>,
    start: usize,
    len: usize,
}

impl<F: Float> Aligned<F> {
    pub(crate) fn zeroed(len: usize) -> Self {
        let memory = vec![F::ZERO; len + LINE / size_of::<F>()];
        // `align_offset` may decline to answer; then the buffer is merely slower.
        let start = match memory.as_ptr().align_offset(LINE) {
            offset if offset <= LINE / size_of::<F>() => offset,
            _ => 0,
        };
        Self { memory, start, len }
    }
}

impl<F: Float> Clone for Aligned<F> {
    /// A copy elsewhere in memory needs another offset.
    fn clone(&self) -> Self {
        let mut copy = Self::zeroed(self.len);
        copy.copy_from_slice(self);
        copy
    }
}

impl<F> Deref for Aligned<F> {
    type Target = [F];
    #[inline(always)]
    fn deref(&self) -> &[F] {
        &self.memory[self.start..self.start + self.len]
    }
}

impl<F> DerefMut for Aligned<F> {
    #[inline(always)]
    fn deref_mut(&mut self) -> &mut [F] {
        &mut self.memory[self.start..self.start + self.len]
    }
}
