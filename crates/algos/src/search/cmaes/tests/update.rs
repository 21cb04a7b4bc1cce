use hwasp_core::{Purpose, stream};
use rand::RngExt;
use rand_distr::StandardNormal;

use super::*;
use crate::search::cmaes::constants::{Constants, effective};

fn near(found: f64, expected: f64) {
    assert!((found - expected).abs() <= 1e-12 * expected.abs().max(1.0), "{found} is not {expected}");
}

/// The weights, `μ_eff` and rates that pycma 4.5.0 has for ten dimensions; `c_σ` and `d_σ` by hand, as it has left the
/// tutorial there.
#[test]
fn table_1_for_ten_dimensions() {
    let config = CmaesConfig::default();
    let c = Constants::new(&config, 10, config.first_popsize(10));
    assert_eq!((c.popsize, c.mu), (10, 5));
    let weights = [
        0.456_272_646_903_405_97,
        0.270_753_097_001_785_2,
        0.162_231_117_158_669_78,
        0.085_233_547_100_164_48,
        0.025_509_591_835_974_777,
        -0.080_012_607_580_872_24,
        -0.221_764_160_999_146_53,
        -0.344_554_941_784_821_8,
        -0.452_864_086_378_421_96,
        -0.549_749_917_697_385_3,
    ];
    c.weights.iter().zip(weights).for_each(|(&found, expected)| near(found, expected));
    let mu_eff = 3.167_299_281_410_701_7;
    near(effective(&c.weights[..5]), mu_eff);
    near(effective(&c.weights[5..]), 3.989_115_019_106_923);
    near(c.c_1, 0.015_283_824_524_751_714);
    near(c.c_mu, 0.023_551_776_650_417_47);
    near(c.c_c, 0.294_990_383_035_622_25);
    near(c.chi_n, 3.084_726_565_169_012_3);
    near(c.c_sigma, (mu_eff + 2.0) / (mu_eff + 15.0));
    near(c.d_sigma, 1.0 + c.c_sigma);
    assert_eq!(c.eigen_gap, 1);
    // pycma waits for 9.77 generations to pass at 1300 dimensions.
    assert_eq!(Constants::new(&config, 1300, 25).eigen_gap, 10);
    let passive = Constants::new(&CmaesConfig { active: false, ..config }, 10, 10);
    assert!(passive.weights[..5] == c.weights[..5] && passive.weights[5..].iter().all(|&w| w == 0.0));
}

#[test]
fn separable_learns_faster() {
    let full = Constants::new(&CmaesConfig::default(), 100, 17);
    let separable = Constants::new(&CmaesConfig { separable: true, ..CmaesConfig::default() }, 100, 17);
    near(separable.c_1, full.c_1 * 34.0);
    near(separable.c_mu, full.c_mu * 34.0);
}

/// Two dimensions, six candidates; the rates are numbers from a separate program of table 1.
#[test]
fn one_generation_by_hand() {
    let weights: [f64; 6] = [
        0.637_042_571_241_216_8,
        0.284_570_257_438_032_94,
        0.078_387_171_320_750_33,
        -0.286_383_782_596_552_95,
        -0.764_958_094_085_127_5,
        -1.155_981_778_158_921_2,
    ];
    let (mu_eff, c_sigma, d_sigma): (f64, f64, f64) =
        (2.028_611_464_610_061_7, 0.446_204_987_378_317_15, 1.446_204_987_378_317_2);
    let (c_c, c_1, c_mu): (f64, f64, f64) =
        (0.624_554_539_026_826_4, 0.154_815_399_896_413_6, 0.085_592_779_426_664_24);
    let chi = 1.254_272_742_818_995;
    let (mean, sigma): (_, f64) = ([1.0, -2.0], 0.5);

    let mut search = search(CmaesConfig { sigma, ..CmaesConfig::default() }, &mean);
    let asked = search.ask();
    // C = I: what was drawn can be read off. Scores put the candidates in the order 3, 0, 5, 1, 4, 2.
    let z: Vec<[f64; 2]> = asked.iter().map(|x| [(x[0] - mean[0]) / sigma, (x[1] - mean[1]) / sigma]).collect();
    search.tell(&[5.0, 3.0, 1.0, 6.0, 2.0, 4.0]).unwrap();
    let order = [3, 0, 5, 1, 4, 2];

    let mut y = [0.0; 2];
    for (&k, w) in order.iter().zip(weights).take(3) {
        y = [y[0] + w * z[k][0], y[1] + w * z[k][1]];
    }
    let state = &search.state;
    let gain = (c_sigma * (2.0 - c_sigma) * mu_eff).sqrt();
    let length = gain * y[0].hypot(y[1]);
    // 1 - (1 - c_σ)² under the root; else the path of the rank-one update would stall, and this test with it.
    assert!(length / (1.0 - (1.0 - c_sigma) * (1.0 - c_sigma)).sqrt() < (1.4 + 2.0 / 3.0) * chi);
    let path_gain = (c_c * (2.0 - c_c) * mu_eff).sqrt();
    for i in 0..2 {
        near(state.mean[i], mean[i] + sigma * y[i]);
        near(state.path_sigma[i], gain * y[i]);
        near(state.path_c[i], path_gain * y[i]);
    }
    near(state.sigma, sigma * (c_sigma / d_sigma * (length / chi - 1.0)).exp());
    let mut c = [0.0; 3];
    for (at, (i, j)) in [(0, 0), (1, 0), (1, 1)].into_iter().enumerate() {
        let sum: f64 = weights.iter().sum();
        c[at] = if i == j { 1.0 - c_1 - c_mu * sum } else { 0.0 };
        c[at] += c_1 * path_gain * y[i] * path_gain * y[j];
        for (&k, w) in order.iter().zip(weights) {
            let w = if w < 0.0 { w * 2.0 / (z[k][0] * z[k][0] + z[k][1] * z[k][1]) } else { w };
            c[at] += c_mu * w * z[k][i] * z[k][j];
        }
        near(state.covariance[2 * i + j], c[at]);
    }

    // The next generation follows that C: its lengths under C are those of the normals that its streams give.
    let (mean, sigma) = (state.mean.clone(), state.sigma);
    let determinant = c[0] * c[2] - c[1] * c[1];
    for (k, x) in search.ask().iter().enumerate() {
        let v = [(x[0] - mean[0]) / sigma, (x[1] - mean[1]) / sigma];
        let squared = (c[2] * v[0] * v[0] - 2.0 * c[1] * v[0] * v[1] + c[0] * v[1] * v[1]) / determinant;
        let mut normals = stream(1, Purpose::Search, 1, k as u64);
        let (a, b): (f64, f64) = (normals.sample(StandardNormal), normals.sample(StandardNormal));
        assert!((squared - a * a - b * b).abs() < 1e-9, "{squared}");
    }
}

/// A separable search does to the diagonal what the full one does, if its rates are the same: in one dimension.
#[test]
fn separable_is_full_in_one_dimension() {
    let mut full = search(CmaesConfig::default(), &[3.0]);
    let mut separable = search(CmaesConfig { separable: true, ..CmaesConfig::default() }, &[3.0]);
    for _ in 0..30 {
        generations(&mut full, sphere, 1);
        generations(&mut separable, sphere, 1);
        let (a, b) = (&full.state, &separable.state);
        assert!((a.mean[0] - b.mean[0]).abs() < 1e-9 && (a.sigma - b.sigma).abs() < 1e-9);
        assert!((a.covariance[0] / b.covariance[0] - 1.0).abs() < 1e-9);
    }
}
