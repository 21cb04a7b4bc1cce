//! Elementary functions of `f32` without branches or table look-ups, so that loops over them vectorise.
//!
//! They use fused multiply-adds throughout and therefore give the same bits on every processor; only loops inside
//! [`vectorised`] are fast.

/// Runs `work` compiled for the widest vector instructions of this processor.
///
/// Only what is inlined into `work` profits: mark helpers `#[inline(always)]`.
#[inline]
pub fn vectorised<R>(work: impl FnOnce() -> R) -> R {
    pulp::Arch::new().dispatch(work)
}

/// The vector instructions that [`vectorised`] uses on this processor.
pub fn instructions() -> String {
    format!("{:?}", pulp::Arch::new()).split('(').next().unwrap_or_default().to_owned()
}

/// Adding it to a number rounds that to the nearest integer n and leaves n + 127 in the low bits, which moved into the
/// exponent field are 2ⁿ.
const ROUND: f32 = 12_582_912.0 + 127.0; // 1.5·2²³ and the bias of the exponent

/// 2ⁿ and n, for n = x·scale rounded to an integer in [-126, 127].
#[inline(always)]
fn power_of_two(x: f32, scale: f32) -> (f32, f32) {
    let shifted = x.mul_add(scale, ROUND);
    (f32::from_bits(shifted.to_bits() << 23), shifted - ROUND)
}

/// The hyperbolic tangent within 2.5 units in the last place (measured over every `f32`).
///
/// With x = n·(ln 2)/2 + r, p = 2ⁿ and t = tanh r, the addition theorem makes it
/// (p - 1 + (p + 1)·t)/(p + 1 + (p - 1)·t): no cancellation near zero, and odd to the last bit.
#[inline(always)]
pub fn tanh(x: f32) -> f32 {
    // Beyond 9.02 `f32` tanh is 1 to the last bit. Limits are written so that NaN passes.
    let x = if x > 9.02 { 9.02 } else { x };
    let x = if x < -9.02 { -9.02 } else { x };
    let (power, n) = power_of_two(x, 2.0 * std::f32::consts::LOG2_E);
    // One constant for (ln 2)/2 will do: where its error of 1e-9·n counts in r, it no longer counts in the tangent.
    let r = n.mul_add(-0.5 * std::f32::consts::LN_2, x);
    // tanh r for |r| ≤ (ln 2)/4, relative error 2e-10: a minimax fit by Lawson's iteration.
    let square = r * r;
    let c = square.mul_add(-0.052_725_67, 0.133_311_8);
    let c = square.mul_add(c, -0.333_333_22);
    let t = (r * square).mul_add(c, r);
    let (minus, plus) = (power - 1.0, power + 1.0);
    plus.mul_add(t, minus) / minus.mul_add(t, plus)
}

/// e to the power of `x`, within 1 unit in the last place for arguments in [-87, 88]; beyond, it stays at the ends.
#[inline(always)]
pub fn exp(x: f32) -> f32 {
    let x = x.clamp(-87.0, 88.0);
    let (power, n) = power_of_two(x, std::f32::consts::LOG2_E);
    // ln 2 in two parts (Cody and Waite), and e^r - 1 for |r| ≤ (ln 2)/2 with a relative error of 1.4e-8: a minimax fit.
    let r = n.mul_add(-0.693_145_75, x);
    let r = n.mul_add(-1.428_606_8e-6, r);
    let c = r.mul_add(1.388_250_7e-3, 8.366_596e-3);
    let c = r.mul_add(c, 4.166_72e-2);
    let c = r.mul_add(c, 1.666_654_3e-1);
    let c = r.mul_add(c, 0.5);
    power.mul_add((r * r).mul_add(c, r), power)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The error of `approximate` in units of the last place of the exact result.
    fn ulps(approximate: f32, exact: f64) -> f64 {
        let spacing = f64::from((exact as f32).abs().next_up() - (exact as f32).abs());
        (f64::from(approximate) - exact).abs() / spacing
    }

    /// Every `step`-th positive float up to `limit`.
    fn floats(limit: f32, step: usize) -> impl Iterator<Item = f32> {
        (1..limit.to_bits()).step_by(step).map(f32::from_bits)
    }

    #[test]
    fn tanh_is_within_two_and_a_half_units_in_the_last_place() {
        // HWASP_EXHAUSTIVE=1 visits every float there is below saturation: half a minute optimised.
        let step = if std::env::var_os("HWASP_EXHAUSTIVE").is_some() { 1 } else { 997 };
        let (mut worst, mut at) = (0.0_f64, 0.0);
        for x in floats(12.0, step) {
            let error = ulps(tanh(x), f64::from(x).tanh());
            if error > worst {
                (worst, at) = (error, x);
            }
            assert!(tanh(x) <= 1.0, "tanh({x}) = {} exceeds one", tanh(x));
        }
        println!("tanh: {worst} at {at}");
        assert!(worst < 2.5, "{worst} units at {at}");
        assert_eq!(tanh(-0.3).to_bits(), (-tanh(0.3)).to_bits());
        assert_eq!(tanh(f32::INFINITY), 1.0);
        assert!(tanh(f32::NAN).is_nan());
    }

    #[test]
    fn exp_is_within_one_unit_in_the_last_place() {
        let (mut worst, mut at) = (0.0_f64, 0.0);
        for x in floats(87.0, 997).flat_map(|x| [x, -x]) {
            let error = ulps(exp(x), f64::from(x).exp());
            if error > worst {
                (worst, at) = (error, x);
            }
        }
        println!("exp: {worst} at {at}");
        assert!(worst < 1.0, "{worst} units at {at}");
        assert!(exp(f32::NAN).is_nan());
    }
}
