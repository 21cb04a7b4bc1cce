//! Matrix products for dense layers, on rows padded to whole vectors.
//!
//! Every element of a result is one chain of fused multiply-adds in the order of the summed index, whatever the tile it is
//! computed in: the bits depend neither on the number of rows nor on the width of the processor's vectors.

use pulp::Simd;

use crate::Float;

/// What a product is added to.
#[derive(Clone, Copy)]
pub(super) enum Onto<'a, F> {
    /// Nothing.
    Zero,
    /// One row, the same for all rows of the result.
    Row(&'a [F]),
    /// What the result holds already.
    Result,
}

/// C = A·B (+ what [`Onto`] says) for row-major A [rows × k] with row stride `lda`, B [k × width], C [rows × width], where
/// `width` is a multiple of [`Lanes::WIDTH`](crate::vectors::Lanes::WIDTH).
#[inline(always)]
#[allow(clippy::too_many_arguments)] // a matrix product has this many
pub(super) fn product<F: Float, S: Simd>(
    simd: S,
    (rows, k, width): (usize, usize, usize),
    a: &[F],
    lda: usize,
    b: &[F],
    onto: Onto<'_, F>,
    c: &mut [F],
) {
    let b = F::vectors::<S>(b);
    let c = F::vectors_mut::<S>(c);
    let columns = width / vector_len::<F, S>();
    let mut n = 0;
    while n < columns {
        if columns - n >= 2 {
            product_columns::<F, S, 2>(simd, (rows, k), a, lda, b, columns, n, onto, c);
            n += 2;
        } else {
            product_columns::<F, S, 1>(simd, (rows, k), a, lda, b, columns, n, onto, c);
            n += 1;
        }
    }
}

/// Numbers in a vector.
#[inline(always)]
const fn vector_len<F: Float, S: Simd>() -> usize {
    size_of::<F::Vector<S>>() / size_of::<F>()
}

#[inline(always)]
#[allow(clippy::too_many_arguments)]
fn product_columns<F: Float, S: Simd, const N: usize>(
    simd: S,
    (rows, k): (usize, usize),
    a: &[F],
    lda: usize,
    b: &[F::Vector<S>],
    columns: usize,
    n: usize,
    onto: Onto<'_, F>,
    c: &mut [F::Vector<S>],
) {
    let mut m = 0;
    // Eight rows at a time fill the 32 registers of AVX-512, four the 16 of AVX2.
    if S::REGISTER_COUNT >= 32 {
        while rows - m >= 8 {
            product_tile::<F, S, 8, N>(simd, k, &a[m * lda..], lda, b, columns, n, onto, &mut c[m * columns..]);
            m += 8;
        }
    }
    while rows - m >= 4 {
        product_tile::<F, S, 4, N>(simd, k, &a[m * lda..], lda, b, columns, n, onto, &mut c[m * columns..]);
        m += 4;
    }
    while m < rows {
        product_tile::<F, S, 1, N>(simd, k, &a[m * lda..], lda, b, columns, n, onto, &mut c[m * columns..]);
        m += 1;
    }
}

#[inline(always)]
#[allow(clippy::too_many_arguments)]
fn product_tile<F: Float, S: Simd, const M: usize, const N: usize>(
    simd: S,
    k: usize,
    a: &[F],
    lda: usize,
    b: &[F::Vector<S>],
    columns: usize,
    n: usize,
    onto: Onto<'_, F>,
    c: &mut [F::Vector<S>],
) {
    let zero = F::splat(simd, F::ZERO);
    let mut sum = [[zero; N]; M];
    match onto {
        Onto::Zero => {}
        Onto::Row(row) => {
            let row = &F::vectors::<S>(row)[n..][..N];
            for m in 0..M {
                sum[m].copy_from_slice(row);
            }
        }
        Onto::Result => {
            for m in 0..M {
                let row = &c[m * columns + n..][..N];
                sum[m].copy_from_slice(row);
            }
        }
    }
    // Slices of the very length k let the compiler drop the bounds checks of the inner loop.
    let a: [&[F]; M] = std::array::from_fn(|m| &a[m * lda..][..k]);
    for i in 0..k {
        let row = &b[i * columns + n..][..N];
        for m in 0..M {
            let x = F::splat(simd, a[m][i]);
            for j in 0..N {
                sum[m][j] = F::fused(simd, x, row[j], sum[m][j]);
            }
        }
    }
    for m in 0..M {
        let row = &mut c[m * columns + n..][..N];
        row.copy_from_slice(&sum[m]);
    }
}

/// C += Aᵀ·B for row-major A [rows × m] with row stride `lda`, B [rows × width], C [m × width].
#[inline(always)]
#[allow(clippy::too_many_arguments)]
pub(super) fn product_transposed<F: Float, S: Simd>(
    simd: S,
    (rows, m, width): (usize, usize, usize),
    a: &[F],
    lda: usize,
    b: &[F],
    c: &mut [F],
) {
    let b = F::vectors::<S>(b);
    let c = F::vectors_mut::<S>(c);
    let columns = width / vector_len::<F, S>();
    let mut n = 0;
    while n < columns {
        if columns - n >= 2 {
            transposed_columns::<F, S, 2>(simd, rows, m, a, lda, b, columns, n, c);
            n += 2;
        } else {
            transposed_columns::<F, S, 1>(simd, rows, m, a, lda, b, columns, n, c);
            n += 1;
        }
    }
}

#[inline(always)]
#[allow(clippy::too_many_arguments)]
fn transposed_columns<F: Float, S: Simd, const N: usize>(
    simd: S,
    rows: usize,
    m: usize,
    a: &[F],
    lda: usize,
    b: &[F::Vector<S>],
    columns: usize,
    n: usize,
    c: &mut [F::Vector<S>],
) {
    let mut i = 0;
    if S::REGISTER_COUNT >= 32 {
        while m - i >= 8 {
            transposed_tile::<F, S, 8, N>(simd, rows, &a[i..], lda, b, columns, n, &mut c[i * columns..]);
            i += 8;
        }
    }
    while m - i >= 4 {
        transposed_tile::<F, S, 4, N>(simd, rows, &a[i..], lda, b, columns, n, &mut c[i * columns..]);
        i += 4;
    }
    // Narrow inputs come in twos: position and speed.
    while m - i >= 2 {
        transposed_tile::<F, S, 2, N>(simd, rows, &a[i..], lda, b, columns, n, &mut c[i * columns..]);
        i += 2;
    }
    while i < m {
        transposed_tile::<F, S, 1, N>(simd, rows, &a[i..], lda, b, columns, n, &mut c[i * columns..]);
        i += 1;
    }
}

#[inline(always)]
#[allow(clippy::too_many_arguments)]
fn transposed_tile<F: Float, S: Simd, const M: usize, const N: usize>(
    simd: S,
    rows: usize,
    a: &[F],
    lda: usize,
    b: &[F::Vector<S>],
    columns: usize,
    n: usize,
    c: &mut [F::Vector<S>],
) {
    let mut sum = [[F::splat(simd, F::ZERO); N]; M];
    for m in 0..M {
        let row = &c[m * columns + n..][..N];
        sum[m].copy_from_slice(row);
    }
    for r in 0..rows {
        let x = &a[r * lda..][..M];
        let row = &b[r * columns + n..][..N];
        for m in 0..M {
            let x = F::splat(simd, x[m]);
            for j in 0..N {
                sum[m][j] = F::fused(simd, x, row[j], sum[m][j]);
            }
        }
    }
    for m in 0..M {
        let row = &mut c[m * columns + n..][..N];
        row.copy_from_slice(&sum[m]);
    }
}
