//! Dates, UTC.

use std::time::{SystemTime, UNIX_EPOCH};

/// Now, as `2026-11-29T12:00:00Z`.
pub fn now() -> String {
    let [year, month, day, hour, minute, second] = parts(seconds());
    format!("{year:04}-{month:02}-{day:02}T{hour:02}:{minute:02}:{second:02}Z")
}

/// Now, as names of files have it: `20261129-120000`.
pub fn for_files() -> String {
    let [year, month, day, hour, minute, second] = parts(seconds());
    format!("{year:04}{month:02}{day:02}-{hour:02}{minute:02}{second:02}")
}

fn seconds() -> u64 {
    SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |since| since.as_secs())
}

/// Year, month, day, hour, minute and second of a second since 1970. The days of a year count from March, so that the day that
/// leap years have is the last (Howard Hinnant, "chrono-compatible low-level date algorithms").
fn parts(seconds: u64) -> [u64; 6] {
    let (days, rest) = (seconds / 86_400 + 719_468, seconds % 86_400);
    let (era, day_of_era) = (days / 146_097, days % 146_097);
    let year_of_era = (day_of_era - day_of_era / 1460 + day_of_era / 36_524 - day_of_era / 146_096) / 365;
    let day_of_year = day_of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
    let from_march = (5 * day_of_year + 2) / 153;
    let day = day_of_year - (153 * from_march + 2) / 5 + 1;
    let month = if from_march < 10 { from_march + 3 } else { from_march - 9 };
    let year = 400 * era + year_of_era + u64::from(month <= 2);
    [year, month, day, rest / 3600, rest / 60 % 60, rest % 60]
}

#[cfg(test)]
mod tests {
    use super::parts;

    /// `date -u -d @SECONDS`.
    #[test]
    fn dates_by_hand() {
        assert_eq!(parts(0), [1970, 1, 1, 0, 0, 0]);
        assert_eq!(parts(951_782_399), [2000, 2, 28, 23, 59, 59]);
        assert_eq!(parts(951_782_400), [2000, 2, 29, 0, 0, 0]);
        assert_eq!(parts(1_709_251_199), [2024, 2, 29, 23, 59, 59]);
        assert_eq!(parts(1_795_953_600), [2026, 11, 29, 12, 0, 0]);
        assert_eq!(parts(4_107_542_400), [2100, 3, 1, 0, 0, 0]);
    }
}
