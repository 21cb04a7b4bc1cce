//! What happens between the products: activations, their derivatives, sums over rows, and the narrow last layer.

use super::mlp::Activation;
use crate::Float;

/// Accumulators of a dot product; enough to hide the latency of the multiply-add on any processor.
const PARALLEL: usize = 16;

/// h = f(z) in place.
#[inline(always)]
pub(super) fn activate<F: Float>(activation: Activation, z: &mut [F]) {
    match activation {
        Activation::Tanh => {
            for z in z {
                *z = z.tanh();
            }
        }
        Activation::Relu => {
            for z in z {
                *z = if *z > F::ZERO { *z } else { F::ZERO };
            }
        }
        Activation::Identity => {}
    }
}

/// d ← d·f'(z), with the derivative expressed by h = f(z).
#[inline(always)]
pub(super) fn differentiate<F: Float>(activation: Activation, h: &[F], d: &mut [F]) {
    match activation {
        Activation::Tanh => {
            for (d, &h) in d.iter_mut().zip(h) {
                *d *= (-h).mul_add(h, F::ONE);
            }
        }
        Activation::Relu => {
            for (d, &h) in d.iter_mut().zip(h) {
                *d = if h > F::ZERO { *d } else { F::ZERO };
            }
        }
        Activation::Identity => {}
    }
}

/// z ← (z - mean)/sqrt(variance + ε) in each row, kept in `normal` with the factor of each row; nothing where `normal` is empty.
#[inline(always)]
pub(super) fn normalize<F: Float>(z: &mut [F], (stride, width): (usize, usize), normal: &mut [F], factors: &mut [F]) {
    if normal.is_empty() {
        return;
    }
    let share = F::from_f64(1.0 / width as f64);
    for (r, z) in z.chunks_exact_mut(stride).enumerate() {
        let z = &mut z[..width];
        let mean = total(z) * share;
        for z in &mut *z {
            *z -= mean;
        }
        let variance = dot(z, z) * share;
        let factor = F::ONE / (variance + F::from_f64(1e-5)).sqrt();
        for z in &mut *z {
            *z *= factor;
        }
        normal[r * stride..][..width].copy_from_slice(z);
        factors[r] = factor;
    }
}

/// d ← dᵀ·∂normal/∂z, which is symmetric, so that tangents go forward by it, too.
#[inline(always)]
pub(super) fn differentiate_normal<F: Float>(
    d: &mut [F],
    (stride, width): (usize, usize),
    normal: &[F],
    factors: &[F],
) {
    let share = F::from_f64(1.0 / width as f64);
    for ((d, normal), &factor) in d.chunks_exact_mut(stride).zip(normal.chunks_exact(stride)).zip(factors) {
        let (d, normal) = (&mut d[..width], &normal[..width]);
        let (mean, along) = (total(d) * share, dot(d, normal) * share);
        for (d, &normal) in d.iter_mut().zip(normal) {
            *d = factor * (*d - mean - normal * along);
        }
    }
}

/// `sum[j] += Σ_r x[r][j]` over rows of `sum.len()` numbers, a multiple of eight.
#[inline(always)]
pub(super) fn add_rows<F: Float>(x: &[F], sum: &mut [F]) {
    // The more columns at once, the more additions are under way; each column keeps its order.
    let width = sum.len();
    let mut j = 0;
    while width - j >= 32 {
        add_columns::<F, 32>(x, width, j, &mut sum[j..]);
        j += 32;
    }
    while j < width {
        add_columns::<F, 8>(x, width, j, &mut sum[j..]);
        j += 8;
    }
}

#[inline(always)]
fn add_columns<F: Float, const N: usize>(x: &[F], width: usize, j: usize, sum: &mut [F]) {
    let mut total = [F::ZERO; N];
    for row in x.chunks_exact(width) {
        let row = &row[j..][..N];
        for l in 0..N {
            total[l] += row[l];
        }
    }
    for l in 0..N {
        sum[l] += total[l];
    }
}

/// x·y in a fixed order of summation.
#[inline(always)]
pub(super) fn dot<F: Float>(x: &[F], y: &[F]) -> F {
    let mut sum = [F::ZERO; PARALLEL];
    let (xs, ys) = (x.chunks_exact(PARALLEL), y.chunks_exact(PARALLEL));
    let rest = xs.remainder().iter().zip(ys.remainder());
    for (x, y) in xs.clone().zip(ys.clone()) {
        for l in 0..PARALLEL {
            sum[l] = x[l].mul_add(y[l], sum[l]);
        }
    }
    for (l, (&x, &y)) in rest.enumerate() {
        sum[l] = x.mul_add(y, sum[l]);
    }
    tree(sum)
}

/// The sum of numbers, in a fixed order.
#[inline(always)]
fn total<F: Float>(x: &[F]) -> F {
    let mut sum = [F::ZERO; PARALLEL];
    let xs = x.chunks_exact(PARALLEL);
    for (l, &x) in xs.remainder().iter().enumerate() {
        sum[l] = x;
    }
    for x in xs {
        for l in 0..PARALLEL {
            sum[l] += x[l];
        }
    }
    tree(sum)
}

/// The sum over column `j` of rows of `width` numbers, in a fixed order.
#[inline(always)]
pub(super) fn sum_column<F: Float>(x: &[F], width: usize, j: usize) -> F {
    let mut sum = [F::ZERO; PARALLEL];
    let rows = x.chunks_exact(PARALLEL * width);
    for (l, row) in rows.remainder().chunks_exact(width).enumerate() {
        sum[l] += row[j];
    }
    for rows in rows {
        for l in 0..PARALLEL {
            sum[l] += rows[l * width + j];
        }
    }
    tree(sum)
}

/// The sum of the accumulators, by halves.
#[inline(always)]
fn tree<F: Float>(mut sum: [F; PARALLEL]) -> F {
    let mut half = PARALLEL / 2;
    while half > 0 {
        for l in 0..half {
            sum[l] += sum[l + half];
        }
        half /= 2;
    }
    sum[0]
}
