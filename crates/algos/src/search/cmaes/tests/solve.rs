use super::*;
use crate::search::Stop;

#[test]
fn sphere_ellipsoid_and_rosenbrock() {
    for (function, most) in [(sphere as fn(&[f64]) -> f64, 3_000), (ellipsoid, 9_000), (rosenbrock, 12_000)] {
        for seed in 0..3 {
            let mut search = Cmaes::new(CmaesConfig::default(), &[0.1; 10], seed).unwrap();
            assert!(evaluations(&mut search, function, 1e-9, most).is_some());
        }
    }
}

/// Scales from 1 to 1000. A full covariance of this size would have a million elements.
#[test]
fn separable_solves_a_separable_ellipsoid_of_a_thousand() {
    let config = CmaesConfig { separable: true, ..CmaesConfig::default() };
    let mut search = search(config, &vec![1.0; 1000]);
    let scaled = |x: &[f64]| x.iter().enumerate().map(|(i, v)| (1.0 + i as f64) * v * v).sum();
    assert!(evaluations(&mut search, scaled, 1e-2, 120_000).is_some());
    assert_eq!((search.state.covariance.len(), search.state.factor.len()), (1000, 0));
}

#[test]
fn the_optimum_at_a_bound_is_found() {
    let config = CmaesConfig { lower: Some(vec![1.0; 5]), upper: Some(vec![2.0; 5]), ..CmaesConfig::default() };
    let mut search = search(config, &[1.5; 5]);
    generations(&mut search, sphere, 150);
    let (best, score) = search.best().unwrap();
    assert!((score + 5.0).abs() < 1e-9 && best.iter().all(|x| (x - 1.0).abs() < 1e-6), "{best:?}");
    assert!(search.center().iter().all(|x| (x - 1.0).abs() < 1e-6));
}

/// Rastrigin's function has local optima around the start; a larger population sees past them.
#[test]
fn restarts_leave_local_optima() {
    let rastrigin = |x: &[f64]| x.iter().map(|v| 10.0 + v * v - 10.0 * (std::f64::consts::TAU * v).cos()).sum();
    let solved = |restarts| {
        let config = CmaesConfig { restarts, sigma: 1.0, ..CmaesConfig::default() };
        let mut search = search(config, &[2.3; 5]);
        evaluations(&mut search, rastrigin, 1e-9, 200_000).is_some()
    };
    assert!(!solved(0) && solved(6));
}

#[test]
fn every_run_says_why_it_stopped() {
    let run = |function: fn(&[f64]) -> f64, config: CmaesConfig, mean: &[f64]| {
        let mut search = search(config, mean);
        for _ in 0..20_000 {
            generations(&mut search, function, 1);
            if let Some(stop) = search.stopped() {
                return Some(stop);
            }
        }
        None
    };
    let base = CmaesConfig::default;
    assert_eq!(run(|x| -x[0], base(), &[0.0; 3]), Some(Stop::TolXUp));
    assert_eq!(run(sphere, base(), &[1.0; 3]), Some(Stop::TolFun));
    // Large values: their differences never get below 1e-12, but the steps do.
    assert_eq!(run(|x| 1e30 * sphere(x), base(), &[1.0; 3]), Some(Stop::TolX));
    // Steps too small beside the mean.
    assert_eq!(run(sphere, CmaesConfig { sigma: 1e-17, ..base() }, &[1.0; 3]), Some(Stop::NoEffectCoord));
    // Two coordinates whose scales differ by 1e8.
    assert_eq!(run(|x| 1e4 * x[0].abs() + 1e-12 * x[1].abs(), base(), &[1.0; 2]), Some(Stop::ConditionCov));
    // Scores that have nothing to do with the candidate.
    let noise = |x: &[f64]| (x[0] * 1e9).sin();
    assert_eq!(run(noise, base(), &[1.0; 3]), Some(Stop::Stagnation));
}
