//! How the words of a command line are read.

use std::num::NonZeroUsize;
use std::ops::RangeInclusive;
use std::path::PathBuf;
use std::time::Duration;

use clap::builder::{PathBufValueParser, TypedValueParser};
use hwasp_report::play;

/// The greatest seed: what TOML can write.
pub(super) const LAST_SEED: u64 = i64::MAX as u64;
/// The longest training, steps; `train.env_steps` of an experiment has the same limit.
pub(super) const MOST_STEPS: u64 = 1_000_000_000_000;
/// The most episodes of an evaluation; `train.evaluation_episodes` has the same limit.
pub(super) const MOST_EPISODES: u64 = 1_000_000;
/// The most seeds of a comparison: a picture shows a thousand runs.
pub(super) const MOST_SEEDS: u64 = 100;
/// The longest time between two checkpoints, s: a day.
const MOST_SECONDS: f64 = 86_400.0;
/// The most threads: far more than help.
const MOST_THREADS: u64 = 1024;

/// Reads a path. One with a line break in it could not be told in a message, nor be typed again.
pub(super) fn path() -> impl TypedValueParser<Value = PathBuf> {
    PathBufValueParser::new().try_map(|path| {
        let odd = path.to_string_lossy().chars().any(char::is_control);
        if odd { Err("it has characters that cannot be printed, such as a line break") } else { Ok(path) }
    })
}

/// Reads a side of a picture.
pub(super) fn side() -> impl Fn(&str) -> Result<u64, String> + Clone {
    whole(play::SIDES[0]..=play::SIDES[1])
}

/// Reads a whole number within limits; as in experiment files `4e6` and `4_000_000` are such.
pub(super) fn whole(limits: RangeInclusive<u64>) -> impl Fn(&str) -> Result<u64, String> + Clone {
    move |text| {
        let plain = text.replace('_', "");
        // Powers of ten are exact below 2^53, far beyond any count that they are written for.
        let exact = |x: &f64| x.fract() == 0.0 && (0.0..9.0e15).contains(x);
        let number = plain.parse().ok().or_else(|| plain.parse().ok().filter(exact).map(|x| x as u64));
        number
            .filter(|number| limits.contains(number))
            .ok_or_else(|| format!("it has to be a whole number from {} to {}", limits.start(), limits.end()))
    }
}

/// Reads a number.
pub(super) fn finite(text: &str) -> Result<f64, String> {
    text.parse().ok().filter(|x: &f64| x.is_finite()).ok_or_else(|| "it has to be a finite number, such as -2.5".into())
}

/// Reads numbers that commas part.
pub(super) fn numbers<const N: usize>(text: &str) -> Result<[f64; N], String> {
    let wrong = || format!("it has to be {N} numbers with commas between them, such as {}", ["60"; N].join(","));
    let read: Vec<f64> =
        text.split(',').map(|part| finite(part.trim())).collect::<Result<_, _>>().map_err(|_| wrong())?;
    read.try_into().map_err(|_| wrong())
}

/// Reads a time, s.
pub(super) fn seconds(text: &str) -> Result<Duration, String> {
    let number = text.parse().ok().filter(|s| (0.0..=MOST_SECONDS).contains(s));
    number
        .map(Duration::from_secs_f64)
        .ok_or_else(|| format!("it has to be a number of seconds from 0 to {MOST_SECONDS}"))
}

pub(super) fn threads(text: &str) -> Result<NonZeroUsize, String> {
    let count = whole(1..=MOST_THREADS)(text)?;
    NonZeroUsize::new(count as usize).ok_or_else(|| "it has to be at least 1".into())
}
