//! `update`: the equations, by hand. `seam`: what `Search` and the state promise. `solve`: functions solved.

mod seam;
mod solve;
mod update;

use super::{Cmaes, CmaesConfig, Search};

/// Scores: minus a function to be minimised.
fn scores(function: impl Fn(&[f64]) -> f64, candidates: &[Vec<f64>]) -> Vec<f64> {
    candidates.iter().map(|x| -function(x)).collect()
}

fn sphere(x: &[f64]) -> f64 {
    x.iter().map(|v| v * v).sum()
}

/// Condition 1e6.
fn ellipsoid(x: &[f64]) -> f64 {
    let n = x.len() as f64;
    x.iter().enumerate().map(|(i, v)| 1e6_f64.powf(i as f64 / (n - 1.0)) * v * v).sum()
}

fn rosenbrock(x: &[f64]) -> f64 {
    x.windows(2).map(|w| 100.0 * (w[1] - w[0] * w[0]).powi(2) + (1.0 - w[0]).powi(2)).sum()
}

/// Candidates scored until the best is within `target` of zero; `None` if the search stops or `most` is reached first.
fn evaluations(search: &mut Cmaes, function: fn(&[f64]) -> f64, target: f64, most: usize) -> Option<usize> {
    let mut count = 0;
    while count < most && search.stopped().is_none() {
        let scores = scores(function, &search.ask());
        if let Some(at) = scores.iter().position(|&s| s >= -target) {
            return Some(count + at + 1);
        }
        count += scores.len();
        search.tell(&scores).unwrap();
    }
    None
}

fn generations(search: &mut Cmaes, function: impl Fn(&[f64]) -> f64, count: usize) {
    for _ in 0..count {
        let scores = scores(&function, &search.ask());
        search.tell(&scores).unwrap();
    }
}

fn search(config: CmaesConfig, mean: &[f64]) -> Cmaes {
    Cmaes::new(config, mean, 1).unwrap()
}
