//! Evaluations of CMA-ES to 1e-9, and seconds per generation, for the comparison of `benches/peers`. Prints JSON.
//!
//!     cmaes_evaluations FUNCTION N RUNS        evaluations of each run; null where it failed
//!     cmaes_evaluations cost N GENERATIONS     seconds per generation on the sphere
//!
//! Without arguments: sphere 10 20.

#![allow(clippy::print_stdout)] // a program

use std::time::{Duration, Instant};

use hwasp_algos::{Cmaes, CmaesConfig, Search, SearchError};

/// Generations after which the sphere is begun anew: before it is solved to the last bit.
const GENERATIONS: u64 = 200;

fn value(function: &str, x: &[f64]) -> f64 {
    let last = x.len() as f64 - 1.0;
    match function {
        "ellipsoid" => x.iter().enumerate().map(|(i, v)| 1e6_f64.powf(i as f64 / last) * v * v).sum(),
        "rosenbrock" => x.windows(2).map(|w| 100.0 * (w[1] - w[0] * w[0]).powi(2) + (1.0 - w[0]).powi(2)).sum(),
        _ => x.iter().map(|v| v * v).sum(),
    }
}

fn main() -> Result<(), SearchError> {
    let mut arguments: Vec<String> = std::env::args().skip(1).collect();
    if arguments.is_empty() {
        arguments = ["sphere", "10", "20"].map(String::from).to_vec();
    }
    let [function, n, count] = &arguments[..] else { panic!("FUNCTION N RUNS") };
    let (Ok(n), Ok(count)) = (n.parse::<usize>(), count.parse::<u64>()) else { panic!("N and RUNS are counts") };
    if function == "cost" {
        let mut spent = Duration::ZERO;
        for first in (0..count).step_by(GENERATIONS as usize) {
            let mut search = Cmaes::new(CmaesConfig::default(), &vec![1.0; n], first)?;
            let start = Instant::now();
            for _ in first..count.min(first + GENERATIONS) {
                let scores: Vec<f64> = search.ask().iter().map(|x| -value("sphere", x)).collect();
                search.tell(&scores)?;
            }
            spent += start.elapsed();
        }
        println!("{}", spent.as_secs_f64() / count as f64);
        return Ok(());
    }
    let mut answers = Vec::new();
    let mean = if function == "rosenbrock" { 0.0 } else { 1.0 };
    for seed in 0..count {
        let mut search = Cmaes::new(CmaesConfig::default(), &vec![mean; n], seed)?;
        let mut evaluations = 0;
        let found = loop {
            let values: Vec<f64> = search.ask().iter().map(|x| value(function, x)).collect();
            evaluations += values.len();
            // Whole generations, as the other program counts.
            if values.iter().any(|&v| v <= 1e-9) {
                break Some(evaluations);
            }
            search.tell(&values.iter().map(|v| -v).collect::<Vec<_>>())?;
            if search.stopped().is_some() || evaluations > 1_000_000 {
                break None;
            }
        };
        answers.push(found.map_or_else(|| "null".to_owned(), |e| e.to_string()));
    }
    println!("[{}]", answers.join(", "));
    Ok(())
}
