//! The three costly steps, on `faer` and one thread: their bits do not depend on the number of threads, but they may on the
//! width of the processor's vectors.
//!
//! Matrices are row-major slices.

use faer::diag::DiagMut;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::evd::{ComputeEigenvectors, self_adjoint_evd, self_adjoint_evd_scratch};
use faer::linalg::matmul::matmul;
use faer::linalg::matmul::triangular::{self, BlockStructure};
use faer::{Accum, Mat, MatMut, MatRef, Par, Spec};
use hwasp_diff::fast::vectorised;

/// The rows of an m × k times a k × n matrix, written to `product`.
pub(super) fn times(product: &mut [f64], left: &[f64], right: &[f64], m: usize, k: usize, n: usize) {
    matmul(
        MatMut::from_row_major_slice_mut(product, m, n),
        Accum::Replace,
        MatRef::from_row_major_slice(left, m, k),
        MatRef::from_row_major_slice(right, k, n),
        1.0,
        Par::Seq,
    );
}

/// Lower triangle of C ← decay·C + Σ `weights[k]`·`rows[k]`·`rows[k]`ᵀ, for an n × n matrix C.
pub(super) fn add_outer(c: &mut [f64], decay: f64, weights: &[f64], rows: &[f64], n: usize) {
    let mut weighted = rows.to_vec();
    for (row, &w) in weighted.chunks_exact_mut(n).zip(weights) {
        for v in row {
            *v *= w;
        }
    }
    for (i, row) in c.chunks_exact_mut(n).enumerate() {
        vectorised(
            #[inline(always)]
            || row[..=i].iter_mut().for_each(|v| *v *= decay),
        );
    }
    triangular::matmul(
        MatMut::from_row_major_slice_mut(c, n, n),
        BlockStructure::TriangularLower,
        Accum::Add,
        MatRef::from_row_major_slice(&weighted, weights.len(), n).transpose(),
        BlockStructure::Rectangular,
        MatRef::from_row_major_slice(rows, weights.len(), n),
        BlockStructure::Rectangular,
        1.0,
        Par::Seq,
    );
}

/// Σ `weights[k]`·`rows[k]`.
pub(super) fn weighted_sum(weights: &[f64], rows: &[f64], n: usize) -> Vec<f64> {
    let mut sum = vec![0.0; n];
    for (row, &w) in rows.chunks_exact(n).zip(weights) {
        vectorised(
            #[inline(always)]
            || {
                for (s, v) in sum.iter_mut().zip(row) {
                    *s += w * v;
                }
            },
        );
    }
    sum
}

/// Eigenvalues in ascending order, and the eigenvectors as rows, of the symmetric matrix whose lower triangle is in `c`;
/// `None` where there are none in the numbers at hand.
pub(super) fn eigen(c: &[f64], n: usize) -> Option<(Vec<f64>, Vec<f64>)> {
    let mut values = vec![0.0; n];
    let mut vectors = Mat::zeros(n, n);
    let scratch = self_adjoint_evd_scratch::<f64>(n, ComputeEigenvectors::Yes, Par::Seq, Spec::default());
    self_adjoint_evd(
        MatRef::from_row_major_slice(c, n, n),
        DiagMut::from_slice_mut(&mut values),
        Some(vectors.as_mut()),
        Par::Seq,
        MemStack::new(&mut MemBuffer::new(scratch)),
        Spec::default(),
    )
    .ok()?;
    let mut rows = Vec::with_capacity(n * n);
    for k in 0..n {
        rows.extend(vectors.col(k).iter());
    }
    (values.iter().chain(&rows).all(|v| v.is_finite())).then_some((values, rows))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Numbers without a pattern.
    fn numbers(count: usize) -> Vec<f64> {
        (0..count).map(|i| (12.9898 * (i + 1) as f64).sin()).collect()
    }

    /// C = Σ rows·rowsᵀ/n + I.
    fn covariance(n: usize) -> Vec<f64> {
        let mut c: Vec<f64> = (0..n * n).map(|i| if i % (n + 1) == 0 { 1.0 } else { 0.0 }).collect();
        add_outer(&mut c, 1.0, &vec![1.0 / n as f64; n + 3], &numbers(n * (n + 3)), n);
        c
    }

    #[test]
    fn sums_like_the_formula() {
        let (n, count) = (37, 5);
        let (rows, weights) = (numbers(n * count), [0.5, 0.25, 0.1, -0.2, -0.4]);
        let mut c = numbers(n * n);
        let before = c.clone();
        add_outer(&mut c, 0.7, &weights, &rows, n);
        let sum = weighted_sum(&weights, &rows, n);
        for i in 0..n {
            let direct: f64 = (0..count).map(|k| weights[k] * rows[k * n + i]).sum();
            assert!((sum[i] - direct).abs() < 1e-14);
            for j in 0..=i {
                let direct: f64 = (0..count).map(|k| weights[k] * rows[k * n + i] * rows[k * n + j]).sum();
                assert!((c[i * n + j] - 0.7 * before[i * n + j] - direct).abs() < 1e-14, "{i} {j}");
            }
        }
    }

    #[test]
    fn eigenvectors_give_the_matrix_back() {
        let n = 61;
        let c = covariance(n);
        let (values, vectors) = eigen(&c, n).unwrap();
        assert!(values.is_sorted());
        for i in 0..n {
            for j in 0..=i {
                let back: f64 = (0..n).map(|k| values[k] * vectors[k * n + i] * vectors[k * n + j]).sum();
                assert!((back - c[i * n + j]).abs() < 1e-12, "{i} {j}");
            }
        }
        assert_eq!(eigen(&[f64::NAN; 9], 3), None);
    }

    /// Where an array starts in memory changes from run to run; results must not.
    #[test]
    fn bits_do_not_depend_on_alignment() {
        for n in [7, 40, 150] {
            let count = 12;
            let run = |shift: usize| {
                let at = |values: &[f64]| [vec![0.0; shift], values.to_vec()].concat();
                let (mut c, rows) = (at(&covariance(n)), at(&numbers(n * count)));
                add_outer(&mut c[shift..], 0.9, &[0.1; 12], &rows[shift..], n);
                let (values, vectors) = eigen(&c[shift..], n).unwrap();
                let vectors = at(&vectors);
                let mut product = vec![0.0; shift + n * count];
                times(&mut product[shift..], &rows[shift..], &vectors[shift..], count, n, n);
                (c[shift..].to_vec(), values, product[shift..].to_vec())
            };
            let first = run(0);
            for shift in 1..8 {
                assert_eq!(run(shift), first, "{n} {shift}");
            }
        }
    }
}
