//! Loops over the rows of a block, written so that the compiler vectorises them.

use crate::Float;

/// Partial sums kept side by side while rows are added up: one AVX-512 register of `f32`.
pub(super) const LANES: usize = 16;

/// A number per row, or one number for all rows.
pub(super) trait Lane<F: Float>: Copy {
    /// The first `rows` rows; afterwards the compiler can drop its bounds checks.
    fn cut(self, rows: usize) -> Self;
    /// The value in row `i`.
    fn at(self, i: usize) -> F;
    /// The values in rows `i .. i + LANES`.
    fn block(self, i: usize) -> [F; LANES];
}

/// One number for all rows.
#[derive(Clone, Copy)]
pub(super) struct Same<F>(pub(super) F);

/// A number per row.
#[derive(Clone, Copy)]
pub(super) struct Rows<'a, F>(pub(super) &'a [F]);

impl<F: Float> Lane<F> for Same<F> {
    #[inline(always)]
    fn cut(self, _rows: usize) -> Self {
        self
    }
    #[inline(always)]
    fn at(self, _i: usize) -> F {
        self.0
    }
    #[inline(always)]
    fn block(self, _i: usize) -> [F; LANES] {
        [self.0; LANES]
    }
}

impl<F: Float> Lane<F> for Rows<'_, F> {
    #[inline(always)]
    fn cut(self, rows: usize) -> Self {
        Self(&self.0[..rows])
    }
    #[inline(always)]
    fn at(self, i: usize) -> F {
        self.0[i]
    }
    #[inline(always)]
    fn block(self, i: usize) -> [F; LANES] {
        let mut block = [F::ZERO; LANES];
        block.copy_from_slice(&self.0[i..i + LANES]);
        block
    }
}

/// What a row instruction reads.
#[derive(Clone, Copy)]
pub(super) enum Operand<'a, F> {
    /// A uniform value or a constant.
    Same(Same<F>),
    /// An input column or a register.
    Rows(Rows<'a, F>),
}

/// `out[i] = f(a[i])`.
#[inline(always)]
pub(super) fn map1<F: Float>(out: &mut [F], a: impl Lane<F>, f: impl Fn(F) -> F) {
    let rows = out.len();
    let a = a.cut(rows);
    for i in 0..rows {
        out[i] = f(a.at(i));
    }
}

/// `out[i] = f(a[i], b[i])`.
#[inline(always)]
pub(super) fn map2<F: Float>(out: &mut [F], a: impl Lane<F>, b: impl Lane<F>, f: impl Fn(F, F) -> F) {
    let rows = out.len();
    let (a, b) = (a.cut(rows), b.cut(rows));
    for i in 0..rows {
        out[i] = f(a.at(i), b.at(i));
    }
}

/// `out[i] = f(g[i], a[i], b[i], v[i])`, or `out[i] += …` where `add` is set.
#[inline(always)]
pub(super) fn put<F: Float>(
    out: &mut [F],
    add: bool,
    (g, a, b, v): (impl Lane<F>, impl Lane<F>, impl Lane<F>, impl Lane<F>),
    f: impl Fn(F, F, F, F) -> F,
) {
    let rows = out.len();
    let (g, a, b, v) = (g.cut(rows), a.cut(rows), b.cut(rows), v.cut(rows));
    if add {
        for i in 0..rows {
            out[i] += f(g.at(i), a.at(i), b.at(i), v.at(i));
        }
    } else {
        for i in 0..rows {
            out[i] = f(g.at(i), a.at(i), b.at(i), v.at(i));
        }
    }
}

/// The sum of `f(g[i], a[i], b[i], v[i])` over the rows: row `i` goes to lane `i mod LANES`, and the lanes are added as a
/// fixed tree, so that the order never depends on the processor.
#[inline(always)]
pub(super) fn sum<F: Float>(
    rows: usize,
    (g, a, b, v): (impl Lane<F>, impl Lane<F>, impl Lane<F>, impl Lane<F>),
    f: impl Fn(F, F, F, F) -> F,
) -> F {
    let (g, a, b, v) = (g.cut(rows), a.cut(rows), b.cut(rows), v.cut(rows));
    let mut lanes = [F::ZERO; LANES];
    let whole = rows - rows % LANES;
    for start in (0..whole).step_by(LANES) {
        let (g, a, b, v) = (g.block(start), a.block(start), b.block(start), v.block(start));
        for l in 0..LANES {
            lanes[l] += f(g[l], a[l], b[l], v[l]);
        }
    }
    for i in whole..rows {
        lanes[i - whole] += f(g.at(i), a.at(i), b.at(i), v.at(i));
    }
    let mut width = LANES / 2;
    while width > 0 {
        for l in 0..width {
            lanes[l] += lanes[l + width];
        }
        width /= 2;
    }
    lanes[0]
}
