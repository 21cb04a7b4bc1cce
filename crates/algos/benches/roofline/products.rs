//! The products of a 128-wide layer by `nalgebra`, that is by the kernels of `matrixmultiply`: what others would take.

use nalgebra::DMatrix;

use super::machine::seconds;

/// Operations per second of C = A·B with A m × k and B k × n, in `f32` on one thread; all stored by columns.
pub(crate) fn product(m: usize, k: usize, n: usize) -> f64 {
    let entry = |i: usize, j: usize| ((i * 31 + j * 17) % 101) as f32 / 101.0;
    let (a, b) = (DMatrix::from_fn(m, k, entry), DMatrix::from_fn(k, n, entry));
    let mut c = DMatrix::<f32>::zeros(m, n);
    let repeats = (20_000 / m.max(n)).max(1);
    let time = seconds(|| {
        for _ in 0..repeats {
            c.gemm(1.0, &a, &b, 0.0);
        }
    });
    (2 * repeats * m * k * n) as f64 / time
}
