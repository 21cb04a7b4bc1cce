//! The costly steps of a full covariance. Every sum has one order, whatever the processor: the bits are the same everywhere.
//!
//! Matrices are row-major slices.

use std::array;

use hwasp_diff::fast::vectorised;

/// Partial sums of a product of two vectors: as many as the widest registers hold.
const LANES: usize = 8;
/// Rows that pass over a common one at the same time.
const TOGETHER: usize = 4;

/// C ← decay·C + Σ `weights[k]`·`rows[k]`·`rows[k]`ᵀ in the lower triangle of an n × n matrix C.
pub(super) fn add_outer(c: &mut [f64], decay: f64, weights: &[f64], rows: &[f64], n: usize) {
    for (i, row) in c.chunks_exact_mut(n).enumerate() {
        let row = &mut row[..=i];
        vectorised(
            #[inline(always)]
            || row.iter_mut().for_each(|v| *v *= decay),
        );
        let mut weights = weights.chunks_exact(TOGETHER);
        let mut rows = rows.chunks_exact(TOGETHER * n);
        for (w, block) in weights.by_ref().zip(rows.by_ref()) {
            let scale: [f64; TOGETHER] = array::from_fn(|k| w[k] * block[k * n + i]);
            let of: [&[f64]; TOGETHER] = array::from_fn(|k| &block[k * n..][..=i]);
            vectorised(
                #[inline(always)]
                || add_scaled(row, scale, of),
            );
        }
        for (&w, of) in weights.remainder().iter().zip(rows.remainder().chunks_exact(n)) {
            vectorised(
                #[inline(always)]
                || add_scaled(row, [w * of[i]], [&of[..=i]]),
            );
        }
    }
}

/// `sum` += Σ `scale[k]`·`rows[k]`.
#[inline(always)]
fn add_scaled<const K: usize>(sum: &mut [f64], scale: [f64; K], rows: [&[f64]; K]) {
    let rows = rows.map(|row| &row[..sum.len()]);
    for j in 0..sum.len() {
        sum[j] = (0..K).fold(sum[j], |sum, k| scale[k].mul_add(rows[k][j], sum));
    }
}

/// Σ `weights[k]`·`rows[k]`.
pub(super) fn weighted_sum(weights: &[f64], rows: &[f64], n: usize) -> Vec<f64> {
    let mut sum = vec![0.0; n];
    for (row, &w) in rows.chunks_exact(n).zip(weights) {
        vectorised(
            #[inline(always)]
            || add_scaled(&mut sum, [w], [row]),
        );
    }
    sum
}

/// The products of `a` with each of `rows`.
#[inline(always)]
fn dots<const K: usize>(a: &[f64], rows: [&[f64]; K]) -> [f64; K] {
    let rows = rows.map(|row| &row[..a.len()]);
    let whole = a.len() - a.len() % LANES;
    let mut sums = [[0.0; LANES]; K];
    for j in (0..whole).step_by(LANES) {
        for k in 0..K {
            for lane in 0..LANES {
                sums[k][lane] = a[j + lane].mul_add(rows[k][j + lane], sums[k][lane]);
            }
        }
    }
    array::from_fn(|k| {
        let [a0, a1, a2, a3, a4, a5, a6, a7] = sums[k];
        let sum = ((a0 + a4) + (a2 + a6)) + ((a1 + a5) + (a3 + a7));
        (whole..a.len()).fold(sum, |sum, j| a[j].mul_add(rows[k][j], sum))
    })
}

/// L·v for each of the rows v, with the lower triangle L.
pub(super) fn times(lower: &[f64], rows: &[f64], n: usize) -> Vec<f64> {
    let mut product = vec![0.0; rows.len()];
    for (from, to) in rows.chunks(TOGETHER * n).zip(product.chunks_mut(TOGETHER * n)) {
        vectorised(
            #[inline(always)]
            || {
                for (i, line) in lower.chunks_exact(n).enumerate() {
                    let line = &line[..=i];
                    if from.len() == TOGETHER * n {
                        let of: [&[f64]; TOGETHER] = array::from_fn(|k| &from[k * n..][..=i]);
                        for (k, dot) in dots(line, of).into_iter().enumerate() {
                            to[k * n + i] = dot;
                        }
                    } else {
                        for (k, of) in from.chunks_exact(n).enumerate() {
                            [to[k * n + i]] = dots(line, [&of[..=i]]);
                        }
                    }
                }
            },
        );
    }
    product
}

/// The lower triangle L with C = L·Lᵀ, zeros above, of the symmetric matrix whose lower triangle is in `c`; `None` where C is not
/// positive definite in the numbers at hand.
pub(super) fn cholesky(c: &[f64], n: usize) -> Option<Vec<f64>> {
    let mut lower = c.to_vec();
    for first in (0..n).step_by(TOGETHER) {
        let (above, block) = lower.split_at_mut(first * n);
        let count = TOGETHER.min(n - first);
        let (block, _) = block.split_at_mut(count * n);
        // Columns that the rows above have; then the triangle of the block itself.
        if count == TOGETHER {
            let (a, rest) = block.split_at_mut(n);
            let (b, rest) = rest.split_at_mut(n);
            let (c, d) = rest.split_at_mut(n);
            vectorised(
                #[inline(always)]
                || solve(above, n, &mut [a, b, c, d]),
            );
        } else {
            for row in block.chunks_exact_mut(n) {
                vectorised(
                    #[inline(always)]
                    || solve(above, n, &mut [row]),
                );
            }
        }
        for i in 0..count {
            let (before, row) = block.split_at_mut(i * n);
            let row = &mut row[..n];
            for j in 0..i {
                let other = &before[j * n..][..n];
                let at = first + j;
                row[at] = (row[at] - product(&row[..at], other)) / other[at];
            }
            let at = first + i;
            let square = row[at] - product(&row[..at], row);
            if !(square > 0.0 && square.is_finite()) {
                return None;
            }
            row[at] = square.sqrt();
            row[at + 1..].fill(0.0);
        }
    }
    lower.iter().all(|v| v.is_finite()).then_some(lower)
}

/// The first columns of `rows`, by forward substitution with the finished rows above them.
#[inline(always)]
fn solve<const K: usize>(above: &[f64], n: usize, rows: &mut [&mut [f64]; K]) {
    for (j, finished) in above.chunks_exact(n).enumerate() {
        let known: [f64; K] = dots(&finished[..j], array::from_fn(|k| &rows[k][..j]));
        for k in 0..K {
            rows[k][j] = (rows[k][j] - known[k]) / finished[j];
        }
    }
}

/// The product of two vectors, the second as long as the first.
fn product(a: &[f64], b: &[f64]) -> f64 {
    vectorised(
        #[inline(always)]
        || dots(a, [b])[0],
    )
}

/// Estimates of the shortest and the longest standard deviation in any direction of N(0, L·Lᵀ): a few steps of power iteration.
pub(super) fn extremes(lower: &[f64], n: usize) -> [f64; 2] {
    const STEPS: usize = 4;
    let diagonal = |i: usize| lower[i * (n + 1)];
    let at = |best: fn(f64, f64) -> bool| (1..n).fold(0, |k, i| if best(diagonal(i), diagonal(k)) { i } else { k });
    let unit = |k: usize| (0..n).map(|i| if i == k { 1.0 } else { 0.0 }).collect::<Vec<f64>>();
    // The direction is scaled to length 1 in between; the length after half a step is a deviation.
    let scaled = |v: &mut [f64]| {
        let length = v.iter().map(|v| v * v).sum::<f64>().sqrt();
        for part in v.iter_mut() {
            *part /= length;
        }
        length
    };
    let (mut wide, mut longest) = (unit(at(|a, b| a > b)), 0.0);
    let (mut narrow, mut shortest) = (unit(at(|a, b| a < b)), 0.0);
    for _ in 0..STEPS {
        wide = weighted_sum(&wide, lower, n); // Lᵀ·v
        longest = scaled(&mut wide);
        wide = times(lower, &wide, n);
        scaled(&mut wide);
        forward(lower, &mut narrow, n);
        shortest = scaled(&mut narrow).recip();
        backward(lower, &mut narrow, n);
        scaled(&mut narrow);
    }
    [shortest, longest]
}

/// L⁻¹·v.
fn forward(lower: &[f64], v: &mut [f64], n: usize) {
    for i in 0..n {
        let line = &lower[i * n..][..=i];
        v[i] = (v[i] - product(&line[..i], v)) / line[i];
    }
}

/// L⁻ᵀ·v.
fn backward(lower: &[f64], v: &mut [f64], n: usize) {
    for i in (0..n).rev() {
        let line = &lower[i * n..][..=i];
        v[i] /= line[i];
        let scale = [-v[i]];
        vectorised(
            #[inline(always)]
            || add_scaled(&mut v[..i], scale, [&line[..i]]),
        );
    }
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
    fn the_triangle_gives_the_matrix_back() {
        for n in [1, 3, 4, 61] {
            let c = covariance(n);
            let lower = cholesky(&c, n).unwrap();
            for i in 0..n {
                assert!(lower[i * n + i + 1..(i + 1) * n].iter().all(|&v| v == 0.0));
                for j in 0..=i {
                    let back: f64 = (0..=j).map(|k| lower[i * n + k] * lower[j * n + k]).sum();
                    assert!((back - c[i * n + j]).abs() < 1e-12, "{i} {j}");
                }
            }
            let rows = numbers(5 * n);
            let product = times(&lower, &rows, n);
            for (k, row) in rows.chunks_exact(n).enumerate() {
                for i in 0..n {
                    let direct: f64 = (0..=i).map(|j| lower[i * n + j] * row[j]).sum();
                    assert!((product[k * n + i] - direct).abs() < 1e-12, "{k} {i}");
                }
            }
        }
        assert_eq!(cholesky(&[f64::NAN; 9], 3), None);
        assert_eq!(cholesky(&[1.0, 0.0, 2.0, 1.0], 2), None, "its eigenvalues are -1 and 3");
    }

    /// Deviations from 0.01 to 100 along axes that are turned by a reflection H = I - 2·u·uᵀ.
    #[test]
    fn extreme_deviations_are_found() {
        let n = 9;
        let u: Vec<f64> = (0..n).map(|i| (1.0 + i as f64) / 285.0_f64.sqrt()).collect();
        let turned = |i: usize, k: usize| f64::from(u8::from(i == k)) - 2.0 * u[i] * u[k];
        let deviation = |k: usize| 10.0_f64.powf(k as f64 / 2.0 - 2.0);
        let entry = |i: usize, j: usize| (0..n).map(|k| turned(i, k) * deviation(k).powi(2) * turned(j, k)).sum();
        let c: Vec<f64> = (0..n * n).map(|at| entry(at / n, at % n)).collect();
        let [shortest, longest] = extremes(&cholesky(&c, n).unwrap(), n);
        assert!((shortest / 0.01 - 1.0).abs() < 0.01 && (longest / 100.0 - 1.0).abs() < 0.01, "{shortest} {longest}");
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
                let lower = at(&cholesky(&c[shift..], n).unwrap());
                let product = times(&lower[shift..], &rows[shift..], n);
                (c[shift..].to_vec(), lower[shift..].to_vec(), product)
            };
            let first = run(0);
            for shift in 1..8 {
                assert_eq!(run(shift), first, "{n} {shift}");
            }
        }
    }
}
