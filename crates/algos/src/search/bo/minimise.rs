//! Minima of smooth functions in a box.

use std::cmp::Ordering;
use std::collections::VecDeque;

/// Pairs of steps and changes of the gradient that are kept.
const KEPT: usize = 10;
/// The decrease that a step must reach, as a share of what the slope promises.
const DECREASE: f64 = 1e-4;
/// The most halvings of a step.
const HALVINGS: usize = 30;
/// A gradient or a relative decrease below this ends the search.
const TOLERANCE: f64 = 1e-8;

/// A function's value and gradient; none where it has no value.
pub(super) type Evaluation = Option<(f64, Vec<f64>)>;

/// A lower point of a function within limits, with its value: at most so many steps of L-BFGS (Nocedal 1980) in the coordinates
/// that no limit holds, along lines that are bent onto the box (Bertsekas 1982). None where the function has no value at the
/// start.
pub(super) fn minimise(
    start: &[f64],
    limits: &[(f64, f64)],
    steps: usize,
    mut function: impl FnMut(&[f64]) -> Evaluation,
) -> Option<(Vec<f64>, f64)> {
    let mut x = start.to_vec();
    let (mut value, mut gradient) = function(&x)?;
    let mut kept = VecDeque::new();
    for _ in 0..steps {
        let held = |(i, g): (usize, &f64)| {
            let (lower, upper) = limits[i];
            if (x[i] <= lower && *g > 0.0) || (x[i] >= upper && *g < 0.0) { 0.0 } else { *g }
        };
        let free: Vec<f64> = gradient.iter().enumerate().map(held).collect();
        let steepest = free.iter().fold(0.0_f64, |most, g| most.max(g.abs()));
        if steepest <= TOLERANCE {
            break;
        }
        let mut along = direction(&free, &kept);
        // NaN, too, leads nowhere.
        if dot(&along, &free).partial_cmp(&0.0) != Some(Ordering::Less) {
            kept.clear();
            along = direction(&free, &kept);
        }
        // Without curvature, a first step of a tenth of the box's usual width.
        let mut length = if kept.is_empty() { (0.1 / steepest).min(1.0) } else { 1.0 };
        let lower = (0..HALVINGS).find_map(|_| {
            let to = |((x, d), (lower, upper)): ((&f64, &f64), &(f64, f64))| (x + length * d).clamp(*lower, *upper);
            let next: Vec<f64> = x.iter().zip(&along).zip(limits).map(to).collect();
            let step: Vec<f64> = next.iter().zip(&x).map(|(a, b)| a - b).collect();
            length /= 2.0;
            let (found, slope) = function(&next)?;
            (found <= value + DECREASE * dot(&gradient, &step)).then_some((next, step, found, slope))
        });
        let Some((next, step, found, slope)) = lower else {
            if kept.is_empty() {
                break;
            }
            kept.clear();
            continue;
        };
        let change: Vec<f64> = slope.iter().zip(&gradient).map(|(a, b)| a - b).collect();
        let decrease = value - found;
        (x, value, gradient) = (next, found, slope);
        if decrease <= TOLERANCE * value.abs().max(1.0) {
            break;
        }
        let curvature = dot(&step, &change);
        if curvature > 1e-10 * dot(&change, &change) {
            kept.truncate(KEPT - 1);
            kept.push_front((step, change, curvature));
        }
    }
    Some((x, value))
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// -H·gradient in the coordinates where the gradient is not 0, by the two loops over steps and changes, the newest first.
fn direction(gradient: &[f64], kept: &VecDeque<(Vec<f64>, Vec<f64>, f64)>) -> Vec<f64> {
    let mut along: Vec<f64> = gradient.iter().map(|g| -g).collect();
    let mut shares = Vec::with_capacity(kept.len());
    for (step, change, curvature) in kept {
        let share = dot(step, &along) / curvature;
        along.iter_mut().zip(change).for_each(|(a, c)| *a -= share * c);
        shares.push(share);
    }
    if let Some((_, change, curvature)) = kept.front() {
        let scale = curvature / dot(change, change);
        for a in &mut along {
            *a *= scale;
        }
    }
    for ((step, change, curvature), share) in kept.iter().zip(shares).rev() {
        let back = share - dot(change, &along) / curvature;
        along.iter_mut().zip(step).for_each(|(a, s)| *a += back * s);
    }
    along.iter_mut().zip(gradient).for_each(|(a, &g)| *a = if g == 0.0 { 0.0 } else { *a });
    along
}

#[cfg(test)]
mod tests {
    use super::*;

    #[allow(clippy::unnecessary_wraps)] // functions may have no value
    fn rosenbrock(x: &[f64]) -> Evaluation {
        let (a, b) = (1.0 - x[0], x[1] - x[0] * x[0]);
        Some((a * a + 100.0 * b * b, vec![-2.0 * a - 400.0 * b * x[0], 200.0 * b]))
    }

    #[test]
    fn finds_the_bottom_of_a_bent_valley() {
        let (x, value) = minimise(&[-1.2, 1.0], &[(-2.0, 2.0); 2], 200, rosenbrock).unwrap();
        assert!(value < 1e-10 && (x[0] - 1.0).abs() < 1e-4, "{x:?} {value}");
    }

    /// With x at most 0.5, the lowest point is (0.5, 0.25), at (1 - 0.5)².
    #[test]
    fn stops_at_a_limit() {
        let (x, value) = minimise(&[-1.2, 1.0], &[(-2.0, 0.5), (-2.0, 2.0)], 200, rosenbrock).unwrap();
        assert!(x[0] == 0.5 && (x[1] - 0.25).abs() < 1e-5 && (value - 0.25).abs() < 1e-9, "{x:?} {value}");
    }

    /// x - log x has no value from 0 down.
    #[test]
    fn goes_round_where_there_is_no_value() {
        let function = |x: &[f64]| (x[0] > 0.0).then(|| (x[0] - x[0].ln(), vec![1.0 - 1.0 / x[0]]));
        let (x, _) = minimise(&[9.0], &[(-10.0, 10.0)], 100, function).unwrap();
        assert!((x[0] - 1.0).abs() < 1e-4, "{x:?}");
        assert_eq!(minimise(&[-1.0], &[(-10.0, 10.0)], 100, function), None);
    }
}
