//! What the machine can do: multiply-adds and memory, by one core and by all.

use std::hint::black_box;
use std::time::Instant;

use pulp::{Arch, Simd, WithSimd};

/// The median time of some runs after a first one, s.
pub(crate) fn seconds(mut work: impl FnMut()) -> f64 {
    work();
    let mut times: Vec<f64> = (0..15)
        .map(|_| {
            let began = Instant::now();
            work();
            began.elapsed().as_secs_f64()
        })
        .collect();
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}

/// Sums that do not wait for each other: enough to hide the latency of a multiply-add, and few enough for 16 registers.
const CHAINS: usize = 12;

/// Multiply-adds in registers, nothing else.
#[derive(Clone, Copy)]
struct Fused {
    rounds: usize,
}

impl WithSimd for Fused {
    /// Floating-point operations, and something that depends on all of them.
    type Output = (f64, bool);

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> (f64, bool) {
        let factor = simd.splat_f32s(black_box(0.999));
        let mut sums = [simd.splat_f32s(black_box(1.0)); CHAINS];
        for _ in 0..self.rounds {
            for sum in &mut sums {
                *sum = simd.mul_add_f32s(*sum, factor, factor);
            }
        }
        let total = sums.into_iter().fold(simd.splat_f32s(0.0), |a, b| simd.add_f32s(a, b));
        let width = size_of::<S::f32s>() / size_of::<f32>();
        ((2 * self.rounds * CHAINS * width) as f64, simd.reduce_sum_f32s(total) > 0.0)
    }
}

/// The sum of a long array.
struct Sum<'a>(&'a [f32]);

impl WithSimd for Sum<'_> {
    type Output = f32;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> f32 {
        let (vectors, _) = S::as_simd_f32s(self.0);
        let mut sums = [simd.splat_f32s(0.0); CHAINS];
        for chunk in vectors.chunks_exact(CHAINS) {
            for (sum, &x) in sums.iter_mut().zip(chunk) {
                *sum = simd.add_f32s(*sum, x);
            }
        }
        simd.reduce_sum_f32s(sums.into_iter().fold(simd.splat_f32s(0.0), |a, b| simd.add_f32s(a, b)))
    }
}

/// Calls `work` on that many threads at once.
fn on(threads: usize, work: impl Fn() + Sync) {
    std::thread::scope(|scope| {
        for _ in 0..threads {
            scope.spawn(&work);
        }
    });
}

/// Operations per second in `f32`, a multiply-add counting two.
pub(crate) fn peak(threads: usize) -> f64 {
    let work = Fused { rounds: 4_000_000 };
    let (operations, _) = Arch::new().dispatch(work);
    threads as f64 * operations / seconds(|| on(threads, || _ = black_box(Arch::new().dispatch(work))))
}

/// Bytes read from memory per second: an array eight times the size of a large cache.
pub(crate) fn bandwidth(threads: usize) -> f64 {
    let memory = vec![1.0_f32; 64 << 20];
    let part = memory.len() / threads;
    let next = std::sync::atomic::AtomicUsize::new(0);
    let time = seconds(|| {
        on(threads, || {
            let i = next.fetch_add(1, std::sync::atomic::Ordering::Relaxed) % threads;
            black_box(Arch::new().dispatch(Sum(&memory[i * part..][..part])));
        });
    });
    (part * threads * size_of::<f32>()) as f64 / time
}
