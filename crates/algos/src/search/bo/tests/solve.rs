use hwasp_core::{Purpose, stream};
use rand::RngExt;
use rand_distr::StandardNormal;

use super::*;
use crate::search::{RandomConfig, RandomSearch};

/// Branin's function over the unit square; its smallest value is 0.397887 (Forrester, Sóbester and Keane 2008).
fn branin(x: &[f64]) -> f64 {
    let (a, b) = (15.0 * x[0] - 5.0, 15.0 * x[1]);
    let pi = std::f64::consts::PI;
    (b - 5.1 / (4.0 * pi * pi) * a * a + 5.0 / pi * a - 6.0).powi(2) + 10.0 * (1.0 - 1.0 / (8.0 * pi)) * a.cos() + 10.0
}

/// Hartmann's function of six coordinates; its smallest value is -3.32237 (Dixon and Szegő 1978).
fn hartmann(x: &[f64]) -> f64 {
    const A: [[f64; 6]; 4] = [
        [10.0, 3.0, 17.0, 3.5, 1.7, 8.0],
        [0.05, 10.0, 17.0, 0.1, 8.0, 14.0],
        [3.0, 3.5, 1.7, 10.0, 17.0, 8.0],
        [17.0, 8.0, 0.05, 10.0, 0.1, 14.0],
    ];
    const P: [[f64; 6]; 4] = [
        [0.1312, 0.1696, 0.5569, 0.0124, 0.8283, 0.5886],
        [0.2329, 0.4135, 0.8307, 0.3736, 0.1004, 0.9991],
        [0.2348, 0.1451, 0.3522, 0.2883, 0.3047, 0.6650],
        [0.4047, 0.8828, 0.8732, 0.5743, 0.1091, 0.0381],
    ];
    let hill = |(weight, (a, p)): (&f64, (&[f64; 6], &[f64; 6]))| {
        let far: f64 = (0..6).map(|j| a[j] * (x[j] - p[j]).powi(2)).sum();
        weight * (-far).exp()
    };
    -[1.0, 1.2, 3.0, 3.2].iter().zip(A.iter().zip(&P)).map(hill).sum::<f64>()
}

/// The function's value where a search ends, after so many evaluations, with noise of this deviation.
fn end(mut search: impl Search, function: fn(&[f64]) -> f64, evaluations: usize, noise: f64, seed: u64) -> f64 {
    let mut numbers = stream(seed, Purpose::Check, 1, 0);
    for _ in 0..evaluations / 4 {
        let score = |x: &Vec<f64>| -function(x) + noise * numbers.sample::<f64, _>(StandardNormal);
        let scores: Vec<f64> = search.ask().iter().map(score).collect();
        search.tell(&scores).unwrap();
    }
    function(&search.center())
}

/// Where Bayesian and random search end, sorted, over some seeds.
fn ends(function: fn(&[f64]) -> f64, start: &[f64], evaluations: usize, noise: f64, seeds: u64) -> [Vec<f64>; 2] {
    let sorted = |of: &dyn Fn(u64) -> f64| {
        let mut ends: Vec<f64> = (0..seeds).map(of).collect();
        ends.sort_by(f64::total_cmp);
        ends
    };
    let random = |seed| RandomSearch::new(RandomConfig { popsize: 4 }, start.to_vec(), seed).unwrap();
    [
        sorted(&|seed| end(search(start, seed), function, evaluations, noise, seed)),
        sorted(&|seed| end(random(seed), function, evaluations, noise, seed)),
    ]
}

#[test]
fn finds_the_lowest_point_of_branin() {
    let [bo, random] = ends(branin, &[0.5, 0.5], 40, 0.0, 5);
    assert!(bo[4] < 0.397_887 + 0.01, "{bo:?}");
    assert!(bo[4] < random[0], "{bo:?} {random:?}");
}

/// A deviation of 5, a tenth of that of Branin's values.
#[test]
fn finds_it_through_noise() {
    let [bo, random] = ends(branin, &[0.5, 0.5], 60, 5.0, 5);
    assert!(bo[2] < 1.5 && bo[2] < random[2], "{bo:?} {random:?}");
}

#[test]
fn finds_the_lowest_point_of_hartmann() {
    let [bo, random] = ends(hartmann, &[0.5; 6], 80, 0.0, 5);
    assert!(bo[2] < -3.1, "{bo:?}");
    assert!(bo[4] < random[0], "{bo:?} {random:?}");
}
