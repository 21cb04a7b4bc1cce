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

/// Splits e^x into 2ⁿ and a remainder r with |r| ≤ ln 2/2 (Cody and Waite); returns (2ⁿ, r). For x in [-87, 88].
#[inline(always)]
fn reduce(x: f32) -> (f32, f32) {
    const ROUND: f32 = 12_582_912.0; // 1.5·2²³: adding it rounds to the nearest integer
    let shifted = x.mul_add(std::f32::consts::LOG2_E, ROUND);
    let n = shifted - ROUND;
    let r = n.mul_add(-0.693_145_75, x);
    let r = n.mul_add(-1.428_606_8e-6, r);
    // n sits in the low bits of `shifted`; moved into the exponent field it is 2ⁿ.
    (f32::from_bits((shifted.to_bits() << 23).wrapping_add(0x3f80_0000)), r)
}

/// e^r - 1 for |r| ≤ ln 2/2, relative error 1.4e-8: a minimax fit by Lawson's iteration.
#[inline(always)]
fn exp_m1_reduced(r: f32) -> f32 {
    let p = r.mul_add(1.388_250_7e-3, 8.366_596e-3);
    let p = r.mul_add(p, 4.166_72e-2);
    let p = r.mul_add(p, 1.666_654_3e-1);
    let p = r.mul_add(p, 0.5);
    (r * r).mul_add(p, r)
}

/// The hyperbolic tangent within 2.5 units in the last place (2.48 measured over every `f32`).
///
/// With u = e^2|x| - 1 it is u/(u + 2): no cancellation near zero, and every step is accurate in relative terms.
#[inline(always)]
pub fn tanh(x: f32) -> f32 {
    // Beyond 9.02 `f32` tanh is 1 to the last bit. Limits are written so that NaN passes.
    let a = if x.abs() > 9.02 { 9.02 } else { x.abs() };
    let (power, r) = reduce(2.0 * a);
    let u = power.mul_add(exp_m1_reduced(r), power - 1.0);
    (u / (u + 2.0)).copysign(x)
}

/// e to the power of `x`, within 1 unit in the last place for arguments in [-87, 88]; beyond, it stays at the ends.
///
/// Cody and Waite's reduction and the same polynomial as [`tanh`].
#[inline(always)]
pub fn exp(x: f32) -> f32 {
    let (power, r) = reduce(x.clamp(-87.0, 88.0));
    power.mul_add(exp_m1_reduced(r), power)
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
