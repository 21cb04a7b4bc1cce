//! The products of a 128-wide layer by `faer`, the crate that others would take.

use faer::linalg::matmul::matmul;
use faer::{Accum, Mat, Par};

use super::machine::seconds;

/// Operations per second of C = A·B with A m × k and B k × n, in `f32` on one thread; all stored by columns.
pub(crate) fn product(m: usize, k: usize, n: usize) -> f64 {
    let entry = |i: usize, j: usize| ((i * 31 + j * 17) % 101) as f32 / 101.0;
    let (a, b) = (Mat::from_fn(m, k, entry), Mat::from_fn(k, n, entry));
    let mut c = Mat::<f32>::zeros(m, n);
    let repeats = (20_000 / m.max(n)).max(1);
    let time = seconds(|| {
        for _ in 0..repeats {
            matmul(c.as_mut(), Accum::Replace, a.as_ref(), b.as_ref(), 1.0, Par::Seq);
        }
    });
    (2 * repeats * m * k * n) as f64 / time
}
