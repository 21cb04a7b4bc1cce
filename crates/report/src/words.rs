//! Figures as a reader of prose likes them.

use std::fmt::Write as _;

use hwasp_training::stats::Interval;
use hwasp_training::{MeanInterval, SuccessRate};

/// A share in per cent.
pub(super) fn percent(share: f64) -> String {
    format!("{:.1}\u{a0}%", 100.0 * share)
}

/// As many decimals as numbers of this size are told with.
pub(super) fn decimals(size: f64) -> usize {
    match size.abs() {
        100.0.. => 1,
        1.0.. => 2,
        _ => 4,
    }
}

/// A minus that is one, and none before zeros.
fn signed(text: &str) -> String {
    if text.contains(|c: char| ('1'..='9').contains(&c)) {
        text.replace('-', "\u{2212}")
    } else {
        text.trim_start_matches(['-', '+']).to_owned()
    }
}

/// A number with this many decimals.
pub(super) fn decimal(value: f64, decimals: usize) -> String {
    signed(&format!("{value:.decimals$}"))
}

/// A change, with its sign.
pub(super) fn change(value: f64, decimals: usize) -> String {
    signed(&format!("{value:+.decimals$}"))
}

/// An interval.
pub(super) fn interval(low: f64, high: f64, decimals: usize) -> String {
    format!("{} to {}", decimal(low, decimals), decimal(high, decimals))
}

/// An interval, if there is one.
pub(super) fn interval_or_none(of: Option<Interval>, decimals: usize) -> String {
    of.map_or("no interval".to_owned(), |Interval { low, high }| interval(low, high, decimals))
}

/// The interval of a mean.
pub(super) fn mean_interval(figure: &MeanInterval, decimals: usize) -> String {
    interval_or_none(figure.interval, decimals)
}

/// The interval of a share, in per cent.
pub(super) fn rate_interval(rate: &SuccessRate) -> String {
    format!("{}\u{a0}%", interval(100.0 * rate.low, 100.0 * rate.high, 1))
}

/// With a capital at its beginning.
pub(super) fn sentence(text: &str) -> String {
    let mut text = text.to_owned();
    if let Some(first) = text.get_mut(..1) {
        first.make_ascii_uppercase();
    }
    text
}

/// The name of a hand's joint in prose. Names that a user has given, or types, stay as they are.
pub(super) fn spaced(name: &str) -> String {
    name.replace('_', " ")
}

/// A word as a shell takes it.
pub(super) fn quoted(word: &str) -> String {
    let plain = |c: char| c.is_alphanumeric() || "-_./=:,+%@".contains(c);
    if !word.is_empty() && word.chars().all(plain) {
        word.to_owned()
    } else {
        format!("'{}'", word.replace('\'', "'\\''"))
    }
}

/// A path as an address has it, relative to a page.
pub(super) fn address(path: &str) -> String {
    let mut address = String::with_capacity(path.len());
    for byte in path.bytes() {
        if byte.is_ascii_alphanumeric() || b"-_./~".contains(&byte) {
            address.push(byte.into());
        } else {
            let _ = write!(address, "%{byte:02X}");
        }
    }
    address
}

/// A time in the units that one would say.
pub(super) fn duration(seconds: f64) -> String {
    let whole = seconds.max(0.0).round() as u64;
    match whole {
        0..60 => format!("{seconds:.1} s"),
        60..3600 => format!("{} min {} s", whole / 60, whole % 60),
        _ => format!("{} h {} min", whole / 3600, whole % 3600 / 60),
    }
}

/// Seconds since 1970 as date and time, UTC.
pub(super) fn date(unix_s: u64) -> String {
    // A year of these begins in March, so that the leap day is its last: month m, from March, begins after
    // (153·m + 2)/5 days. 719,468 days lie between 1 March of year 0 and 1970; 400 years have 146,097.
    let days = unix_s / 86_400 + 719_468;
    let (era, day) = (days / 146_097, days % 146_097);
    let year = (day - day / 1460 + day / 36_524 - day / 146_096) / 365;
    let day = day - (365 * year + year / 4 - year / 100);
    let month = (5 * day + 2) / 153;
    let day = day - (153 * month + 2) / 5 + 1;
    let (month, next) = if month < 10 { (month + 3, 0) } else { (month - 9, 1) };
    let (hour, minute) = (unix_s / 3600 % 24, unix_s / 60 % 60);
    format!("{:04}-{month:02}-{day:02} {hour:02}:{minute:02} UTC", 400 * era + year + next)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// As `date -u -d @…` has them.
    #[test]
    fn dates() {
        let known = [
            (0, "1970-01-01 00:00 UTC"),
            (951_782_400, "2000-02-29 00:00 UTC"),
            (1_709_251_199, "2024-02-29 23:59 UTC"),
            (1_735_689_600, "2025-01-01 00:00 UTC"),
            (4_102_444_800, "2100-01-01 00:00 UTC"),
        ];
        for (seconds, text) in known {
            assert_eq!(date(seconds), text);
        }
        assert!(date(u64::MAX).ends_with("UTC"));
    }

    #[test]
    fn signs() {
        assert_eq!(
            [decimal(-2.55, 1), decimal(-0.04, 1), change(3.0, 0), change(-0.04, 1)],
            ["\u{2212}2.5", "0.0", "+3", "0.0"]
        );
    }

    #[test]
    fn addresses_have_no_characters_of_their_own() {
        assert_eq!(address("../my run/a#b%.svg"), "../my%20run/a%23b%25.svg");
        assert_eq!(address("javascript:alert(1)"), "javascript%3Aalert%281%29");
    }

    #[test]
    fn durations() {
        assert_eq!([4.13, 59.9, 855.0, 7260.0].map(duration), ["4.1 s", "1 min 0 s", "14 min 15 s", "2 h 1 min"]);
    }
}
