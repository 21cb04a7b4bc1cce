use proptest::prelude::*;

use super::*;
use crate::archive::{Archive, Array, Persist};
use crate::search::{SearchError, Stop};

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]
    #[test]
    fn bounds_hold(seed: u64, sigma in 1e-3..1e3_f64, lower in -10.0..0.0_f64, separable: bool) {
        let config = CmaesConfig {
            sigma,
            separable,
            lower: Some(vec![lower, f64::NEG_INFINITY, 2.0, f64::NEG_INFINITY]),
            upper: Some(vec![0.5, 0.0, f64::INFINITY, f64::INFINITY]),
            restarts: 3,
            ..CmaesConfig::default()
        };
        let mut search = Cmaes::new(config, &[0.0, -1.0, 2.0, 7.0], seed).unwrap();
        for _ in 0..40 {
            let asked = search.ask();
            for x in asked.iter().chain([&search.center()]) {
                prop_assert!((lower..=0.5).contains(&x[0]) && x[1] <= 0.0 && x[2] >= 2.0 && x[3].is_finite());
            }
            // Uphill out of the bounds.
            search.tell(&asked.iter().map(|x| x[0] + x[1] - x[2]).collect::<Vec<_>>()).unwrap();
        }
    }
}

/// What an increasing function does to scores changes no bit of the distribution.
#[test]
fn only_ranks_matter() {
    let (mut plain, mut other) = (search(CmaesConfig::default(), &[1.0; 5]), search(CmaesConfig::default(), &[1.0; 5]));
    for _ in 0..60 {
        let asked = plain.ask();
        assert_eq!(asked, other.ask());
        let scores = scores(ellipsoid, &asked);
        plain.tell(&scores).unwrap();
        other.tell(&scores.iter().map(|s| 7.0 - (-s).ln_1p()).collect::<Vec<_>>()).unwrap();
    }
    assert_eq!(plain.state.covariance, other.state.covariance);
    assert_eq!(plain.state.sigma, other.state.sigma);
}

#[test]
fn equal_scores_rank_by_number() {
    let (mut equal, mut falling) =
        (search(CmaesConfig::default(), &[1.0; 5]), search(CmaesConfig::default(), &[1.0; 5]));
    equal.tell(&[0.0; 8]).unwrap();
    falling.tell(&[8.0, 7.0, 6.0, 5.0, 4.0, 3.0, 2.0, 1.0]).unwrap();
    assert_eq!(equal.state.covariance, falling.state.covariance);
}

/// Saved between ask and tell, with decompositions several generations apart and bounds.
#[test]
fn a_saved_state_goes_on_bit_for_bit() {
    for separable in [false, true] {
        let n = 200;
        // So few candidates that a decomposition is due every eighth generation.
        let lower = Some(vec![-1.0; n]);
        let config = CmaesConfig { separable, popsize: Some(4), lower, restarts: 1, ..CmaesConfig::default() };
        let mut whole = search(config.clone(), &vec![1.0; n]);
        for generation in 0..18 {
            let asked = whole.ask();
            let mut resumed = search(config.clone(), &vec![1.0; n]);
            resumed.load(&whole.save().unwrap()).unwrap();
            let scores = scores(ellipsoid, &asked);
            whole.tell(&scores).unwrap();
            // A resumed search may be told what another process asked.
            if generation % 2 == 0 {
                assert_eq!(resumed.ask(), asked);
            }
            resumed.tell(&scores).unwrap();
            assert_eq!(resumed.state, whole.state);
            assert_eq!(resumed.ask(), whole.ask());
            whole = resumed;
        }
        let state = &whole.state;
        assert!(separable || (state.decomposed_at > 0 && state.decomposed_at < state.run_generation));
    }
}

#[test]
fn a_state_of_other_settings_is_refused() {
    let state = search(CmaesConfig::default(), &[1.0; 5]).save().unwrap();
    let told = |config: CmaesConfig, state: &Archive| search(config, &[1.0; 5]).load(state).unwrap_err().to_string();
    let separable = CmaesConfig { separable: true, ..CmaesConfig::default() };
    assert_eq!(told(separable, &state), "`covariance` of the saved state has 25 elements instead of 5");
    for (name, array, message) in [
        ("sigma", Array::F64(vec![0.0]), "`sigma` of the saved state is 0, which is not above 0"),
        (
            "restarts",
            Array::U64(vec![1]),
            "`restarts` of the saved state is 1, which is not within the settings' restarts",
        ),
        ("stops", Array::U64(vec![8]), "`stops` of the saved state is 8, which is not a reason to stop"),
        (
            "best",
            Array::F64(vec![1.0; 2]),
            "`best` of the saved state is 1, which is not as many coordinates as the mean",
        ),
        ("median_scores", Array::F64(vec![1.0]), "`median_scores` of the saved state has 1 elements instead of 0"),
    ] {
        let mut damaged = state.clone();
        damaged.insert(name.into(), array);
        assert_eq!(told(CmaesConfig::default(), &damaged), message);
    }
}

/// Two of eight, then six of eight have failed: whatever they were given, and without a pull on the mean.
#[test]
fn failures_rank_last() {
    let told = |scores: [f64; 8]| {
        let mut search = search(CmaesConfig::default(), &[1.0; 5]);
        let asked = search.ask();
        search.tell(&scores).unwrap();
        (asked, search.state.clone())
    };
    let (bad, worse) = (f64::NEG_INFINITY, f64::NAN);
    let (_, low) = told([8.0, -1e9, 7.0, 6.0, 5.0, -2e9, 4.0, 3.0]);
    let (_, infinite) = told([8.0, bad, 7.0, 6.0, 5.0, bad, 4.0, 3.0]);
    let (_, nan) = told([8.0, worse, 7.0, 6.0, 5.0, f64::INFINITY, 4.0, 3.0]);
    assert_eq!(low.covariance, infinite.covariance);
    assert_eq!(infinite, nan);

    let (asked, state) = told([bad, 1.0, bad, worse, 2.0, bad, worse, bad]);
    // ln 4.5 and ln 4.5 - ln 2, scaled to sum 1.
    let (first, second) = (4.5_f64.ln(), 2.25_f64.ln());
    for i in 0..5 {
        let mean = (first * asked[4][i] + second * asked[1][i]) / (first + second);
        assert!((state.mean[i] - mean).abs() < 1e-12);
    }
    assert!(state.best.unwrap().score == 2.0 && state.median_scores == [f64::MIN]);
}

#[test]
fn an_error_leaves_the_state() {
    let mut search = search(CmaesConfig::default(), &[1.0; 5]);
    generations(&mut search, sphere, 3);
    let (before, asked) = (search.state.clone(), search.ask());
    assert_eq!(search.tell(&[f64::NAN; 8]), Err(SearchError::AllFailed { candidates: 8, generation: 3 }));
    assert_eq!(search.tell(&[0.0; 7]), Err(SearchError::Scores { found: 7, expected: 8 }));
    assert_eq!(search.state, before);
    assert_eq!(search.ask(), asked);
}

#[test]
fn a_flat_function_restarts_with_twice_the_population() {
    let config =
        CmaesConfig { restarts: 2, lower: Some(vec![0.0; 5]), upper: Some(vec![1.0; 5]), ..CmaesConfig::default() };
    let mut search = search(config, &[0.5; 5]);
    let mut sizes = vec![];
    while search.stopped().is_none() && search.generation() < 200 {
        if search.state.run_generation == 0 {
            sizes.push(search.ask().len());
            assert_eq!(search.sigma(), 0.5);
        }
        generations(&mut search, |_| 3.0, 1);
    }
    assert_eq!(sizes, [8, 16, 32]);
    assert_eq!(search.state.stops, [Stop::EqualFunValues; 3]);
    // A stopped search still goes on.
    let generation = search.generation();
    generations(&mut search, |_| 3.0, 1);
    assert_eq!((search.generation(), search.stopped()), (generation + 1, Some(Stop::EqualFunValues)));
}

#[test]
fn settings_without_a_search_are_refused() {
    let base = CmaesConfig::default;
    let cases = [
        ("sigma", CmaesConfig { sigma: 0.0, ..base() }),
        ("sigma", CmaesConfig { sigma: f64::NAN, ..base() }),
        ("popsize", CmaesConfig { popsize: Some(3), ..base() }),
        ("restarts", CmaesConfig { restarts: 21, ..base() }),
        ("lower", CmaesConfig { lower: Some(vec![0.0]), ..base() }),
        ("upper", CmaesConfig { lower: Some(vec![1.0; 2]), upper: Some(vec![1.0; 2]), ..base() }),
        ("lower", CmaesConfig { lower: Some(vec![f64::NAN; 2]), ..base() }),
        ("mean", CmaesConfig { upper: Some(vec![0.5; 2]), ..base() }),
    ];
    for (expected, config) in cases {
        let Err(SearchError::Setting { name, .. }) = Cmaes::new(config.clone(), &[1.0; 2], 1) else {
            panic!("{config:?}")
        };
        assert_eq!(name, expected);
    }
    assert!(Cmaes::new(base(), &[], 1).is_err() && Cmaes::new(base(), &[f64::NAN], 1).is_err());
}
