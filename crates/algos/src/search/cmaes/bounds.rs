//! Limits of the coordinates.
//!
//! The distribution lives in an unbounded space; a candidate is its image under a map into the bounds, the linear-quadratic
//! one of Hansen's `cma` package. So no sample is thrown away or moved in the space where the covariance is learned. For a
//! coordinate with the bounds l and u, and a margin a beside each of them,
//!
//! - the map is the identity in [l + a, u - a], about nine tenths of the interval;
//! - l + (y - (l - a))²/(4a) in [l - a, l + a], which joins with slope one and reaches l with slope zero; the same,
//!   mirrored, at u;
//! - beyond l - a and u + a it is mirrored: continuous, with period 2(u - l + 2a) if both bounds are finite.

use super::CmaesConfig;

/// The map from the unbounded space to the candidates.
#[derive(Clone, Debug)]
pub(super) struct Bounds {
    /// Lower bound, upper bound and margins of each coordinate; none if nothing is bounded.
    limits: Option<Vec<Limit>>,
}

#[derive(Clone, Copy, Debug)]
struct Limit {
    lower: f64,
    upper: f64,
    below: f64,
    above: f64,
}

/// The width over which the map bends: a twentieth of the bound's magnitude, or less in a narrow interval.
fn margin(bound: f64, width: f64) -> f64 {
    if bound.is_finite() { (width / 2.0).min((1.0 + bound.abs()) / 20.0) } else { 0.0 }
}

impl Bounds {
    pub(super) fn new(config: &CmaesConfig, dimension: usize) -> Self {
        let limit = |i| {
            let (lower, upper) = config.bound(i);
            Limit { lower, upper, below: margin(lower, upper - lower), above: margin(upper, upper - lower) }
        };
        let bounded = config.lower.is_some() || config.upper.is_some();
        Self { limits: bounded.then(|| (0..dimension).map(limit).collect()) }
    }

    /// Replaces a point of the unbounded space by its candidate.
    pub(super) fn candidate(&self, point: &mut [f64]) {
        for (y, limit) in point.iter_mut().zip(self.limits.iter().flatten()) {
            *y = limit.candidate(*y);
        }
    }

    /// The point next to the candidate `x` whose image it is.
    pub(super) fn point(&self, x: &[f64]) -> Vec<f64> {
        let mut point = x.to_vec();
        for (y, limit) in point.iter_mut().zip(self.limits.iter().flatten()) {
            *y = limit.point(*y);
        }
        point
    }
}

impl Limit {
    fn candidate(&self, mut y: f64) -> f64 {
        let (first, last) = (self.lower - self.below, self.upper + self.above);
        if first.is_finite() && last.is_finite() {
            let width = last - first;
            // The offset in a period; its second half goes backwards.
            let offset = (y - first).rem_euclid(2.0 * width);
            // Untouched where nothing is mirrored: `first + offset` would round.
            if !(first..=last).contains(&y) {
                y = first + if offset > width { 2.0 * width - offset } else { offset };
            }
        } else if y < first {
            y = first + (first - y);
        } else if y > last {
            y = last - (y - last);
        }
        if y < self.lower + self.below {
            y = self.lower + (y - first).powi(2) / (4.0 * self.below);
        } else if y > self.upper - self.above {
            y = self.upper - (y - last).powi(2) / (4.0 * self.above);
        }
        y.clamp(self.lower, self.upper) // rounding
    }

    fn point(&self, x: f64) -> f64 {
        if x < self.lower + self.below {
            self.lower - self.below + 2.0 * (self.below * (x - self.lower)).sqrt()
        } else if x > self.upper - self.above {
            self.upper + self.above - 2.0 * (self.above * (self.upper - x)).sqrt()
        } else {
            x
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn bounds(lower: f64, upper: f64) -> Bounds {
        Bounds::new(&CmaesConfig { lower: Some(vec![lower]), upper: Some(vec![upper]), ..CmaesConfig::default() }, 1)
    }

    fn image(bounds: &Bounds, y: f64) -> f64 {
        let mut point = [y];
        bounds.candidate(&mut point);
        point[0]
    }

    /// Bounds 1 and 3: margins (1 + 1)/20 = 0.1 and (1 + 3)/20 = 0.2, and a period of 2·(3.2 - 0.9) = 4.6.
    #[test]
    fn the_map_by_hand() {
        let b = bounds(1.0, 3.0);
        let cases = [(2.0, 2.0), (0.9, 1.0), (1.0, 1.025), (1.1, 1.1), (3.2, 3.0), (3.1, 2.9875), (0.8, 1.025)];
        for (y, x) in cases {
            for period in [-2.0, 0.0, 1.0] {
                assert!((image(&b, y + period * 4.6) - x).abs() < 1e-12, "{y} {period}");
            }
        }
    }

    #[test]
    fn one_bound_alone() {
        let below = bounds(0.0, f64::INFINITY);
        assert_eq!((image(&below, 7.0), image(&below, -7.0 - 0.1)), (7.0, 7.0));
        let above = bounds(f64::NEG_INFINITY, 0.0);
        assert_eq!((image(&above, -7.0), image(&above, 7.0 + 0.1)), (-7.0, -7.0));
        let neither = bounds(f64::NEG_INFINITY, f64::INFINITY);
        assert_eq!(image(&neither, -1e9), -1e9);
    }

    proptest! {
        #[test]
        fn never_outside(lower in -1e6..1e6_f64, width in 1e-9..1e9_f64, y in prop::num::f64::NORMAL) {
            let b = bounds(lower, lower + width);
            let x = image(&b, y.clamp(-1e150, 1e150));
            prop_assert!((lower..=lower + width).contains(&x));
        }

        #[test]
        fn a_candidate_has_its_point(lower in -1e3..1e3_f64, width in 1e-3..1e3_f64, share in 0.0..=1.0_f64) {
            let b = bounds(lower, lower + width);
            let x = (lower + share * width).clamp(lower, lower + width);
            let y = b.point(&[x])[0];
            prop_assert!((image(&b, y) - x).abs() <= 1e-9 * (1.0 + lower.abs() + width));
        }
    }
}
