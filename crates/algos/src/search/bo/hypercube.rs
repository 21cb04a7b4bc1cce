//! Points that fill the unit cube.

use hwasp_core::Stream;
use rand::RngExt;

/// Designs of which the best is taken.
const DRAWS: usize = 20;

/// A Latin hypercube (`McKay`, Beckman and Conover 1979): in each coordinate one point in each of `count` equal parts. Of some, the
/// one whose nearest points, the given one among them, are farthest from each other (Morris and Mitchell 1995).
pub(super) fn hypercube(given: &[f64], count: usize, stream: &mut Stream) -> Vec<Vec<f64>> {
    let best = (0..DRAWS).map(|_| {
        let points = draw(given.len(), count, stream);
        (nearest(given, &points), points)
    });
    let farther = |a: (f64, Vec<Vec<f64>>), b: (f64, Vec<Vec<f64>>)| if b.0 > a.0 { b } else { a };
    best.reduce(farther).map_or_else(Vec::new, |(_, points)| points)
}

fn draw(dimension: usize, count: usize, stream: &mut Stream) -> Vec<Vec<f64>> {
    let mut points = vec![vec![0.0; dimension]; count];
    for i in 0..dimension {
        let mut parts: Vec<usize> = (0..count).collect();
        for k in (1..count).rev() {
            parts.swap(k, stream.random_range(0..=k));
        }
        for (point, part) in points.iter_mut().zip(parts) {
            point[i] = (part as f64 + stream.random::<f64>()) / count as f64;
        }
    }
    points
}

/// The smallest distance of two points, squared.
fn nearest(given: &[f64], points: &[Vec<f64>]) -> f64 {
    let distance = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>();
    let of = |(i, point): (usize, &Vec<f64>)| {
        points[..i].iter().fold(distance(given, point), |least, other| least.min(distance(point, other)))
    };
    points.iter().enumerate().map(of).fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    use hwasp_core::{Purpose, stream};

    use super::*;

    #[test]
    fn every_part_of_every_coordinate_has_a_point() {
        let count = 12;
        let points = hypercube(&[0.5; 3], count, &mut stream(1, Purpose::FirstPoints, 0, 0));
        for i in 0..3 {
            let mut parts: Vec<usize> = points.iter().map(|p| (p[i] * count as f64) as usize).collect();
            parts.sort_unstable();
            assert_eq!(parts, (0..count).collect::<Vec<_>>());
        }
        // Not one beside another.
        assert!(nearest(&[0.5; 3], &points) > 0.2_f64.powi(2));
    }
}
