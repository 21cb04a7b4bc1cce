//! Numbers side by side in the vectors of a processor.

use pulp::Simd;

/// A machine number with its vectors. Sealed behind [`Float`](crate::Float).
pub trait Lanes: Copy + 'static {
    /// Rows are padded to multiples of this many numbers: 64 bytes.
    const WIDTH: usize;
    /// A vector of them.
    type Vector<S: Simd>: Copy;
    /// A slice as whole vectors, the rest left out.
    fn vectors<S: Simd>(slice: &[Self]) -> &[Self::Vector<S>];
    /// The same, to write.
    fn vectors_mut<S: Simd>(slice: &mut [Self]) -> &mut [Self::Vector<S>];
    /// One number in every lane.
    fn splat<S: Simd>(simd: S, x: Self) -> Self::Vector<S>;
    /// a·b + c with one rounding.
    fn fused<S: Simd>(simd: S, a: Self::Vector<S>, b: Self::Vector<S>, c: Self::Vector<S>) -> Self::Vector<S>;
}

macro_rules! lanes {
    ($t:ty, $width:expr, $vector:ident, $view:ident, $view_mut:ident, $splat:ident, $fused:ident) => {
        impl Lanes for $t {
            const WIDTH: usize = $width;
            type Vector<S: Simd> = S::$vector;
            #[inline(always)]
            fn vectors<S: Simd>(slice: &[Self]) -> &[S::$vector] {
                S::$view(slice).0
            }
            #[inline(always)]
            fn vectors_mut<S: Simd>(slice: &mut [Self]) -> &mut [S::$vector] {
                S::$view_mut(slice).0
            }
            #[inline(always)]
            fn splat<S: Simd>(simd: S, x: Self) -> S::$vector {
                simd.$splat(x)
            }
            #[inline(always)]
            fn fused<S: Simd>(simd: S, a: S::$vector, b: S::$vector, c: S::$vector) -> S::$vector {
                simd.$fused(a, b, c)
            }
        }
    };
}
lanes!(f32, 16, f32s, as_simd_f32s, as_mut_simd_f32s, splat_f32s, mul_add_f32s);
lanes!(f64, 8, f64s, as_simd_f64s, as_mut_simd_f64s, splat_f64s, mul_add_f64s);
