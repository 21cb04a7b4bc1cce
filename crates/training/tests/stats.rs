//! Statistics against figures computed with `SciPy` 1.17, and bootstrap intervals against what they promise.

#![allow(clippy::unwrap_used)]

use hwasp_core::{Purpose, Stream, stream};
use hwasp_training::stats::{
    Bootstrap, Improvement, Interval, Sample, StatsError, bootstrap_interval, improvement, interquartile_mean, mean,
    separation_by_chance, wilson,
};
use rand::Rng;

const RETURNS: [f64; 5] = [-411.2, -408.9, -420.5, -409.7, -350.1];
const TEN: [f64; 10] = [3.1, -2.4, 8.8, 1.0, 0.5, 2.2, -7.9, 4.4, 5.0, 100.0];
const TWELVE: [f64; 12] = [0.3, 1.9, -0.7, 2.4, 0.1, 1.1, -1.6, 0.9, 0.4, 3.2, -0.2, 0.8];

fn close(got: f64, expected: f64) {
    assert!((got - expected).abs() <= 1e-12 * expected.abs().max(1.0), "{got} is not {expected}");
}

fn sample(values: &[f64]) -> Sample {
    Sample::new(values).unwrap()
}

fn generator(seed: u64) -> Stream {
    stream(seed, Purpose::Check, 0, 0)
}

/// `scipy.stats.trim_mean(x, 0.25)`; the counts are not multiples of four, where conventions differ.
#[test]
fn interquartile_mean_is_scipys() {
    close(interquartile_mean(&RETURNS).unwrap(), -409.933_333_333_333_34);
    close(interquartile_mean(&TEN).unwrap(), 2.7);
    close(interquartile_mean(&[64.0, 1.0, 2.0, 4.0, 8.0, 16.0, 32.0]).unwrap(), 12.4);
    close(interquartile_mean(&[4.0, 1.0, 3.0, 10.0]).unwrap(), 3.5);
    close(interquartile_mean(&[1.0, 2.0, 9.0]).unwrap(), 4.0);
    close(interquartile_mean(&[2.5]).unwrap(), 2.5);
}

/// `numpy.mean`, `scipy.stats.sem`, `numpy.quantile`.
#[test]
fn mean_error_and_quantiles_are_scipys() {
    close(mean(&RETURNS).unwrap(), -400.08);
    close(sample(&RETURNS).standard_error().unwrap(), 12.666_822_806_055_187);
    close(sample(&TEN).standard_error().unwrap(), 9.938_735_108_430_826);
    assert_eq!(sample(&[2.5]).standard_error(), None);
    for (q, expected) in [(0.025, -6.6625), (0.25, 0.625), (0.5, 2.65), (0.9, 17.92), (1.0, 100.0), (0.0, -7.9)] {
        close(sample(&TEN).quantile(q), expected);
    }
    close(sample(&TEN).quantile(7.0), 100.0);
    close(sample(&TEN).quantile(f64::NAN.max(-1.0)), -7.9);
}

/// `scipy.stats.bootstrap(method="percentile")` with 200,000 resamples, for the mean and for `trim_mean(x, 0.25)`. The
/// tolerance is one step of the grid that the interquartile mean of these values lies on (a sixth of a tenth): at 1.5 the
/// distribution passes 97.5 % within two standard errors of the step below.
#[test]
fn bootstrap_is_scipys() {
    let many = Bootstrap { resamples: 200_000, ..Bootstrap::default() };
    let of =
        |statistic: fn(&Sample) -> f64| many.interval(&sample(&TWELVE), statistic, &mut generator(1)).unwrap().unwrap();
    let (mean, iqm) = (of(Sample::mean), of(Sample::interquartile_mean));
    for (got, expected) in [(mean.low, 0.0083), (mean.high, 1.4417), (iqm.low, -0.05), (iqm.high, 1.5)] {
        assert!((got - expected).abs() < 0.0168, "{got} is not {expected}");
    }
}

/// The share of intervals that hold the true mean of a normal distribution; NumPy's percentile bootstrap gives 92.7 %
/// at twenty values (4000 trials), and 300 trials have a standard error of 1.5 %.
#[test]
fn bootstrap_covers_the_true_mean() {
    let mut noise = generator(7);
    let mut uniform = || (noise.next_u64() >> 11) as f64 / (1u64 << 53) as f64;
    let settings = Bootstrap { resamples: 500, ..Bootstrap::default() };
    let mut covered = 0;
    for trial in 0..300 {
        // Twelve uniforms less six: normal enough, mean 5 after the shift.
        let values: Vec<f64> = (0..20).map(|_| 5.0 + (0..12).map(|_| uniform()).sum::<f64>() - 6.0).collect();
        let interval = settings.interval(&sample(&values), Sample::mean, &mut generator(trial)).unwrap().unwrap();
        covered += i32::from(interval.low <= 5.0 && 5.0 <= interval.high);
    }
    assert!((265..=294).contains(&covered), "{covered} of 300 intervals hold the true mean");
}

#[test]
fn figures_depend_on_the_values_and_the_stream_alone() {
    let mut reversed = TWELVE;
    reversed.reverse();
    let of =
        |values: &[f64], seed| bootstrap_interval(values, Sample::interquartile_mean, &mut generator(seed)).unwrap();
    assert_eq!(of(&TWELVE, 3), of(&TWELVE, 3));
    assert_eq!(of(&TWELVE, 3), of(&reversed, 3));
    assert_ne!(of(&TWELVE, 3), of(&TWELVE, 4));
    assert_eq!(mean(&TWELVE).unwrap().to_bits(), mean(&reversed).unwrap().to_bits());
}

/// One seed was printed as `[-8.5, -8.5]`, and as better in 100 % of pairs: certainty that no sample of that size has.
#[test]
fn small_samples_and_equal_values_carry_no_interval() {
    let of = |values: &[f64]| bootstrap_interval(values, Sample::mean, &mut generator(0)).unwrap();
    assert_eq!([of(&[2.5]), of(&[1.0, 2.0]), of(&[1.0, 2.0, 3.0]), of(&[0.0; 50])], [None; 4]);
    assert!(of(&[1.0, 2.0, 3.0, 4.0]).is_some());
    let improved = |one: &[f64], other: &[f64]| improvement(one, other, &mut generator(0)).unwrap();
    assert_eq!(improved(&[2.0, 3.0], &[0.0, 1.0]), None);
    assert_eq!(improved(&[5.0, 6.0, 7.0, 8.0], &[0.0, 1.0, 2.0]), None);
    // Every resample of samples that are apart is apart, too.
    let apart = improved(&[5.0, 6.0, 7.0, 8.0], &[0.0, 1.0, 2.0, 3.0]).unwrap();
    assert_eq!((apart.probability, apart.interval), (1.0, None));
}

/// The table in the module's documentation: of n values of a symmetric distribution, all lie on one side of the centre in
/// 2 of 2^n cases. Four normal values hold the truth less often than that, more often than four times in six.
#[test]
fn no_interval_covers_more_than_the_range() {
    let mut noise = generator(5);
    let mut normal = || (0..12).map(|_| (noise.next_u64() >> 11) as f64 / (1u64 << 53) as f64).sum::<f64>() - 6.0;
    let settings = Bootstrap { resamples: 500, ..Bootstrap::default() };
    let mut covered = 0;
    for trial in 0..400 {
        let values: Vec<f64> = (0..4).map(|_| normal()).collect();
        let interval = settings.interval(&sample(&values), Sample::mean, &mut generator(trial)).unwrap().unwrap();
        assert!(values.iter().any(|v| *v <= interval.low) && values.iter().any(|v| *v >= interval.high));
        covered += i32::from(interval.low <= 0.0 && 0.0 <= interval.high);
    }
    assert!((268..=350).contains(&covered), "{covered} of 400 intervals hold the true mean");
}

/// 2 / C(n + m, n): of the 70 ways to deal eight ranks to two samples of four, two are apart; of 20 and 252 as many.
#[test]
fn how_often_chance_alone_separates() {
    for (one, other, ways) in [(1, 1, 2.0), (3, 3, 20.0), (4, 4, 70.0), (5, 5, 252.0), (2, 5, 21.0)] {
        close(separation_by_chance(one, other), 2.0 / ways);
    }
}

#[test]
fn bad_values_and_settings_are_named() {
    assert_eq!(mean(&[]), Err(StatsError::Empty));
    let nan = interquartile_mean(&[1.0, f64::NAN]).unwrap_err();
    assert!(nan.to_string().starts_with("value 1 is NaN"), "{nan}");
    assert!(matches!(mean(&[f64::INFINITY]), Err(StatsError::NotFinite { index: 0, .. })));
    let run = |resamples, confidence| {
        Bootstrap { resamples, confidence }.interval(&sample(&TWELVE), Sample::mean, &mut generator(0)).unwrap_err()
    };
    assert_eq!(run(0, 0.95), StatsError::Resamples(0));
    assert_eq!(run(10, 95.0).to_string(), "a confidence of 95 is outside (0, 1); write 0.95 for 95 %");
    assert!(matches!(run(10, f64::NAN), StatsError::Confidence(_)));
    let statistic = bootstrap_interval(&[1.0, 2.0], |_| f64::NAN, &mut generator(0));
    assert!(matches!(statistic, Err(StatsError::Statistic(_))));
}

#[test]
fn huge_values_do_not_overflow() {
    assert!(mean(&[f64::MAX, f64::MAX, f64::MAX]).unwrap() > 1e308);
}

/// `scipy.stats.mannwhitneyu(one, other).statistic` over the number of pairs: 83 of 120. By hand: 3, 5 and 5 against 4
/// and 5 win two pairs and tie two of six.
#[test]
fn the_probability_of_improvement_is_mann_and_whitneys() {
    let of = |one: &[f64], other: &[f64]| improvement(one, other, &mut generator(0)).unwrap().unwrap();
    close(of(&[3.0, 5.0, 5.0, 3.0, 5.0, 5.0], &[4.0, 5.0, 4.0, 5.0]).probability, 0.5);
    let Improvement { probability, interval } = of(&TEN, &TWELVE);
    close(probability, 83.0 / 120.0);
    let interval = interval.unwrap();
    assert!(interval.low < probability && probability < interval.high);
    assert_eq!(improvement(&[1.0], &[], &mut generator(0)).unwrap_err(), StatsError::Empty);
}

/// The share of intervals that hold the true probability that the larger of two normal distributions wins: for a
/// distance of one standard deviation Φ(1/√2) = 0.7602. 200 trials have a standard error of 1.6 %.
#[test]
fn the_probability_of_improvement_is_covered() {
    let mut noise = generator(11);
    let mut uniform = || (noise.next_u64() >> 11) as f64 / (1u64 << 53) as f64;
    let mut normal = |mean: f64| (0..20).map(|_| mean + (0..12).map(|_| uniform()).sum::<f64>() - 6.0).collect();
    let mut covered = 0;
    for trial in 0..200 {
        let (one, other): (Vec<f64>, Vec<f64>) = (normal(1.0), normal(0.0));
        let interval = improvement(&one, &other, &mut generator(trial)).unwrap().unwrap().interval.unwrap();
        covered += i32::from(interval.low <= 0.7602 && 0.7602 <= interval.high);
    }
    assert!((178..=197).contains(&covered), "{covered} of 200 intervals hold the true probability");
}

/// `scipy.stats.binomtest(k, n).proportion_ci(method="wilson")`.
#[test]
fn wilsons_interval_is_scipys() {
    for (k, n, low, high) in [
        (0, 10, 0.0, 0.277_532_799_862_889_9),
        (10, 10, 0.722_467_200_137_110_2, 1.0),
        (388, 400, 0.948_301_464_290_904_3, 0.982_756_979_034_857),
    ] {
        let interval = wilson(k, n);
        assert!((interval.low - low).abs() < 1e-12 && (interval.high - high).abs() < 1e-12, "{interval:?}");
    }
    assert_eq!(wilson(0, 0), Interval { low: 0.0, high: 1.0 });
}
