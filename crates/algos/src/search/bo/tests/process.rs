use hwasp_core::{Purpose, stream};
use rand::RngExt;

use super::super::fit::{Priors, fitted, improbability};
use super::super::improvement::improvement;
use super::super::kernel::Kernel;
use super::super::model::{Model, standardised};
use super::super::posterior::Posterior;

const POINTS: [[f64; 2]; 3] = [[0.1, 0.2], [0.6, 0.9], [0.8, 0.3]];
const SCORES: [f64; 3] = [0.5, -1.2, 0.7];

fn kernel() -> Kernel {
    Kernel { scales: vec![0.4, 0.9], signal: 1.5, noise: 0.05 }
}

fn points() -> Vec<&'static [f64]> {
    POINTS.iter().map(|p| &p[..]).collect()
}

fn near(a: f64, b: f64, tolerance: f64) -> bool {
    (a - b).abs() <= tolerance * b.abs().max(1.0)
}

/// By scikit-learn 1.9.1: `GaussianProcessRegressor(1.5 * Matern([0.4, 0.9], nu=2.5) + ConstantKernel(1), alpha=0.05)`.
#[test]
fn the_posterior_is_that_of_scikit_learn() {
    let kernel = kernel();
    let posterior = Posterior::new(&kernel, points(), &SCORES, 3);
    for (x, mean, std) in [
        ([0.5, 0.5], -0.405_852_138_237_873_4, 0.600_402_116_452_244_7),
        ([0.6, 0.9], -1.109_063_526_643_996_8, 0.217_773_444_169_236_86),
        ([1.0, 0.0], 0.900_681_225_013_107_1, 0.807_819_534_914_175_2),
    ] {
        let (found, spread) = posterior.at(&x);
        assert!(near(found, mean, 1e-13) && near(spread, std, 1e-13), "{x:?}: {found} {spread}");
        assert_eq!(posterior.mean(&x), found);
    }
}

/// Two points at the distance r of one scale, no noise: the weights are those of a 2 × 2 matrix.
#[test]
fn two_points_by_hand() {
    let kernel = Kernel { scales: vec![1.0], signal: 2.0, noise: 0.0 };
    let matern = |r: f64| 2.0 * (1.0 + 5.0_f64.sqrt() * r + 5.0 * r * r / 3.0) * (-5.0_f64.sqrt() * r).exp();
    let (whole, apart, half) = (1.0 + 2.0, 1.0 + matern(1.0), 1.0 + matern(0.5));
    // Scores 1 and 3: by symmetry the mean in the middle is half·(1 + 3)/(whole + apart).
    let posterior = Posterior::new(&kernel, vec![&[0.0], &[1.0]], &[1.0, 3.0], 2);
    let (mean, std) = posterior.at(&[0.5]);
    assert!(near(mean, half * 4.0 / (whole + apart), 1e-14));
    assert!(near(std * std, whole - 2.0 * half * half / (whole + apart), 1e-13));
    assert!(near(posterior.at(&[1.0]).0, 3.0, 1e-13) && posterior.at(&[1.0]).1 < 1e-5);
}

/// What is believed at its mean leaves all means, and takes the doubt away.
#[test]
fn beliefs_take_doubt_and_leave_means() {
    let kernel = kernel();
    let before = Posterior::new(&kernel, points(), &SCORES, 3);
    let (x, other) = ([0.4, 0.1], [0.3, 0.6]);
    let scores = [&SCORES[..], &[before.mean(&x)]].concat();
    let after = Posterior::new(&kernel, [points(), vec![&x[..]]].concat(), &scores, 3);
    assert!(near(after.mean(&other), before.mean(&other), 1e-9));
    assert!(after.at(&x).1 < 2e-3 && after.at(&other).1 < before.at(&other).1);
}

#[test]
fn slopes_are_those_of_differences() {
    let kernel = kernel();
    let posterior = Posterior::new(&kernel, points(), &SCORES, 3);
    for x in [[0.5, 0.5], [0.05, 0.95], [0.6, 0.9]] {
        let slope = posterior.slope(&x);
        assert_eq!((slope.mean, slope.std), posterior.at(&x));
        for i in 0..2 {
            let moved = |by: f64| {
                let mut x = x;
                x[i] += by;
                posterior.at(&x)
            };
            let (above, below) = (moved(1e-5), moved(-1e-5));
            assert!(near((above.0 - below.0) / 2e-5, slope.mean_by[i], 1e-6), "{x:?} {i}");
            assert!(near((above.1 - below.1) / 2e-5, slope.std_by[i], 1e-6), "{x:?} {i}");
        }
    }
}

/// Minus the likelihood is that of scikit-learn, -5.2354…, but for 3/2·log 2π; the priors are added.
#[test]
fn the_likelihood_is_that_of_scikit_learn() {
    let logs = [0.4_f64.ln(), 0.9_f64.ln(), 1.5_f64.ln(), 0.05_f64.ln()];
    let value = improbability(&logs, &points(), &SCORES, &Priors::new(2)).unwrap().0;
    let scale = |log: f64| (log - 2.0_f64.sqrt() - 0.5 * 2.0_f64.ln()).powi(2) / 6.0;
    let priors = scale(logs[0]) + scale(logs[1]) + logs[2].powi(2) / 2.0 + (logs[3] + 4.0).powi(2) / 8.0;
    let likelihood = 5.235_471_292_532_207 - 1.5 * (2.0 * std::f64::consts::PI).ln();
    assert!(near(value, likelihood + priors, 1e-13), "{value}");
}

/// Draws from a process, and the gradient of its likelihood against differences of fourth order.
#[test]
fn the_likelihood_has_the_slope_of_its_differences() {
    let mut numbers = stream(5, Purpose::Check, 0, 0);
    let cube: Vec<Vec<f64>> = (0..20).map(|_| (0..3).map(|_| numbers.random()).collect()).collect();
    let points: Vec<&[f64]> = cube.iter().map(Vec::as_slice).collect();
    let scores: Vec<f64> = cube.iter().map(|x| (7.0 * x[0]).sin() + x[1] * x[2] - 0.5).collect();
    let priors = Priors::new(3);
    for logs in [[-1.0, 0.2, 0.7, 0.3, -3.0], [0.5, 1.5, -0.5, -1.0, -6.0]] {
        let gradient = improbability(&logs, &points, &scores, &priors).unwrap().1;
        for i in 0..logs.len() {
            let at = |by: f64| {
                let mut logs = logs;
                logs[i] += by;
                improbability(&logs, &points, &scores, &priors).unwrap().0
            };
            let h = 1e-3;
            let difference = (8.0 * (at(h) - at(-h)) - (at(2.0 * h) - at(-2.0 * h))) / (12.0 * h);
            assert!(near(gradient[i], difference, 1e-6), "{i}: {} {difference}", gradient[i]);
        }
    }
}

/// One coordinate matters, the other two do not; and a tenth of the scores' deviation is noise.
#[test]
fn a_fit_finds_what_matters_and_the_noise() {
    let mut numbers = stream(6, Purpose::Check, 0, 0);
    let cube: Vec<Vec<f64>> = (0..60).map(|_| (0..3).map(|_| numbers.random()).collect()).collect();
    let points: Vec<&[f64]> = cube.iter().map(Vec::as_slice).collect();
    let noise = |_| numbers.random::<f64>() + numbers.random::<f64>() - 1.0; // variance 1/6
    let noises: Vec<f64> = (0..60).map(noise).collect();
    let scores: Vec<f64> = cube.iter().zip(noises).map(|(x, e)| (9.0 * x[1]).sin() + 0.25 * e).collect();
    let kernel = fitted(&points, &standardised(&scores));
    assert!(kernel.scales[1] < 0.7, "{kernel:?}");
    assert!(kernel.scales[0] > 2.0 && kernel.scales[2] > 2.0, "{kernel:?}");
    let variance = scores.iter().map(|s| s * s).sum::<f64>() / 60.0;
    let expected = 0.25_f64.powi(2) / 6.0 / variance;
    assert!((0.5 * expected..2.0 * expected).contains(&kernel.noise), "{} {expected}", kernel.noise);
}

/// By mpmath 1.4 with 40 digits: log(σ·(φ(z) + z·Φ(z))).
#[test]
fn log_improvements_to_the_last_digits() {
    for (mean, std, best, log) in [
        (0.3, 0.5, 0.0, -0.956_237_156_377_947_8),
        (5.0, 0.5, 0.0, 1.609_437_912_434_100_4),
        (-0.5, 0.5, 0.0, -3.178_268_206_272_586_6),
        (-2.0, 0.4, 0.1, -19.030_467_275_188_515),
        (-3.0, 0.05, 0.0, -1_812.104_192_455_826_2),
        (-40.0, 0.5, 0.0, -3_210.376_607_477_027_6),
    ] {
        let found = improvement(mean, std, best).log;
        assert!(near(found, log, 1e-14), "{mean} {std}: {found} instead of {log}");
    }
}

/// ∫ max(y - best, 0)·N(y; mean, σ²) dy by Simpson's rule, and derivatives by differences, on both sides of where the formula
/// changes.
#[test]
fn improvements_are_integrals() {
    for (mean, std, best) in [(0.3, 0.5, 0.0), (-0.7, 0.6, 0.1), (-1.0, 0.5, 0.0), (-1.4, 0.5, 0.2), (2.0, 0.3, 0.5)] {
        let density = |y: f64| (-0.5 * ((y - mean) / std).powi(2)).exp() / (std * (2.0 * std::f64::consts::PI).sqrt());
        let (from, to, parts) = (best, f64::max(best, mean) + 12.0 * std, 4000);
        let h = (to - from) / f64::from(parts);
        let weight = |k| {
            if k == 0 || k == parts {
                1.0
            } else if k % 2 == 1 {
                4.0
            } else {
                2.0
            }
        };
        let at = |k| f64::from(k) * h;
        let integral: f64 = (0..=parts).map(|k| weight(k) * at(k) * density(best + at(k))).sum::<f64>() * h / 3.0;
        let gain = improvement(mean, std, best);
        assert!((gain.log.exp() / integral - 1.0).abs() < 1e-9, "{mean} {std} {best}: {} {integral}", gain.log.exp());
        let by = |f: &dyn Fn(f64) -> f64| (f(1e-5) - f(-1e-5)) / 2e-5;
        let (by_mean, by_std) =
            (by(&|h| improvement(mean + h, std, best).log), by(&|h| improvement(mean, std + h, best).log));
        assert!(near(gain.by_mean, by_mean, 1e-7), "{mean} {std} {best}: {gain:?} {by_mean}");
        assert!(near(gain.by_std, by_std, 1e-7), "{mean} {std} {best}: {gain:?} {by_std}");
    }
}

#[test]
fn scores_are_standardised_and_fenced() {
    assert_eq!(standardised(&[3.0]), [0.0]);
    assert_eq!(standardised(&[2.0; 4]), [0.0; 4]);
    assert_eq!(standardised(&[1.0, 3.0]), [-1.0, 1.0]);
    // Quartiles 2 and 3: what is below 2 - 1.5·1 = 0.5 counts as that. The mean is then 2.75.
    let found = standardised(&[-1e9, 2.0, 3.0, 4.0, 5.0, 2.0]);
    let std = (12.875_f64 / 6.0).sqrt();
    for (a, b) in found.iter().zip([-2.25, -0.75, 0.25, 1.25, 2.25, -0.75]) {
        assert!(near(*a, b / std, 1e-14), "{found:?}");
    }
    let wide = standardised(&[-1e150, 1e150, 0.0]);
    assert!(wide.iter().all(|s| s.is_finite()), "{wide:?}");
}

/// Equal points with equal and with different scores, and scores without a difference.
#[test]
fn points_that_are_told_twice_leave_a_model() {
    let points = vec![vec![0.5, 0.5]; 40];
    for score in [|_| 1.0, |i| f64::from(i % 3)] {
        let scores: Vec<f64> = (0..40).map(score).collect();
        let model = Model::new(&points, &scores, f64::MIN).unwrap();
        let next = model.candidates(&points, 4, |k| stream(1, Purpose::Acquisition, 1, k as u64));
        assert!(next.iter().flatten().all(|x| (0.0..=1.0).contains(x)), "{next:?}");
        for i in 1..4 {
            assert!(next[..i].iter().all(|other| *other != next[i]), "{next:?}");
        }
    }
}
